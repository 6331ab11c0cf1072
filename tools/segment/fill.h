#pragma once

#include "convexity.h"

namespace xgc::bake {

/// Regions per face, dense, numbered in the order of their making.
struct Regions {
    std::vector<uint32_t> ofFace;
    uint32_t count = 0;
};

/// Fills saliences, then recesses, then saliences again with what is left (thesis 3.5, algorithm 1).
Regions fillRegions(const Topology& topology, std::span<const EdgeKind> kinds, bool seedFromConvexEdges);

} // namespace xgc::bake
