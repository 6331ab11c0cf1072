#pragma once

#include "level_test.h"

#include <xgc/selection.h>
#include <xgc/skin.h>

#include <algorithm>

// How a level is chosen under a policy, and kept. Three degrees of strictness, loose (the policy's own), middle and
// tight, each a factor of 1 - hysteresis apart in distance:
//
//   tight     middle     loose
//   ---|---------|---------|---->  finer levels to the left
//      [ a level in here is kept ]
//                |  one outside of it becomes this
//
// After a change the level lies at the middle, so the distance has to change by the factor before the next one, either
// way.

namespace xgc {

/// No level was chosen yet.
inline constexpr uint32_t kNoLevel = format::kNever;

struct Strictness {
    float pixels = 1;     ///< of errorPixels
    float bandFactor = 1; ///< of the bands
};

/// A policy at work in a view.
struct LevelPolicy {
    View view;
    Policy policy = Policy::errorPixels;
    std::span<const float> bands;
    Strictness loose, middle, tight;
};

inline LevelPolicy levelPolicy(const SelectionDesc& desc, float pixels) {
    const float keep = 1 - desc.hysteresis, factor = 1 / keep;
    return {desc.view,
            desc.policy,
            desc.bands,
            {pixels, 1},
            {pixels * keep, factor},
            {pixels * keep * keep, factor * factor}};
}

/// The levels of one sphere under a policy.
struct LevelTest {
    const LevelPolicy& policy;
    std::span<const float> errors; ///< a level each, rising
    float importance;
    float assetRadius;
    Standing at; ///< of errorStanding for errorPixels
    // Of a patch of an instance with a pose; else null.
    const AssetView* posedAsset = nullptr;
    const PosedPatch* posed = nullptr;
    uint32_t patch = 0;
    std::span<const float> morphWeights{};

    float error(uint32_t level) const {
        return posed ? posedError(*posedAsset, patch, level, *posed, morphWeights) : errors[level];
    }

    uint32_t levelCount() const {
        const size_t all = errors.size();
        return uint32_t(policy.policy == Policy::errorPixels ? all : std::min(policy.bands.size() + 1, all));
    }
    /// Rising: where a level does not fit, no coarser one does. Level 0 always fits.
    bool fits(uint32_t level, const Strictness& s) const {
        if (level == 0) return true;
        if (policy.policy == Policy::errorPixels) {
            return errorFits(error(level) * importance, policy.view, s.pixels, at);
        }
        return bandReached(policy.bands[level - 1] * importance * s.bandFactor, assetRadius, at);
    }
    /// The coarsest that fits; `hint` is where to look first.
    uint32_t coarsest(const Strictness& s, uint32_t hint) const {
        const uint32_t count = levelCount();
        uint32_t level = std::min(hint, count - 1);
        while (!fits(level, s)) --level;
        while (level + 1 < count && fits(level + 1, s)) ++level;
        return level;
    }
    /// What becomes of `previous` (kNoLevel: none). Where it may not coarsen, a level that fits is kept.
    uint32_t next(uint32_t previous, bool mayCoarsen = true) const {
        if (previous < levelCount() && fits(previous, policy.loose)) {
            const bool coarsens = mayCoarsen && previous + 1 < levelCount() && fits(previous + 1, policy.tight);
            if (!coarsens) return previous;
        }
        return coarsest(policy.middle, previous == kNoLevel ? 0 : previous);
    }
};

inline Standing standingFor(const LevelPolicy& policy, const Placement& placement, const Sphere& sphere) {
    return policy.policy == Policy::errorPixels ? errorStanding(placement, policy.view, sphere)
                                                : standing(placement, policy.view, sphere);
}

/// A part's control on a policy's level.
inline uint32_t steered(const PartControl& control, uint32_t level, uint32_t levelCount) {
    const int64_t biased = std::max<int64_t>(int64_t(level) + control.bias, 0);
    const uint32_t limited = std::min(uint32_t(std::max<int64_t>(biased, control.finest)), control.coarsest);
    return std::min(limited, levelCount - 1);
}

} // namespace xgc
