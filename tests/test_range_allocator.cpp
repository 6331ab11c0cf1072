#include "../runtime/src/range_allocator.h"
#include "random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <vector>

TEST_CASE("ranges never overlap, and all of it is one range when all are free") {
    xgc::test::Random random(3);
    constexpr uint32_t kSize = 5000;
    xgc::RangeAllocator allocator;
    REQUIRE(allocator.create(kSize, 64));
    std::vector<uint32_t> owner(kSize, 0), live;
    for (uint32_t step = 1; step < 20000; ++step) {
        if (random.below(100) < 52) {
            const uint32_t count = 1 + random.below(random.below(2) ? 300 : 9);
            const uint32_t r = allocator.allocate(count);
            if (r == xgc::RangeAllocator::kNoRange) continue;
            uint32_t taken = 0;
            for (uint32_t i = 0; i < count; ++i) {
                taken += owner[allocator.offset(r) + i] != 0;
                owner[allocator.offset(r) + i] = step;
            }
            CHECK(taken == 0);
            CHECK(allocator.count(r) == count);
            live.push_back(r);
        } else if (!live.empty()) {
            const uint32_t k = random.below(uint32_t(live.size()));
            for (uint32_t i = 0; i < allocator.count(live[k]); ++i) owner[allocator.offset(live[k]) + i] = 0;
            allocator.free(live[k]);
            live[k] = live.back();
            live.pop_back();
        }
        CHECK(allocator.freeTotal() == uint32_t(std::count(owner.begin(), owner.end(), 0u)));
        CHECK(allocator.rangeCount() == live.size());
    }
    for (const uint32_t r : live) allocator.free(r);
    const uint32_t all = allocator.allocate(kSize);
    CHECK(all != xgc::RangeAllocator::kNoRange);
    CHECK(allocator.allocate(1) == xgc::RangeAllocator::kNoRange);
}

TEST_CASE("a request is refused only where no free range holds it") {
    xgc::test::Random random(4);
    constexpr uint32_t kSize = 2000;
    xgc::RangeAllocator allocator;
    REQUIRE(allocator.create(kSize, 1000));
    std::vector<bool> taken(kSize, false);
    std::vector<uint32_t> live;
    int refused = 0;
    for (int step = 0; step < 5000; ++step) {
        const uint32_t count = 1 + random.below(90);
        const uint32_t wasLongest = allocator.longestFree(), r = allocator.allocate(count);
        uint32_t longest = 0;
        for (uint32_t i = 0, run = 0; i < kSize; ++i) longest = std::max(longest, run = taken[i] ? 0 : run + 1);
        CHECK((r != xgc::RangeAllocator::kNoRange) == (longest >= count));
        CHECK(wasLongest == longest);
        if (r != xgc::RangeAllocator::kNoRange) {
            std::fill_n(taken.begin() + allocator.offset(r), count, true);
            live.push_back(r);
            continue;
        }
        ++refused;
        const uint32_t k = random.below(uint32_t(live.size()));
        std::fill_n(taken.begin() + allocator.offset(live[k]), allocator.count(live[k]), false);
        allocator.free(live[k]);
        live.erase(live.begin() + k);
    }
    CHECK(refused > 500);
}
