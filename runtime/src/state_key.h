#pragma once

#include <xgc/indices.h>

#include <algorithm>
#include <cstddef>

namespace xgc {

// What names an index list, byte for byte: equal keys have equal triangles.
//
//   a patch         [ asset id: 4 | patch: 4    | level of its interior | level of each of its domains ]
//   streamed        [ asset id: 4 | patch: 4    | stamp: 4 | likewise ]
//   a whole asset   [ asset id: 4 | format::kNone | material: 4 | level ]
//
// A level is told as the lowest one at which the same vertices are alive: states that look alike have one key.

/// Most bytes of a key of a patch with so many domains, and of a whole asset's.
constexpr size_t stateKeyBytes(uint32_t domainCount) {
    return 4 + 4 + 4 + 1 + size_t(domainCount);
}

/// Lowest level at which as many rows of the range are alive.
uint32_t canonicalLevel(const AssetView& asset, format::VertexRange range, uint32_t level);

/// These write a key of at most stateKeyBytes to `key` and return its bytes.
size_t writePatchKey(uint32_t assetId, const AssetView& asset, uint32_t patch, Levels levels, std::byte* key);
size_t writeWholeKey(uint32_t assetId, uint32_t material, uint32_t level, std::byte* key);

} // namespace xgc
