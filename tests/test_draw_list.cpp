#include "../runtime/src/range_allocator.h"
#include "counted_allocations.h"
#include "meshes/patched_torus.h"

#include <xgc/draw_list.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <span>
#include <string>

namespace {

constexpr uint32_t kPoison = 0xdeadbeef;
constexpr uint32_t kGuard = 0xcafecafe;

/// What a renderer with an index arena does, and more: it fails where a copy lands in memory that a frame in flight
/// draws, and poisons all that is neither drawn nor in flight.
class FakeGpu {
public:
    FakeGpu(uint32_t indexCapacity, uint32_t framesInFlight)
        : arena_(indexCapacity, kPoison), lastDrawn_(indexCapacity, 0), framesInFlight_(framesInFlight) {}

    void frame(const xgc::DrawList& list, std::span<const uint32_t> staging) {
        ++frame_;
        uint32_t previousEnd = 0, clashes = 0;
        for (const xgc::CopyRange& c : list.copies()) {
            CHECK(c.count > 0);
            CHECK(c.staging == previousEnd); // staging has no gaps
            previousEnd = c.staging + c.count;
            for (uint32_t i = 0; i < c.count; ++i) {
                clashes += inFlight(c.arena + i);
                arena_[c.arena + i] = staging[c.staging + i];
            }
        }
        CHECK(clashes == 0);
        CHECK(list.stats().uploadBytes == 4 * previousEnd);
        uint32_t overlaps = 0;
        for (const xgc::DrawCommand& d : list.draws()) {
            for (uint32_t i = d.firstIndex; i < d.firstIndex + d.indexCount; ++i) {
                overlaps += lastDrawn_[i] == frame_;
                lastDrawn_[i] = frame_;
            }
        }
        CHECK(overlaps == 0);
        for (uint32_t i = 0; i < arena_.size(); ++i) {
            if (lastDrawn_[i] != frame_ && !inFlight(i)) arena_[i] = kPoison;
        }
    }
    std::span<const uint32_t> drawn(const xgc::DrawCommand& d) const {
        return std::span(arena_).subspan(d.firstIndex, d.indexCount);
    }

private:
    /// Drawn in a frame that the renderer has not waited for when it begins the current one.
    bool inFlight(uint32_t i) const { return lastDrawn_[i] > 0 && lastDrawn_[i] + framesInFlight_ > frame_; }

