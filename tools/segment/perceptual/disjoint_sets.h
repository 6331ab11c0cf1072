#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace xgc::bake {

/// Numbers in sets that join; a set goes by its lowest member.
class DisjointSets {
public:
    explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    uint32_t find(uint32_t i) {
        while (parent_[i] != i) {
            parent_[i] = parent_[parent_[i]];
            i = parent_[i];
        }
        return i;
    }
    /// False where both were in one set already.
    bool join(uint32_t i, uint32_t j) {
        i = find(i);
        j = find(j);
        parent_[std::max(i, j)] = std::min(i, j);
        return i != j;
    }

private:
    std::vector<uint32_t> parent_;
};

} // namespace xgc::bake
