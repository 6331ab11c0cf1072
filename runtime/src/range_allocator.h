#pragma once

#include "memory.h"

#include <xgc/format.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace xgc {

/// Hands out ranges of 0..size: offsets only, no memory behind them. A range is named by its handle. Free ranges
/// are merged with their free neighbours at once and kept in bins by size (eight a power of two), so both calls
/// take constant time, and a request takes a range that is at most an eighth larger than the least that would do,
/// except when memory is nearly full.
class RangeAllocator {
public:
    static constexpr uint32_t kNoRange = format::kNone;

    /// `maxRanges`: most ranges that live at once.
    [[nodiscard]] bool create(uint32_t size, uint32_t maxRanges);

    /// A range of `count` > 0, or kNoRange where none is large enough or maxRanges are taken.
    uint32_t allocate(uint32_t count);
    /// Returns the count of the free run that it is now part of.
    uint32_t free(uint32_t range);

    uint32_t offset(uint32_t range) const { return nodes_[range].offset; }
    uint32_t count(uint32_t range) const { return nodes_[range].count; }
    uint32_t freeTotal() const { return freeTotal_; }
    /// Count of the longest free run. Looks through all runs of its bin.
    uint32_t longestFree() const;
    uint32_t rangeCount() const { return rangeCount_; }

private:
    static constexpr uint32_t kBinBits = 3;
    static constexpr uint32_t kBins = 32u << kBinBits;

    /// A run of memory, taken or free. Neighbours in memory are linked; so are free runs of one bin, and unused
    /// nodes (by nextInBin).
    struct Node {
        uint32_t offset = 0;
        uint32_t count = 0;
        uint32_t before = kNoRange;
        uint32_t after = kNoRange;
        uint32_t previousInBin = kNoRange;
        uint32_t nextInBin = kNoRange;
        bool taken = false;
    };

    static uint32_t binOf(uint32_t count);
    uint32_t findFree(uint32_t count) const;
    void putInBin(uint32_t node);
    void takeFromBin(uint32_t node);
    uint32_t newNode();
    void absorbNext(uint32_t node);

    FixedArray<Node> nodes_;
    std::array<uint32_t, kBins> bins_{};
    std::array<uint64_t, kBins / 64> filled_{}; ///< a bit a bin that is not empty
    uint32_t unused_ = kNoRange;
    uint32_t freeTotal_ = 0;
    uint32_t rangeCount_ = 0;
    uint32_t maxRanges_ = 0;
};

} // namespace xgc
