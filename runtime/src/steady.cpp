#include "patch_lanes.h"
#include "selection.h"

#include <algorithm>
#include <array>
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
    return steadyPolicy && s.controls.empty() && s.posed.empty() && !s.reference &&
           !s.asset.residence; // finestLevel changes
}

void Selection::Impl::forgetKept(const Subject& s) {
    s.own.keptEpoch = epoch;
    s.own.keptScale = s.instance.placement.maxScale;
    s.own.keptInBelt = s.own.inBelt;
    std::fill_n(keptFrom.data() + s.instance.firstSlot, s.patches.size(), kInfinity);
}

/// What a block of patches keeps, in the arrays of the view. Pointers of their own: a byte that is written could be any
/// of theirs, for all that a compiler knows of members.
struct Selection::Impl::Block {
    uint8_t *wanted, *levels, *visible;
    float *from, *before;
    uint32_t first, count;
};

/// Asks the policy for the patches that may not keep their level.
void Selection::Impl::chooseAnew(const Subject& s, const Block& block) {
    std::array<float, kLaneBlock> distance;
    std::array<uint32_t, kLaneBlock> moved;
    const PatchLanes lanes = scene->lanes.lanes().from(s.stored.firstPatch + block.first);
    distancesSquared(lanes, block.count, s.instance.placement, desc.view, distance.data());
    uint32_t any = 0;
    for (uint32_t i = 0; i < block.count; ++i) {
        moved[i] = 1 ^ (uint32_t(distance[i] >= block.from[i]) & uint32_t(distance[i] < block.before[i]));
        any |= moved[i];
    }
    if (!any) return;
    for (uint32_t i = 0; i < block.count; ++i) {
        if (!moved[i] || !block.visible[i]) continue;
        const LevelTest test = s.patchTest(policy, block.first + i);
        const uint32_t level = test.next(block.wanted[i], !s.own.inBelt);
        const KeptLevel kept = keptLevel(test, level, !s.own.inBelt);
        block.wanted[i] = uint8_t(level);
        block.from[i] = kept.from;
        block.before[i] = kept.before;
    }
}

/// Takes the policy's levels over, and culls what is turned away. Without branches, byte by byte.
void Selection::Impl::takeLevels(const Subject& s, const Block& block, const MeshEye& eye, ChunkCount& count) {
    const PatchLanes lanes = scene->lanes.lanes().from(s.stored.firstPatch + block.first);
    const uint32_t n = block.count;
    std::array<uint32_t, kLaneBlock> turned{};
    std::array<uint8_t, kLaneBlock> away, changed;
    if (eye.valid) conesTurnedAway(lanes, n, eye, turned.data());
    for (uint32_t i = 0; i < n; ++i) away[i] = uint8_t(turned[i]);
    const auto coarsest = uint8_t(s.asset.levelCount() - 1);
    const uint8_t* const wantedLevels = block.wanted;
    const uint8_t* const coneLevels = lanes.coneLevel;
    uint8_t* const shown = block.visible;
    uint8_t* const standing = block.levels;
    for (uint32_t i = 0; i < n; ++i) {
        const uint8_t own = wantedLevels[i], cone = coneLevels[i];
        const uint8_t back = uint8_t(away[i] & uint8_t(own <= cone)); // surely turned away
        const uint8_t inSight = back ? std::min(cone, coarsest) : own;
        const uint8_t level = shown[i] ? inSight : coarsest;
        shown[i] = uint8_t(shown[i] & (back ^ 1));
        changed[i] = uint8_t(standing[i] != level);
        standing[i] = level;
    }
    uint32_t culledCount = 0, changedCount = 0;
    for (uint32_t i = 0; i < n; ++i) {
        culledCount += block.visible[i] ^ 1u;
        changedCount += changed[i];
    }
    count.stats.culledPatches += culledCount;
    count.stats.changedPatches += changedCount;
}

void Selection::Impl::chooseSteady(const Subject& s, ChunkCount& count) {
    const bool known = s.own.keptEpoch == epoch && s.own.keptScale == s.instance.placement.maxScale &&
                       s.own.keptInBelt == s.own.inBelt;
    if (!known) forgetKept(s);
    const MeshEye eye = desc.cullBackfaces ? meshEye(desc.view, s.instance.placement) : MeshEye{};
    const auto patchCount = uint32_t(s.patches.size());
    for (uint32_t first = 0; first < patchCount; first += kLaneBlock) {
        float* from = keptFrom.data() + s.instance.firstSlot + first;
        float* before = keptBefore.data() + s.instance.firstSlot + first;
        const Block block{s.wanted.data() + first,
                          s.levels.data() + first,
                          s.visible.data() + first,
                          from,
                          before,
                          first,
                          std::min(kLaneBlock, patchCount - first)};
        chooseAnew(s, block);
        takeLevels(s, block, eye, count);
    }
    count.stats.consideredPatches += patchCount;
}

} // namespace xgc
