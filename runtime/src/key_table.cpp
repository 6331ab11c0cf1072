#include "key_table.h"

#include "xxh64.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

namespace xgc {

bool KeyTable::create(uint32_t idCapacity, uint32_t poolBytes) {
    if (!buckets_.allocate(std::bit_ceil(size_t(idCapacity))) || !named_.allocate(idCapacity) ||
        !pool_.allocate(poolBytes) || !poolRanges_.create(poolBytes, idCapacity)) {
        return false;
    }
    std::fill_n(buckets_.data(), buckets_.size(), kNone);
    return true;
}

uint32_t KeyTable::hash(Key key) {
    const uint64_t wide = xxh64(key);
    return uint32_t(wide ^ (wide >> 32));
}

bool KeyTable::matches(const Named& named, Key key, uint32_t hash) const {
    return named.hash == hash && poolRanges_.count(named.bytes) == key.size() &&
           std::memcmp(pool_.data() + poolRanges_.offset(named.bytes), key.data(), key.size()) == 0;
}

uint32_t KeyTable::find(Key key, uint32_t hash) const {
    uint32_t id = buckets_[hash & (buckets_.size() - 1)];
    while (id != kNone && !matches(named_[id], key, hash)) id = named_[id].next;
    return id;
}

bool KeyTable::insert(uint32_t id, Key key, uint32_t hash) {
    assert(named_[id].bytes == RangeAllocator::kNoRange && find(key, hash) == kNone);
    const uint32_t bytes = poolRanges_.allocate(uint32_t(key.size()));
    if (bytes == RangeAllocator::kNoRange) return false;
    std::memcpy(pool_.data() + poolRanges_.offset(bytes), key.data(), key.size());
    uint32_t& bucket = bucketOf(hash);
    named_[id] = {bytes, hash, bucket};
    bucket = id;
    return true;
}

void KeyTable::remove(uint32_t id) {
    Named& named = named_[id];
    assert(named.bytes != RangeAllocator::kNoRange);
    uint32_t* link = &bucketOf(named.hash);
    while (*link != id) link = &named_[*link].next;
    *link = named.next;
    poolRanges_.free(named.bytes);
    named = Named{};
}

} // namespace xgc
