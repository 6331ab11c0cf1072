#pragma once

#include "drawn_asset.h"

namespace xgc::viewer {

struct UniformLevel {
    uint32_t level = 0;
    uint64_t triangles = 0;
};

/// Triangles of the visible patches with all patches at one level; assets without it stand at their coarsest.
uint64_t uniformTriangles(std::span<const DrawnAsset> assets, uint32_t level);

/// The finest level at which the visible patches have at most so many triangles; the coarsest where none has.
UniformLevel uniformLevelWithin(std::span<const DrawnAsset> assets, uint64_t triangles);

} // namespace xgc::viewer
