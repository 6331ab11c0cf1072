#pragma once

#include <xgc/asset.h>

#include <algorithm>

namespace xgc {

/// Rows of a range that are alive at a level: collapse levels fall within it.
inline uint32_t aliveCount(const AssetView& asset, format::VertexRange range, uint32_t level) {
    const uint8_t* first = asset.collapseLevels.data() + range.first;
    // The ends answer most questions, and a branch predictor knows them.
    if (range.count == 0 || first[0] <= level) return 0;
    if (first[range.count - 1] > level) return range.count;
    return uint32_t(std::partition_point(first, first + range.count, [&](uint8_t c) { return c > level; }) - first);
}

} // namespace xgc
