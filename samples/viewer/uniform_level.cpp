#include "uniform_level.h"

#include <algorithm>

namespace xgc::viewer {

uint64_t uniformTriangles(std::span<const DrawnAsset> assets, uint32_t level) {
    uint64_t sum = 0;
    for (const DrawnAsset& drawn : assets) {
        const uint32_t own = std::min(level, drawn.asset->levelCount() - 1);
        for (uint32_t patch = 0; patch < drawn.asset->patchCount(); ++patch) {
            if (drawn.visible[patch]) sum += xgc::uniformTriangles(*drawn.asset, patch, own);
        }
    }
    return sum;
}

UniformLevel uniformLevelWithin(std::span<const DrawnAsset> assets, uint64_t triangles) {
    uint32_t levels = 1;
    for (const DrawnAsset& drawn : assets) levels = std::max(levels, drawn.asset->levelCount());
    UniformLevel out;
    for (uint32_t level = 0; level < levels; ++level) {
        out = {level, uniformTriangles(assets, level)};
        if (out.triangles <= triangles) break;
    }
    return out;
}

} // namespace xgc::viewer
