#pragma once

#include "models.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/hierarchy.h>

namespace xgc::bench {

/// What the benchmarks ask of the default builder.
struct BuildRequest {
    bool optimal = false;       ///< vertices where the quadric has its minimum, else the input's
    uint32_t patchFaces = 2048; ///< bound on a patch; 0: a patch is a part
    double normalWeight = 0;
    double uvWeight = 0;
};

bake::Hierarchy build(const Subject& subject, const bake::Segmentation& parts, const BuildRequest& request = {});

/// E of every patch and level.
bake::PatchErrors measureErrors(const Subject& subject, const bake::Hierarchy& hierarchy);

/// Faces of the uniform states.
std::vector<uint32_t> uniformFaces(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy);

} // namespace xgc::bench
