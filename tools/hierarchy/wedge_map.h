#pragma once

#include <xgc/bake/model.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace xgc::bake {

/// What becomes of the wedges of a vertex that collapses: told by the faces that die, which have both ends.
class WedgeMap {
public:
    void clear() { pairs_.clear(); }
    /// False where the wedge has another target already.
    bool add(uint32_t from, uint32_t to) {
        const uint32_t known = (*this)(from);
        if (known == kNone) pairs_.emplace_back(from, to);
        return known == kNone || known == to;
    }
    /// kNone where it has none.
    uint32_t operator()(uint32_t from) const {
        for (const auto& [f, t] : pairs_) {
            if (f == from) return t;
        }
        return kNone;
    }
    uint32_t any() const { return pairs_.front().second; }
    const std::vector<std::pair<uint32_t, uint32_t>>& pairs() const { return pairs_; }
    /// Whether no two wedges go into one.
    bool isOneToOne() const {
        for (size_t i = 0; i < pairs_.size(); ++i) {
            for (size_t k = 0; k < i; ++k) {
                if (pairs_[i].second == pairs_[k].second) return false;
            }
        }
        return true;
    }
    bool reaches(uint32_t to) const {
        return std::any_of(pairs_.begin(), pairs_.end(), [to](const auto& pair) { return pair.second == to; });
    }
    /// Where the made wedges of the pairs, numbered from `first`, take the place of both.
    void setMade(const WedgeMap& paired, uint32_t first, bool ofTargets) {
        pairs_.clear();
        for (const auto& [from, to] : paired.pairs_) pairs_.emplace_back(ofTargets ? to : from, first++);
    }

private:
    std::vector<std::pair<uint32_t, uint32_t>> pairs_;
};

} // namespace xgc::bake
