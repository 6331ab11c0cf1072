#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace xgc {

/// The vertex rows that index lists name, as first and last.
struct RowSpan {
    uint32_t first = UINT32_MAX;
    uint32_t last = 0;

    void add(std::span<const uint32_t> rows);
    /// Whether 16 bits hold every row less the first. 0xffff is left out: some APIs end a primitive there, always.
    bool isNarrow() const { return first <= last && last - first < 0xffff; }
};

/// Writes rows less `first` as 16-bit numbers, in order and without reading `out`.
void packNarrow(std::span<const uint32_t> rows, uint32_t first, std::byte* out);

} // namespace xgc
