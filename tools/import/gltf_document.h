#pragma once

#include <import/readers.h>

#include <tiny_gltf.h>

namespace xgc::bake {

/// Parses a .gltf or .glb with its buffers through tinygltf. What tinygltf would trip over is met before it: the GLB's
/// chunks are checked, deep nesting and unsupported required extensions refused, images and animations taken
/// out, and buffers resolved. Indices inside the document are NOT checked.
Status parseGltf(const Source& source, tinygltf::Model& out);

} // namespace xgc::bake