    std::vector<uint32_t> arena_;
    std::vector<uint64_t> lastDrawn_;
    uint32_t framesInFlight_;
    uint64_t frame_ = 0;
};

/// An instance as the test believes it to be.
struct Believed {
    const xgc::AssetView* asset = nullptr;
    int32_t vertexOffset = 0;
    uint32_t firstMaterial = 0;
    std::vector<uint8_t> levels; ///< empty: not drawn
};

using Scene = std::map<uint32_t, Believed>;

std::vector<uint32_t> indicesOf(const xgc::AssetView& asset, uint32_t patch, xgc::Levels levels) {
    std::vector<uint32_t> scratch(xgc::scratchCapacity(asset)), out(xgc::indexCapacity(asset, patch, levels));
    out.resize(xgc::buildIndices(asset, patch, levels, scratch, out));
    return out;
}

/// A patch that was built in another state with the same triangles may have them in another order.
std::vector<std::array<uint32_t, 3>> sortedTriangles(std::span<const uint32_t> indices) {
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i + 2 < indices.size(); i += 3) {
        triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
        auto& t = triangles.back();
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

/// The draws are the scene's: each patch that has triangles once, with its indices, in batches by material.
void checkDraws(const xgc::DrawList& list, const FakeGpu& gpu, const Scene& scene) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> drawOf;
    REQUIRE(list.draws().size() == list.drawPatches().size());
    for (uint32_t i = 0; i < list.draws().size(); ++i) {
        const xgc::DrawPatch id = list.drawPatches()[i];
        CHECK(list.draws()[i].firstInstance == id.instance);
        CHECK(list.draws()[i].instanceCount == 1);
        CHECK(drawOf.emplace(std::pair(id.instance, id.patch), i).second);
    }
    uint32_t triangles = 0;
    size_t matched = 0;
    std::map<uint32_t, uint32_t> materialOfDraw;
    for (const auto& [id, believed] : scene) {
        CHECK(std::ranges::equal(list.levels(id), believed.levels));
        for (uint32_t p = 0; p < believed.levels.size(); ++p) {
            const std::vector<uint32_t> truth = indicesOf(*believed.asset, p, believed.levels);
            const auto found = drawOf.find({id, p});
            CHECK((found == drawOf.end()) == truth.empty());
            if (found == drawOf.end()) continue;
            ++matched;
            const xgc::DrawCommand& draw = list.draws()[found->second];
            CHECK(sortedTriangles(gpu.drawn(draw)) == sortedTriangles(truth));
            CHECK(draw.vertexOffset == believed.vertexOffset);
            materialOfDraw[found->second] = believed.firstMaterial + believed.asset->patches[p].material;
            triangles += uint32_t(truth.size()) / 3;
        }
    }
    CHECK(matched == drawOf.size());
    CHECK(list.stats().triangles == triangles);
    uint32_t next = 0, lastMaterial = 0;
    for (const xgc::DrawBatch& batch : list.batches()) {
        CHECK(batch.firstDraw == next);
        CHECK(batch.drawCount > 0);
        if (next > 0) CHECK(batch.material > lastMaterial);
        lastMaterial = batch.material;
        for (; next < batch.firstDraw + batch.drawCount; ++next) CHECK(materialOfDraw[next] == batch.material);
    }
    CHECK(next == list.draws().size());
}

class Random {
public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    uint32_t below(uint32_t n) { return uint32_t(engine_() % n); }
    std::vector<uint8_t> levels(const xgc::AssetView& asset) {
        std::vector<uint8_t> l(asset.patchCount());
        for (uint8_t& x : l) x = uint8_t(below(asset.levelCount()));
        return l;
    }

private:
    std::minstd_rand engine_;
};

/// Two assets of different shape.
struct Assets {
    xgc::test::OpenAsset small = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 3, .levels = 2}));
    xgc::test::OpenAsset large =
        xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 4, .levels = 3, .materials = 3, .repeatedLevels = 1}));
    const xgc::AssetView& pick(uint32_t i) const { return i % 2 ? small.view : large.view; }
};

uint32_t faces(const xgc::AssetView& asset) {
    return asset.record->faceCount;
}

/// Sets levels and keeps the belief; where the call defers, checks that nothing changed.
bool setLevels(xgc::DrawList& list, uint32_t id, Believed& believed, const std::vector<uint8_t>& levels) {
    const xgc::Status status = list.setLevels(id, levels);
    if (status.ok()) {
        believed.levels = levels;
        return true;
    }
    CHECK(status.code == xgc::StatusCode::outOfCapacity);
    CHECK(status.element > 0);
    CHECK(std::ranges::equal(list.levels(id), believed.levels));
    return false;
}

/// Hundreds of frames of random additions, removals and changes; returns how many changes were deferred.
uint32_t randomRun(const Assets& assets, xgc::DrawListConfig config, uint32_t stagingSize, uint32_t seed) {
    Random random(seed);
    xgc::DrawList list;
    REQUIRE(list.create(config).ok());
    FakeGpu gpu(config.indexCapacity, config.framesInFlight);
    Scene scene;
    std::vector<uint32_t> staging(stagingSize + 1, kGuard);
    uint32_t deferred = 0;
    for (int frame = 0; frame < 250; ++frame) {
        list.beginFrame(std::span(staging).first(stagingSize));
        if (random.below(4) == 0) {
            Believed b{&assets.pick(random.below(2)), int32_t(random.below(1000)), random.below(4), {}};
            uint32_t id = 77;
            const xgc::Status status = list.addInstance({b.asset, b.vertexOffset, b.firstMaterial}, id);
            if (status.ok())
                CHECK(scene.emplace(id, b).second);
            else
                CHECK(id == 77);
        }
        if (random.below(12) == 0 && !scene.empty()) {
            const auto gone = std::next(scene.begin(), random.below(uint32_t(scene.size())));
            list.removeInstance(gone->first);
            scene.erase(gone);
        }
        uint32_t refused = 0, changed = 0, needed = 0;
        for (auto& [id, b] : scene) {
            if (random.below(3) == 0) continue;
            std::vector<uint8_t> levels = random.levels(*b.asset);
            if (!b.levels.empty() && random.below(2)) { // a small change
                const std::vector<uint8_t> wild = levels;
                levels = b.levels;
                for (int k = 0; k < 2; ++k) {
                    const uint32_t p = random.below(uint32_t(levels.size()));
                    levels[p] = wild[p];
                }
            }
            const std::vector<uint8_t> before = b.levels;
            if (!setLevels(list, id, b, levels)) {
                ++refused;
                continue;
            }
            for (uint32_t p = 0; p < levels.size(); ++p) {
                changed += before.empty() || before[p] != levels[p];
                needed += before.empty() || xgc::needsRebuild(*b.asset, p, before, levels);
            }
        }
        list.endFrame();
        CHECK(list.stats().deferredInstances == refused);
        CHECK(list.stats().patchesChanged == changed);
        CHECK(list.stats().patchesRebuilt == needed); // and nothing else
        gpu.frame(list, staging);
        checkDraws(list, gpu, scene);
        CHECK(staging.back() == kGuard);
        deferred += refused;
    }
    return deferred;
}

} // namespace

