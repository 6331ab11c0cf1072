#pragma once

#include "analysed_mesh.h"

namespace xgc::bake {

/// A label per face, each of them connected within a component but for those that took in tiny ones.
struct Labels {
    std::vector<uint32_t> ofFace;
    uint32_t count = 0; ///< labels are below this; not every one need be used
};

/// A label a region, their contours straightened, tiny components with them.
Labels label(const AnalysedMesh& at, const RegionsOfAll& regions);

/// Unions of what `label` made of `regions`, as those are joined to `unions`.
Labels join(const Labels& labels, const RegionsOfAll& regions, const RegionsOfAll& unions);

/// What `label` made, split by regions within those that it was made of. Faces that came to a label otherwise take a
/// neighbour's, or the first in it.
Labels split(const AnalysedMesh& at, const Labels& labels, const RegionsOfAll& finer);

} // namespace xgc::bake
