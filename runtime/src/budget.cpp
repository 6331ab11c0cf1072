#include "selection.h"

#include <bit>
#include <limits>
#include <utility>

// The levels that minimise the largest weighted error under a bound of triangles are those that one threshold gives:
// each patch at the coarsest level within it. So a budget is a search for the least threshold that fits. A patch's
// triangles depend on its neighbours; they are bounded from above by those that it has with all its groups at the
// finest level among them, so a choice that is found to fit does, whatever the neighbours do:
//
//   count(most) at t <= N       feasible: the search keeps the least such t
//   count(least) at t > N       no choice within t can be feasible: every patch counted at its coarsest beside
//                               neighbours as coarse

namespace xgc {

uint64_t Selection::Impl::boundOf(const Subject& s) const {
    uint64_t triangles = 0;
    for (uint32_t p = 0; p < s.patches.size(); ++p) {
        if (s.visible[p]) triangles += triangleBound(s.asset, p, s.levels);
    }
    return triangles;
}

uint64_t Selection::Impl::countInstance(uint32_t id, const LevelPolicy& at, Count which) {
    const Subject s = subject(id);
    if (s.own.kind == InstanceKind::culled) return 0;
    if (s.own.kind == InstanceKind::whole) {
        const uint32_t hint = s.own.wholeState == kNoLevel ? 0 : s.own.wholeState;
        return scene->trianglesOf(s.instance.asset, s.wholeTest(at, *scene).coarsest(at.loose, hint));
    }
    const MeshEye eye = s.eye(desc);
    uint64_t least = 0;
    for (uint32_t p = 0; p < s.patches.size(); ++p) {
        s.levels[p] = uint8_t(s.asset.levelCount() - 1);
        if (!s.visible[p]) continue;
        const uint32_t hint = s.wanted[p] == kNoLevel ? 0 : s.wanted[p];
        const uint32_t level = s.patchTest(at, p).coarsest(at.loose, hint);
        s.levels[p] = uint8_t(withReference(s, p, s.controlled(p, level)));
        if (which == Count::least && !turnedAway(eye, s.patches[p])) least += uniformTriangles(s.asset, p, s.levels[p]);
    }
    return which == Count::most ? boundOf(s) : least;
}

uint64_t Selection::Impl::countAt(float pixels, Count which) {
    // The tight degree is what hysteresis may hold; what can be drawn at all goes by the pixels themselves.
    const float keep = which == Count::most ? 1 - desc.hysteresis : 1;
    SelectionDesc exact = desc;
    exact.hysteresis = 0;
    const LevelPolicy at = levelPolicy(exact, pixels * keep * keep);
    forInstances([&](uint32_t id, ChunkCount& count) { count.triangles += countInstance(id, at, which); });
    uint64_t sum = 0;
    const uint32_t chunkCount = (scene->instanceEnd + kChunk - 1) / kChunk;
    for (uint32_t chunk = 0; chunk < chunkCount; ++chunk) sum += chunks[chunk].triangles;
    return sum;
}

uint64_t Selection::Impl::countChosen() {
    uint64_t triangles = 0;
    for (uint32_t id = 0; id < scene->instanceEnd; ++id) {
        if (scene->instances[id].generation % 2 == 0) continue;
        const Subject s = subject(id);
        if (s.own.kind == InstanceKind::whole) triangles += scene->trianglesOf(s.instance.asset, s.own.wholeState);
        if (s.own.kind == InstanceKind::mixed) triangles += boundOf(s);
    }
    return triangles;
}

/// The least pixels, from `least` up, at which the count is within the budget, to a part in 128: from above for the
/// bound, from below for what no choice can undercut. Infinite where there are none.
float Selection::Impl::pixelsWithin(uint64_t budget, float least, Count which) {
    constexpr float kSmallest = 1.0f / 1024, kLargest = 1 << 30; // squares of what is compared stay finite
    if (countAt(least, which) <= budget) return least;
    if (countAt(kLargest, which) > budget) return std::numeric_limits<float>::infinity();
    // Positive floats are ordered as their bits are, and steps of the bits are steps of their logarithm.
    uint32_t below = std::bit_cast<uint32_t>(std::max(least, kSmallest)), within = std::bit_cast<uint32_t>(kLargest);
    constexpr uint32_t kStep = 1u << 16;
    while (within > below + kStep) {
        const uint32_t middle = below + (within - below) / 2;
        (countAt(std::bit_cast<float>(middle), which) <= budget ? within : below) = middle;
    }
    return std::bit_cast<float>(which == Count::most ? within : below);
}

void Selection::Impl::meetBudget() {
    const auto chooseAll = [&] { forInstances([&](uint32_t id, ChunkCount& count) { choose(id, count); }); };
    if (desc.boundPixels) stats.pixelsBound = pixelsWithin(desc.triangleBudget, desc.pixels, Count::least);
    const float pixels = pixelsWithin(desc.triangleBudget, desc.pixels, Count::most);
    policy = levelPolicy(desc, pixels);
    chooseAll();
    stats.triangleBound = countChosen();
    if (stats.triangleBound <= desc.triangleBudget) return;
    // A patch that hysteresis holds at a coarser level may show faces that the finer one hid: draw what was counted.
    const float keep = 1 - desc.hysteresis;
    const float hysteresis = std::exchange(desc.hysteresis, 0.0f);
    policy = levelPolicy(desc, pixels * keep * keep);
    chooseAll();
    desc.hysteresis = hysteresis;
    stats.triangleBound = countChosen();
    stats.overBudget = stats.triangleBound > desc.triangleBudget;
}

} // namespace xgc
