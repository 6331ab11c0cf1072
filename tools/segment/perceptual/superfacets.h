#pragma once

#include "edge_features.h"

namespace xgc::bake {

/// Small regions of cells that end at concave contours where they can: what is merged into parts.
struct Superfacets {
    std::vector<uint32_t> ofCell;
    std::vector<uint32_t> seeds; ///< a cell each
    uint32_t count() const { return uint32_t(seeds.size()); }
};

/// About `wanted` of them, more where the piece is in more islands: cells go to the seed that is nearest along the
/// graph, where a concave angle costs a toll, and seeds lie far from each other.
Superfacets growSuperfacets(const CellGraph& graph, const EdgeFeatures& features, uint32_t wanted);

} // namespace xgc::bake
