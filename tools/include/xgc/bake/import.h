#pragma once

#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <filesystem>
#include <span>

namespace xgc::bake {

/// Reads a model file: glTF 2.0 and GLB through tinygltf, everything else (OBJ, PLY, OFF, STL, ...)
/// through Assimp, by extension. Scene nodes are flattened: a mesh instanced by n nodes gives n copies.
/// Points, lines and faces of fewer than three corners are left out; polygons are triangulated. Images are
/// not read. On failure `out` is untouched and the message names file, element and remedy.
Status importModel(const std::filesystem::path& file, Model& out);

/// As importModel, from memory. `extension` with its dot (".glb") picks the reader; external buffers of a
/// .gltf are refused. For tests and fuzzing.
Status importModelFromMemory(std::span<const std::byte> bytes, const std::string& extension, Model& out);

} // namespace xgc::bake
