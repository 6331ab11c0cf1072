#include "index_pack.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace xgc {

void RowSpan::add(std::span<const uint32_t> rows) {
    uint32_t least = first, most = last;
    for (const uint32_t row : rows) {
        least = std::min(least, row);
        most = std::max(most, row);
    }
    first = least;
    last = most;
}

void packNarrow(std::span<const uint32_t> rows, uint32_t first, std::byte* out) {
    // By blocks: mapped memory likes long writes, and `out` may be at any even address of it.
    std::array<uint16_t, 256> block;
    for (size_t at = 0; at < rows.size(); at += block.size()) {
        const size_t count = std::min(block.size(), rows.size() - at);
        for (size_t i = 0; i < count; ++i) block[i] = uint16_t(rows[at + i] - first);
        std::memcpy(out + sizeof(uint16_t) * at, block.data(), sizeof(uint16_t) * count);
    }
}

} // namespace xgc
