#pragma once

#include "level_choice.h"

#include <xgc/morph.h>

#include <cmath>

// Continuous levels: where a patch stands between the thresholds of two levels, in what they are thresholds of.
//
//   level     0            1       2                  3
//   step      |------------|-------|------------------|---->  error that is allowed, or distance in radii
//                                        ^ at: 2 + how far it is from step 2 to step 3
//
// Steps that lie closer than an eighth are pushed up, never down: so what is chosen is never too coarse, and lambda
// changes by at most 9 times the relative change of `at`.

namespace xgc {

inline constexpr float kLeastStepRatio = 1.125f;

/// The continuous level at `at`. step(0) to step(count - 1) rise; `least`: of a step above zero.
template <typename Step>
float continuousLevel(uint32_t count, float at, float least, Step step) {
    float below = step(0);
    if (!(at > below)) return 0;
    for (uint32_t level = 1; level < count; ++level) {
        const float above = std::max(step(level), below * kLeastStepRatio + least);
        if (at < above) return float(level - 1) + std::min((at - below) / (above - below), kMaxFraction);
        below = above;
    }
    return float(count - 1);
}

/// Distance from the eye to a sphere in world units, 0 inside; 0 where squares leave the range of floats.
inline float distanceTo(const Standing& at) {
    if (!(at.distanceSquared <= FLT_MAX)) return 0;
    return std::max(std::sqrt(at.distanceSquared) - at.scale * at.radius, 0.0f);
}

/// The continuous level of a test: where its fraction is 0, a level that fits.
inline float continuousLevel(const LevelTest& test) {
    constexpr float kLeast = 1e-7f; // of the radius, and of one
    const View& view = test.policy.view;
    if (test.policy.policy == Policy::distanceBands) {
        const float radii = distanceTo(test.at) / (test.at.scale * test.assetRadius);
        return continuousLevel(test.levelCount(), radii, kLeast, [&](uint32_t level) {
            return level == 0 ? 0 : test.policy.bands[level - 1] * test.importance;
        });
    }
    const float away = view.orthographic ? 1 : std::max(distanceTo(test.at), view.nearest);
    const float projected = test.at.scale * view.pixelsPerUnit; // pixels of a unit of the mesh at distance 1
    if (!(projected > 0) || test.policy.loose.pixels > FLT_MAX) return float(test.levelCount() - 1);
    return continuousLevel(test.levelCount(), test.policy.loose.pixels * away / projected, kLeast * test.assetRadius,
                           [&](uint32_t level) { return test.error(level) * test.importance; });
}

/// A part's control on a continuous level.
inline float steered(const PartControl& control, float lambda, uint32_t levelCount) {
    const float limited = std::min(std::max(std::max(lambda + float(control.bias), 0.0f), float(control.finest)),
                                   float(control.coarsest));
    return std::min(limited, float(levelCount - 1));
}

} // namespace xgc