TEST_CASE("after any sequence of changes the arena holds each patch's indices, in flight or not") {
    const Assets assets;
    REQUIRE(assets.small.failure == "");
    REQUIRE(assets.large.failure == "");
    for (const uint32_t framesInFlight : {1u, 2u, 3u}) {
        const xgc::DrawListConfig roomy{.instanceCapacity = 12,
                                        .patchCapacity = 12 * 16,
                                        .materialCapacity = 8,
                                        .indexCapacity = 12 * 3 * faces(assets.large.view) * 6,
                                        .framesInFlight = framesInFlight};
        CHECK(randomRun(assets, roomy, 12 * 3 * faces(assets.large.view), framesInFlight) == 0);
        // Too little of everything: changes wait, and nothing breaks.
        xgc::DrawListConfig tight = roomy;
        tight.patchCapacity = 100;
        tight.indexCapacity = 10 * 3 * faces(assets.large.view);
        CHECK(randomRun(assets, tight, 3 * faces(assets.large.view) + 100, framesInFlight) > 20);
    }
}

TEST_CASE("full staging defers the whole instance, and the next frame takes it") {
    const Assets assets;
    REQUIRE(assets.large.failure == "");
    const xgc::AssetView& asset = assets.large.view;
    xgc::DrawList list;
    REQUIRE(list.create({.instanceCapacity = 2, .materialCapacity = 8}).ok());
    uint32_t a = 0, b = 0;
    REQUIRE(list.addInstance({&asset, 0, 0}, a).ok());
    REQUIRE(list.addInstance({&asset, 0, 0}, b).ok());
    std::vector<uint32_t> staging(3 * faces(asset));
    const std::vector<uint8_t> fine(asset.patchCount(), 0);

    list.beginFrame(std::span(staging).first(staging.size() - 1));
    const xgc::Status never = list.setLevels(a, fine);
    CHECK(never.code == xgc::StatusCode::outOfCapacity);
    CHECK(never.element == staging.size()); // would do
    list.endFrame();
    CHECK(list.draws().empty());

    list.beginFrame(staging);
    CHECK(list.setLevels(a, fine).ok());
    const xgc::Status later = list.setLevels(b, fine);
    CHECK(later.code == xgc::StatusCode::outOfCapacity);
    CHECK(std::string(later.message) != never.message);
    list.endFrame();
    CHECK(list.stats().deferredInstances == 1);
    CHECK(list.stats().triangles == faces(asset));
    CHECK(list.copies().size() == 1); // adjacent ranges are one copy

    list.beginFrame(staging);
    CHECK(list.setLevels(b, fine).ok());
    list.endFrame();
    CHECK(list.stats().deferredInstances == 0);
    CHECK(list.stats().triangles == 2 * faces(asset));
}

