#pragma once

#include "memory.h"
#include "range_allocator.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace xgc {

/// Finds ids by keys of any length. Chained buckets; the hash only tells where to look: keys are compared in full.
/// Their bytes lie in one pool.
class KeyTable {
public:
    static constexpr uint32_t kNone = format::kNone;
    using Key = std::span<const std::byte>;

    /// Ids lie below `idCapacity`; all keys together take at most `poolBytes`.
    [[nodiscard]] bool create(uint32_t idCapacity, uint32_t poolBytes);

    static uint32_t hash(Key key);

    uint32_t find(Key key, uint32_t hash) const;
    /// Gives an id that has none a key that is not there. False, and nothing changed, where the pool has no room.
    [[nodiscard]] bool insert(uint32_t id, Key key, uint32_t hash);
    void remove(uint32_t id);

private:
    struct Named {
        uint32_t bytes = RangeAllocator::kNoRange; ///< its key in the pool; kNoRange: has none
        uint32_t hash = 0;
        uint32_t next = kNone; ///< in its bucket
    };

    uint32_t& bucketOf(uint32_t hash) { return buckets_[hash & (buckets_.size() - 1)]; }
    bool matches(const Named& named, Key key, uint32_t hash) const;

    FixedArray<uint32_t> buckets_; ///< first id of each; a power of two of them
    FixedArray<Named> named_;
    FixedArray<std::byte> pool_;
    RangeAllocator poolRanges_;
};

} // namespace xgc
