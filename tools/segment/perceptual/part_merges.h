#pragma once

#include "analysed_mesh.h"

#include <xgc/bake/perceptual.h>

namespace xgc::bake {

/// See PerceptualSegmenter::merges.
std::vector<PartMerge> findPartMerges(const AnalysedMesh& at, const Segmentation& parts);

} // namespace xgc::bake
