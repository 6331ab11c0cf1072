#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace xgc::bake {

/// Vertices by cost, cheapest first, equal ones by number. An entry is void once its vertex has another stamp.
class CollapseQueue {
public:
    struct Entry {
        double cost;
        uint32_t vertex, stamp;
        bool operator<(const Entry& other) const { // std's heaps put the largest on top
            return cost != other.cost ? cost > other.cost : vertex > other.vertex;
        }
    };

    void push(const Entry& entry) {
        heap_.push_back(entry);
        std::push_heap(heap_.begin(), heap_.end());
    }
    bool hasBelow(double limit) const { return !heap_.empty() && heap_.front().cost <= limit; }
    Entry pop() {
        std::pop_heap(heap_.begin(), heap_.end());
        const Entry entry = heap_.back();
        heap_.pop_back();
        return entry;
    }

private:
    std::vector<Entry> heap_;
};

} // namespace xgc::bake
