#pragma once

#include "models.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/default_hierarchy.h>

namespace xgc::bench {

/// The default hierarchy over patches of about so many faces at most.
bake::Hierarchy build(const Subject& subject, const bake::Segmentation& parts,
                      const bake::HierarchyOptions& options = {}, uint32_t patchFaces = bake::kDefaultPatchFaces);

/// E of every patch and level.
bake::PatchErrors measureErrors(const Subject& subject, const bake::Hierarchy& hierarchy);

/// Faces of the uniform states.
std::vector<uint32_t> uniformFaces(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy);

} // namespace xgc::bench