TEST_CASE("a full arena defers; memory that another instance gave up serves framesInFlight frames later") {
    const Assets assets;
    REQUIRE(assets.large.failure == "");
    const xgc::AssetView& asset = assets.large.view;
    const uint32_t whole = 3 * faces(asset);
    for (const uint32_t framesInFlight : {1u, 2u, 3u}) {
        xgc::DrawList list;
        REQUIRE(list.create({.instanceCapacity = 2,
                             .materialCapacity = 8,
                             .indexCapacity = whole + whole / 2,
                             .framesInFlight = framesInFlight})
                    .ok());
        uint32_t a = 0, b = 0;
        REQUIRE(list.addInstance({&asset, 0, 0}, a).ok());
        REQUIRE(list.addInstance({&asset, 0, 0}, b).ok());
        std::vector<uint32_t> staging(whole);
        const std::vector<uint8_t> fine(asset.patchCount(), 0), coarse(asset.patchCount(), 3);
        const auto frame = [&](uint32_t id, const std::vector<uint8_t>& levels) {
            list.beginFrame(staging);
            const bool ok = list.setLevels(id, levels).ok();
            list.endFrame();
            return ok;
        };
        CHECK(frame(a, fine));
        CHECK_FALSE(frame(b, fine));
        CHECK(list.levels(b).empty());
        CHECK(frame(a, coarse));
        for (uint32_t i = 1; i < framesInFlight; ++i) CHECK_FALSE(frame(b, fine));
        CHECK(frame(b, fine));
        list.removeInstance(b);
        CHECK(list.draws().size() == 2 * asset.patchCount()); // what was closed stays
        CHECK(frame(a, coarse));
        CHECK(list.stats().triangles == list.draws().size() * 2);
    }
}

TEST_CASE("frames, additions and removals allocate nothing") {
    const Assets assets;
    REQUIRE(assets.large.failure == "");
    const xgc::AssetView& asset = assets.large.view;
    xgc::DrawList list;
    const uint64_t beforeCreate = xgc::test::allocations;
    REQUIRE(list.create({.instanceCapacity = 4, .materialCapacity = 8}).ok());
    CHECK(xgc::test::allocations > beforeCreate); // the counter counts
    Random random(5);
    std::vector<std::vector<uint8_t>> states;
    for (int i = 0; i < 32; ++i) states.push_back(random.levels(asset));
    std::vector<uint32_t> staging(4 * 3 * faces(asset));
    bool ok = true;
    const uint64_t before = xgc::test::allocations;
    for (uint32_t frame = 0; frame < 200; ++frame) {
        uint32_t id = 0;
        ok &= list.addInstance({&asset, 0, 0}, id).ok();
        list.beginFrame(staging);
        ok &= list.setLevels(id, states[frame % 32]).ok();
        ok &= list.setLevels(id, states[(frame + 7) % 32]).ok();
        list.endFrame();
        ok &= list.stats().triangles > 0 && !list.draws().empty();
        list.removeInstance(id);
    }
    CHECK(xgc::test::allocations == before);
    CHECK(ok);
}

TEST_CASE("a frame in which nothing changes copies nothing and keeps its draws") {
    const Assets assets;
    REQUIRE(assets.small.failure == "");
    const xgc::AssetView& asset = assets.small.view;
    xgc::DrawList list;
    REQUIRE(list.create({}).ok());
    uint32_t id = 0;
    REQUIRE(list.addInstance({&asset, 9, 0}, id).ok());
    std::vector<uint32_t> staging(3 * faces(asset));
    const std::vector<uint8_t> levels(asset.patchCount(), 1);
    list.beginFrame(staging);
    REQUIRE(list.setLevels(id, levels).ok());
    list.endFrame();
    const uint32_t triangles = list.stats().triangles;
    for (int i = 0; i < 3; ++i) {
        list.beginFrame({});
        if (i) CHECK(list.setLevels(id, levels).ok());
        list.endFrame();
        CHECK(list.copies().empty());
        CHECK(list.draws().size() == asset.patchCount());
        CHECK(list.stats().triangles == triangles);
        CHECK(list.stats().patchesRebuilt == 0);
        CHECK(list.stats().uploadBytes == 0);
    }
}

