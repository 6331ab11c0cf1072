#pragma once

#include "memory.h"

#include <xgc/format.h>

#include <cstdint>

namespace xgc {

/// Neighbours of an id in the list that it is in.
struct IdLink {
    uint32_t previous = format::kNone;
    uint32_t next = format::kNone;
};

/// Ids in the order in which they were appended; any of them leaves in constant time. Several lists share one array of
/// links where an id is in one of them at most.
class IdList {
public:
    static constexpr uint32_t kEnd = format::kNone;

    explicit IdList(FixedArray<IdLink>& links) : links_(links) {}

    bool empty() const { return first_ == kEnd; }
    uint32_t first() const { return first_; }
    uint32_t next(uint32_t id) const { return links_[id].next; }

    void append(uint32_t id) {
        links_[id] = {last_, kEnd};
        (last_ == kEnd ? first_ : links_[last_].next) = id;
        last_ = id;
    }
    void remove(uint32_t id) {
        const IdLink link = links_[id];
        (link.previous == kEnd ? first_ : links_[link.previous].next) = link.next;
        (link.next == kEnd ? last_ : links_[link.next].previous) = link.previous;
    }

private:
    FixedArray<IdLink>& links_;
    uint32_t first_ = kEnd;
    uint32_t last_ = kEnd;
};

} // namespace xgc
