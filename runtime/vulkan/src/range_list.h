#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace xgc::vulkan {

/// Cuts ranges from [0, size), first fit, and takes them back. For things that come and go with assets, not in frames.
class RangeList {
public:
    struct Range {
        uint64_t first = 0;
        uint64_t count = 0;
    };

    void create(uint64_t size) { holes_.assign(1, {0, size}); }

    bool allocate(uint64_t count, Range& out) {
        const auto hole = std::find_if(holes_.begin(), holes_.end(), [&](const Range& h) { return h.count >= count; });
        if (hole == holes_.end()) return false;
        out = {hole->first, count};
        hole->first += count;
        hole->count -= count;
        if (hole->count == 0) holes_.erase(hole);
        return true;
    }

    void free(const Range& range) {
        if (range.count == 0) return;
        auto at = std::lower_bound(holes_.begin(), holes_.end(), range,
                                   [](const Range& a, const Range& b) { return a.first < b.first; });
        at = holes_.insert(at, range);
        if (at + 1 != holes_.end() && end(*at) == (at + 1)->first) {
            at->count += (at + 1)->count;
            holes_.erase(at + 1);
        }
        if (at != holes_.begin() && end(*(at - 1)) == at->first) {
            (at - 1)->count += at->count;
            holes_.erase(at);
        }
    }

private:
    static uint64_t end(const Range& range) { return range.first + range.count; }

    std::vector<Range> holes_; ///< by first, none touching the next
};

} // namespace xgc::vulkan
