#include "patch_lanes.h"
#include "selection.h"

#include <limits>

// Most patches keep their level from one frame to the next. While a view asks for the same, each patch has an interval
// of squared distances in which it surely does; only outside of it is the policy itself asked. The interval is drawn in
// by more than what rounding can move, so levels are those of the policy to the bit.

namespace xgc {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kMargin = 1e-6f; // relative; of some eight roundings of 6e-8

/// Squared distances from which on an error fits: surely beyond `from`, surely not below `before`.
struct Threshold {
    float from = 0, before = 0;
};

Threshold thresholdOf(const LevelTest& test, uint32_t level, const Strictness& s) {
    if (level == 0) return {};
    const float error = test.errors[level] * test.importance, pixels = s.pixels;
    const float projected = error * test.policy.view.pixelsPerUnit;
    if (error == 0 || pixels > FLT_MAX) return {};
    if (test.at.scale * projected <= pixels * test.policy.view.nearest) return {};
    const float reach = test.at.scale * (projected + pixels * test.at.radius), reachSquared = reach * reach;
    const float pixelsSquared = pixels * pixels;
    const bool normal = reachSquared <= FLT_MAX && pixelsSquared >= FLT_MIN && reachSquared >= FLT_MIN;
    if (!normal) return {kInfinity, 0}; // the policy is asked each time
    const float distance = reachSquared / pixelsSquared;
    return {distance * (1 + kMargin), distance * (1 - kMargin)};
}

} // namespace

/// Where the level surely stays what it is.
KeptLevel Selection::Impl::keptLevel(const LevelTest& test, uint32_t level, bool mayCoarsen) const {
    const Threshold own = thresholdOf(test, level, policy.loose);
    const bool coarser = mayCoarsen && level + 1 < test.levelCount();
    return {own.from, coarser ? thresholdOf(test, level + 1, policy.tight).before : kInfinity};
}

bool Selection::Impl::isSteady(const Subject& s) const {
    return steadyPolicy && s.controls.empty() && !s.reference;
}

void Selection::Impl::chooseSteady(const Subject& s, ChunkCount& count) {
    const bool mayCoarsen = !s.own.inBelt;
    const float scale = s.instance.placement.maxScale;
    KeptLevel* kept = keptLevels.data() + s.instance.firstSlot;
    const auto patchCount = uint32_t(s.patches.size());
    if (s.own.keptEpoch != epoch || s.own.keptScale != scale || s.own.keptInBelt != s.own.inBelt) {
        std::fill_n(kept, patchCount, KeptLevel{kInfinity, 0});
        s.own.keptEpoch = epoch;
        s.own.keptScale = scale;
        s.own.keptInBelt = s.own.inBelt;
    }
    const MeshEye eye = desc.cullBackfaces ? meshEye(desc.view, s.instance.placement) : MeshEye{};
    const PatchLanes all = scene->lanes.lanes().from(s.stored.firstPatch);
    const uint32_t coarsest = s.asset.levelCount() - 1;
    std::array<float, kLaneBlock> distance;
    std::array<uint8_t, kLaneBlock> away{};
    uint32_t culled = 0, changed = 0;
    for (uint32_t first = 0; first < patchCount; first += kLaneBlock) {
        const PatchLanes lanes = all.from(first);
        const uint32_t n = std::min(kLaneBlock, patchCount - first);
        distancesSquared(lanes, n, s.instance.placement, desc.view, distance.data());
        if (eye.valid) conesTurnedAway(lanes, n, eye, away.data());
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t p = first + i;
            uint32_t level = coarsest;
            if (s.visible[p]) {
                level = s.wanted[p];
                if (!(distance[i] >= kept[p].from && distance[i] < kept[p].before)) {
                    const LevelTest test = s.patchTest(policy, p);
                    level = test.next(level, mayCoarsen);
                    s.wanted[p] = uint8_t(level);
                    kept[p] = keptLevel(test, level, mayCoarsen);
                }
                if (away[i] && level <= lanes.coneLevel[i]) {
                    s.visible[p] = 0;
                    level = std::min<uint32_t>(lanes.coneLevel[i], coarsest);
                }
            }
            culled += !s.visible[p];
            changed += s.levels[p] != level;
            s.levels[p] = uint8_t(level);
        }
    }
    count.stats.consideredPatches += patchCount;
    count.stats.culledPatches += culled;
    count.stats.changedPatches += changed;
}

} // namespace xgc
