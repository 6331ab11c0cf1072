#pragma once

#include "surface.h"

namespace xgc::bench {

/// A surface after a change that leaves its shape as good as it was, and what it was made of.
struct ChangedSurface {
    Surface surface;            ///< positions alone
    std::vector<uint32_t> from; ///< per triangle: one of the original
};

ChangedSurface scaled(const Surface& original, float factor);
/// By an odd factor, and away from the origin.
ChangedSurface movedAndScaled(const Surface& original);
/// By a rotation drawn with `seed`, and its triangles and points in an order drawn likewise.
ChangedSurface rotatedAndShuffled(const Surface& original, uint32_t seed);
/// By meshopt_simplify; `from` is the nearest triangle.
ChangedSurface decimated(const Surface& original, double share);
/// Every triangle split in four at the middles of its edges, `rounds` times. Points repeat: weld it.
ChangedSurface subdivided(const Surface& original, int rounds);
/// Every coordinate moved by a normal deviate of `share` of the diagonal of the bounds.
ChangedSurface noisy(const Surface& original, double share, uint32_t seed);

} // namespace xgc::bench
