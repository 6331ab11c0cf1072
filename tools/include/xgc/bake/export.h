#pragma once

#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <filesystem>

namespace xgc::bake {

/// Writes a model as .glb, .obj or .ply by extension, beside the target and renamed. GLB keeps every attribute,
/// materials and nodes; OBJ positions, first UV set, normals and materials' names; PLY positions, normals, colours.
Status exportModel(const Model& model, const std::filesystem::path& file);

} // namespace xgc::bake
