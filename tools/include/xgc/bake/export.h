#pragma once

#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <filesystem>

namespace xgc::bake {

/// A usage error where the extension is none of .glb, .obj and .ply: to refuse a name before the work.
Status checkExportName(const std::filesystem::path& file);

/// Writes a model as .glb, .obj or .ply by extension, beside the target and renamed. Positions stay exact.
/// - GLB keeps every attribute, materials, skins and nodes by name: a mesh for each node that has faces, in it a
///   primitive for each material. Such a node and those above it lose their transform (geometry is flattened).
/// - OBJ keeps positions, the first UV set and normals; where a material has a name, a .mtl file of the same stem keeps
///   the materials. Faces are grouped by node and material.
/// - PLY (binary) keeps positions, normals and the first colours to 8 bits, faces in their order.
Status exportModel(const Model& model, const std::filesystem::path& file);

} // namespace xgc::bake