TEST_CASE("what does not fit the configuration is refused with the setting's name") {
    const Assets assets;
    REQUIRE(assets.large.failure == "");
    const xgc::InstanceDesc desc{&assets.large.view, 0, 1};
    const auto refusal = [&](xgc::DrawListConfig config) {
        xgc::DrawList list;
        REQUIRE(list.create(config).ok());
        uint32_t id = 1234;
        const xgc::Status status = list.addInstance(desc, id);
        CHECK((status.ok() || id == 1234));
        return std::pair(std::string(status.message), status.element);
    };
    const auto says = [&](const xgc::DrawListConfig& config, const char* setting, uint64_t needed) {
        const std::pair<std::string, uint64_t> said = refusal(config);
        CHECK_MESSAGE(said.first.find(setting) != std::string::npos, said.first);
        CHECK(said.second == needed);
    };
    const xgc::AssetView& asset = assets.large.view;
    CHECK(refusal({}).first == "ok");
    says({.patchCapacity = 15}, "patchCapacity", 16);
    says({.materialCapacity = 3}, "materialCapacity", 4);
    says({.slotCapacity = 80}, "slotCapacity", 81);
    says({.domainCapacity = 3}, "domainCapacity", asset.domains.size());

    xgc::DrawList list;
    REQUIRE(list.create({.instanceCapacity = 1}).ok());
    uint32_t id = 0;
    CHECK(list.addInstance(desc, id).ok());
    const xgc::Status full = list.addInstance(desc, id);
    CHECK(std::string(full.message).find("instanceCapacity") != std::string::npos);
    CHECK(full.element == 2);
    list.removeInstance(id);
    CHECK(list.addInstance(desc, id).ok()); // the id at once

    CHECK(list.create({.framesInFlight = 0}).code == xgc::StatusCode::badArgument);
    CHECK(list.levels(id).empty()); // a refused create replaces nothing
}

TEST_CASE("range allocator: ranges never overlap, and all of it is one range when all are free") {
    Random random(3);
    constexpr uint32_t kSize = 5000;
    xgc::RangeAllocator allocator;
    REQUIRE(allocator.create(kSize, 64));
    std::vector<uint32_t> owner(kSize, 0), live;
    for (uint32_t step = 1; step < 20000; ++step) {
        if (random.below(100) < 52) {
            const uint32_t count = 1 + random.below(random.below(2) ? 300 : 9);
            const uint32_t r = allocator.allocate(count);
            if (r == xgc::RangeAllocator::kNoRange) continue;
            uint32_t taken = 0;
            for (uint32_t i = 0; i < count; ++i) {
                taken += owner[allocator.offset(r) + i] != 0;
                owner[allocator.offset(r) + i] = step;
            }
            CHECK(taken == 0);
            CHECK(allocator.count(r) == count);
            live.push_back(r);
        } else if (!live.empty()) {
            const uint32_t k = random.below(uint32_t(live.size()));
            for (uint32_t i = 0; i < allocator.count(live[k]); ++i) owner[allocator.offset(live[k]) + i] = 0;
            allocator.free(live[k]);
            live[k] = live.back();
            live.pop_back();
        }
        CHECK(allocator.freeTotal() == uint32_t(std::count(owner.begin(), owner.end(), 0u)));
        CHECK(allocator.rangeCount() == live.size());
    }
    for (const uint32_t r : live) allocator.free(r);
    const uint32_t all = allocator.allocate(kSize);
    CHECK(all != xgc::RangeAllocator::kNoRange);
    CHECK(allocator.allocate(1) == xgc::RangeAllocator::kNoRange);
}

TEST_CASE("range allocator: a request is refused only where no free range holds it") {
    Random random(4);
    constexpr uint32_t kSize = 2000;
    xgc::RangeAllocator allocator;
    REQUIRE(allocator.create(kSize, 1000));
    std::vector<bool> taken(kSize, false);
    std::vector<uint32_t> live;
    int refused = 0;
    for (int step = 0; step < 5000; ++step) {
        const uint32_t count = 1 + random.below(90);
        const uint32_t wasLongest = allocator.longestFree(), r = allocator.allocate(count);
        uint32_t longest = 0;
        for (uint32_t i = 0, run = 0; i < kSize; ++i) longest = std::max(longest, run = taken[i] ? 0 : run + 1);
        CHECK((r != xgc::RangeAllocator::kNoRange) == (longest >= count));
        CHECK(wasLongest == longest);
        if (r != xgc::RangeAllocator::kNoRange) {
            std::fill_n(taken.begin() + allocator.offset(r), count, true);
            live.push_back(r);
            continue;
        }
        ++refused;
        const uint32_t k = random.below(uint32_t(live.size()));
        std::fill_n(taken.begin() + allocator.offset(live[k]), allocator.count(live[k]), false);
        allocator.free(live[k]);
        live.erase(live.begin() + k);
    }
    CHECK(refused > 500);
}
