#include "range_allocator.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace xgc {

bool RangeAllocator::create(uint32_t size, uint32_t maxRanges) {
    // Free ranges never touch, so there is at most one more of them than of taken ones.
    if (!nodes_.allocate(2 * size_t(maxRanges) + 1)) return false;
    bins_.fill(kNoRange);
    filled_.fill(0);
    unused_ = kNoRange;
    for (size_t i = nodes_.size(); i-- > 0;) {
        nodes_[i].nextInBin = unused_;
        unused_ = uint32_t(i);
    }
    freeTotal_ = size;
    rangeCount_ = 0;
    maxRanges_ = maxRanges;
    if (size > 0) {
        const uint32_t all = newNode();
        nodes_[all].count = size;
        putInBin(all);
    }
    return true;
}

/// Bins of equal width within each power of two; counts below 8 have one each.
uint32_t RangeAllocator::binOf(uint32_t count) {
    constexpr uint32_t kPerPower = 1u << kBinBits;
    if (count < kPerPower) return count;
    const uint32_t power = uint32_t(std::bit_width(count)) - 1;
    const uint32_t within = (count >> (power - kBinBits)) & (kPerPower - 1);
    return ((power - kBinBits + 1) << kBinBits) + within;
}

/// A free node of at least `count`: the best of its own bin, whose ranges may be too small, else any of the next
/// filled bin.
uint32_t RangeAllocator::findFree(uint32_t count) const {
    const uint32_t bin = binOf(count);
    // A short look for a near-exact fit keeps large runs whole.
    constexpr uint32_t kLooks = 8;
    uint32_t best = kNoRange, looked = 0;
    for (uint32_t n = bins_[bin]; n != kNoRange && looked < kLooks; n = nodes_[n].nextInBin, ++looked) {
        if (nodes_[n].count >= count && (best == kNoRange || nodes_[n].count < nodes_[best].count)) best = n;
    }
    if (best != kNoRange) return best;
    const uint32_t next = bin + 1;
    for (uint32_t word = next / 64; word < filled_.size(); ++word) {
        uint64_t bits = filled_[word];
        if (word == next / 64) bits &= ~uint64_t(0) << (next % 64);
        if (bits) return bins_[word * 64 + uint32_t(std::countr_zero(bits))];
    }
    // Nearly full: the rest of the own bin is all that is left.
    for (uint32_t n = bins_[bin]; n != kNoRange; n = nodes_[n].nextInBin) {
        if (nodes_[n].count >= count) return n;
    }
    return kNoRange;
}

void RangeAllocator::putInBin(uint32_t node) {
    const uint32_t bin = binOf(nodes_[node].count);
    nodes_[node].previousInBin = kNoRange;
    nodes_[node].nextInBin = bins_[bin];
    if (bins_[bin] != kNoRange) nodes_[bins_[bin]].previousInBin = node;
    bins_[bin] = node;
    filled_[bin / 64] |= uint64_t(1) << (bin % 64);
}

void RangeAllocator::takeFromBin(uint32_t node) {
    const uint32_t bin = binOf(nodes_[node].count);
    const uint32_t previous = nodes_[node].previousInBin, next = nodes_[node].nextInBin;
    if (previous != kNoRange)
        nodes_[previous].nextInBin = next;
    else
        bins_[bin] = next;
    if (next != kNoRange) nodes_[next].previousInBin = previous;
    if (bins_[bin] == kNoRange) filled_[bin / 64] &= ~(uint64_t(1) << (bin % 64));
}

uint32_t RangeAllocator::newNode() {
    const uint32_t node = unused_;
    assert(node != kNoRange);
    unused_ = nodes_[node].nextInBin;
    nodes_[node] = Node{};
    return node;
}

uint32_t RangeAllocator::allocate(uint32_t count) {
    assert(count > 0);
    if (rangeCount_ == maxRanges_ || count > freeTotal_) return kNoRange;
    const uint32_t node = findFree(count);
    if (node == kNoRange) return kNoRange;
    takeFromBin(node);
    if (nodes_[node].count > count) {
        const uint32_t rest = newNode();
        nodes_[rest].offset = nodes_[node].offset + count;
        nodes_[rest].count = nodes_[node].count - count;
        nodes_[rest].before = node;
        nodes_[rest].after = nodes_[node].after;
        if (nodes_[rest].after != kNoRange) nodes_[nodes_[rest].after].before = rest;
        nodes_[node].after = rest;
        nodes_[node].count = count;
        putInBin(rest);
    }
    nodes_[node].taken = true;
    freeTotal_ -= count;
    ++rangeCount_;
    return node;
}

/// Merges the free node after `node` into it.
void RangeAllocator::absorbNext(uint32_t node) {
    const uint32_t next = nodes_[node].after;
    nodes_[node].count += nodes_[next].count;
    nodes_[node].after = nodes_[next].after;
    if (nodes_[node].after != kNoRange) nodes_[nodes_[node].after].before = node;
    nodes_[next].nextInBin = unused_;
    unused_ = next;
}

uint32_t RangeAllocator::free(uint32_t range) {
    assert(range < nodes_.size() && nodes_[range].taken);
    nodes_[range].taken = false;
    freeTotal_ += nodes_[range].count;
    --rangeCount_;
    const uint32_t after = nodes_[range].after;
    if (after != kNoRange && !nodes_[after].taken) {
        takeFromBin(after);
        absorbNext(range);
    }
    const uint32_t before = nodes_[range].before;
    if (before != kNoRange && !nodes_[before].taken) {
        takeFromBin(before);
        absorbNext(before);
        range = before;
    }
    putInBin(range);
    return nodes_[range].count;
}

uint32_t RangeAllocator::longestFree() const {
    for (uint32_t word = uint32_t(filled_.size()); word-- > 0;) {
        if (filled_[word] == 0) continue;
        uint32_t longest = 0;
        const uint32_t bin = word * 64 + uint32_t(std::bit_width(filled_[word])) - 1;
        for (uint32_t n = bins_[bin]; n != kNoRange; n = nodes_[n].nextInBin)
            longest = std::max(longest, nodes_[n].count);
        return longest;
    }
    return 0;
}

} // namespace xgc
