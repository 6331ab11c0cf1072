#pragma once

#include <xgc/bake/model.h>

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

private:
    std::vector<std::pair<uint32_t, uint32_t>> pairs_;
};

} // namespace xgc::bake
