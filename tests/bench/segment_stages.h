#pragma once

#include <xgc/bake/mesh.h>

#include <array>
#include <cstdint>

namespace xgc::bench {

/// Stages of the perceptual segmentation, in order.
inline constexpr std::array<const char*, 11> kSegmentStages{
    "topology", "link", "piece", "cells", "features", "facets", "tree", "thick", "sight", "merges", "contours"};

struct StageCost {
    double seconds = 0; ///< of the processor
    uint64_t peak = 0;  ///< bytes of the process at most during the stage
};
using StageCosts = std::array<StageCost, kSegmentStages.size()>;

/// Runs the stages one by one on the component of a mesh with most faces, as PerceptualSegmenter does.
StageCosts segmentInStages(const bake::Mesh& mesh);

} // namespace xgc::bench
