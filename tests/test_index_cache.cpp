#include "../runtime/src/index_pack.h"
#include "../runtime/src/key_table.h"
#include "../runtime/src/state_key.h"
#include "counted_allocations.h"
#include "meshes/patched_torus.h"
#include "meshes/toy_asset.h"
#include "random.h"

#include <xgc/index_cache.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <unordered_map>

namespace {

/// All patches at one level.
std::vector<uint8_t> uniform(const xgc::AssetView& asset, uint32_t level) {
    return std::vector<uint8_t>(asset.patchCount(), uint8_t(level));
}

using xgc::AssetView;
using xgc::IndexCache;
using xgc::IndexCacheConfig;
using xgc::IndexRange;
using xgc::Levels;
using xgc::Status;
using xgc::StatusCode;
using xgc::test::Random;
using States = std::vector<uint8_t>;
using Triangles = std::vector<std::array<uint32_t, 3>>;

constexpr uint32_t kNoRange = IndexCache::kNoRange;
constexpr std::byte kPoison{0xdb};
constexpr std::byte kGuard{0xcf};

/// In no order, each from its least corner on: a state that looks alike may list them otherwise.
Triangles sortedTriangles(std::span<const uint32_t> indices) {
    Triangles triangles;
    for (size_t i = 0; i + 2 < indices.size(); i += 3) {
        triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
        auto& t = triangles.back();
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

void appendIndices(const AssetView& asset, uint32_t patch, Levels levels, std::vector<uint32_t>& indices) {
    std::vector<uint32_t> scratch(xgc::scratchCapacity(asset)), out(xgc::indexCapacity(asset, patch, levels));
    out.resize(xgc::buildIndices(asset, patch, levels, scratch, out));
    indices.insert(indices.end(), out.begin(), out.end());
}

Triangles trianglesOf(const AssetView& asset, uint32_t patch, Levels levels) {
    std::vector<uint32_t> indices;
    appendIndices(asset, patch, levels, indices);
    return sortedTriangles(indices);
}

Triangles wholeTriangles(const AssetView& asset, uint32_t material, uint32_t level) {
    std::vector<uint32_t> indices;
    const States levels(asset.patchCount(), uint8_t(level));
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        if (asset.patches[p].material == material) appendIndices(asset, p, levels, indices);
    }
    return sortedTriangles(indices);
}

/// A renderer at its worst: it copies as early as it may, while the draws of the frames before still wait, and draws as
/// late as it may.
class FakeGpu {
public:
    FakeGpu(uint32_t arenaBytes, uint32_t framesInFlight)
        : arena_(arenaBytes, kPoison), framesInFlight_(framesInFlight) {}

    struct Draw {
        IndexRange range;
        Triangles truth;
    };

    /// To be called before beginFrame.
    void waitForOldFrames() {
        for (; frames_.size() >= framesInFlight_; frames_.pop_front()) {
            for (const Draw& draw : frames_.front()) CHECK((drawn(draw.range) == draw.truth));
        }
    }
    void submit(const IndexCache& cache, std::span<const std::byte> staging, std::vector<Draw> draws) {
        uint32_t end = 0;
        for (const xgc::CopyRange& c : cache.copies()) {
            CHECK(c.bytes > 0);
            CHECK((c.staging | c.arena | c.bytes) % 4 == 0);
            CHECK(c.staging == end); // staging has no gaps
            end = c.staging + c.bytes;
            REQUIRE(c.arena + uint64_t(c.bytes) <= arena_.size());
            std::memcpy(&arena_[c.arena], &staging[c.staging], c.bytes);
        }
        CHECK(cache.stats().uploadBytes == end);
        CHECK(end <= staging.size());
        frames_.push_back(std::move(draws));
    }
    Triangles drawn(const IndexRange& r) const {
        std::vector<uint32_t> rows(r.indexCount);
        for (uint32_t i = 0; i < r.indexCount; ++i) {
            uint32_t index = 0;
            std::memcpy(&index, &arena_.at((size_t(r.firstIndex) + i) * r.indexBytes), r.indexBytes);
            rows[i] = index + r.vertexOffset;
        }
        return sortedTriangles(rows);
    }

private:
    std::vector<std::byte> arena_;
    uint32_t framesInFlight_;
    std::deque<std::vector<Draw>> frames_; ///< not yet drawn
};

/// Assets of different shape: two known by construction, made vertices, and many patches that vanish.
struct Assets {
    xgc::test::OpenAsset small = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 3, .levels = 2}));
    xgc::test::OpenAsset large =
        xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 4, .levels = 3, .materials = 3, .repeatedLevels = 1}));
    xgc::test::ToyAsset vanishing =
        xgc::test::toyAsset(xgc::test::sphere(4), 12, {.levelCount = 8, .share = 0.6f, .makeVertices = false});

    Assets() {
        REQUIRE(small.failure == "");
        REQUIRE(large.failure == "");
        REQUIRE(vanishing.error == "");
        REQUIRE(xgc::test::withMadeVertices().error == "");
    }
    const AssetView& pick(uint32_t i) const {
        const std::array<const AssetView*, 4> all = {&large.view, &small.view, &vanishing.asset,
                                                     &xgc::test::withMadeVertices().asset};
        return *all[i % all.size()];
    }
};

std::vector<std::byte> guarded(uint32_t bytes) {
    // Aligned as vectors are.
    return std::vector<std::byte>(bytes + 4, kGuard);
}

/// A range that the test holds, and what it must draw.
struct Held {
    uint32_t range = kNoRange;
    States levels;
    Triangles truth;
};

struct Tally {
    uint32_t refused = 0, hits = 0, misses = 0, evictions = 0, empty = 0, narrow = 0, wide = 0;
    uint64_t digest = 0; ///< of all copies and ranges
};

/// Random instances of random assets that change levels, and assets that come and go.
class Workload {
public:
    Workload(const Assets& assets, const IndexCacheConfig& config, uint32_t stagingBytes, uint32_t seed)
        : assets_(assets), random_(seed), gpu_(config.arenaBytes, config.framesInFlight),
          staging_(guarded(stagingBytes)), stagingBytes_(stagingBytes), config_(config) {
        REQUIRE(cache_.create(config).ok());
        for (uint32_t id = 0; id < kIds; ++id) addAsset(id);
        instances_.resize(kInstances);
        for (uint32_t i = 0; i < kInstances; ++i) instances_[i].asset = i % kIds;
        reset();
    }

    Tally run(uint32_t frames) {
        for (uint32_t f = 0; f < frames; ++f) frame();
        return tally_;
    }
    /// Lets go of everything, and waits until no frame in flight reads it.
    IndexCache& finish() {
        for (Instance& instance : instances_) releaseAll(instance);
        for (uint32_t f = 0; f <= config_.framesInFlight; ++f) {
            gpu_.waitForOldFrames();
            cache_.beginFrame({});
            cache_.endFrame();
            gpu_.submit(cache_, {}, {});
        }
        gpu_.waitForOldFrames();
        return cache_;
    }

private:
    static constexpr uint32_t kIds = 4, kInstances = 8;

    struct Instance {
        uint32_t asset = 0;
        std::vector<Held> patches;
        Held whole;
    };

    const AssetView& view(const Instance& instance) const { return *views_[instance.asset]; }

    void addAsset(uint32_t id) {
        views_[id] = &assets_.pick(random_.below(4));
        REQUIRE(cache_.addAsset(id, *views_[id]).ok());
    }
    void reset() {
        for (Instance& instance : instances_) instance.patches.resize(view(instance).patchCount());
    }
    void release(Held& held) {
        if (held.range != kNoRange) cache_.release(held.range);
        held = {};
    }
    void releaseAll(Instance& instance) {
        for (Held& held : instance.patches) release(held);
        release(instance.whole);
    }
    void exchangeAsset() {
        const uint32_t id = random_.below(kIds);
        for (Instance& instance : instances_) {
            if (instance.asset != id) continue;
            releaseAll(instance);
            instance.patches.clear();
        }
        cache_.removeAsset(id);
        addAsset(id);
        reset();
    }

    void frame() {
        gpu_.waitForOldFrames();
        if (random_.below(16) == 0) exchangeAsset();
        cache_.beginFrame(std::span(staging_).first(stagingBytes_));
        draws_.clear();
        refused_ = 0;
        for (Instance& instance : instances_) {
            for (const Held& held : instance.patches) willDraw(held);
            willDraw(instance.whole);
            if (random_.below(3) == 0) changeLevels(instance);
            if (random_.below(8) == 0) changeWhole(instance);
            if (random_.below(30) == 0) releaseAll(instance);
        }
        if (random_.below(16) == 0) exchangeAsset();
        cache_.endFrame();
        checkFrame();
        gpu_.submit(cache_, std::span(staging_).first(stagingBytes_), draws_);
    }

    /// What is held at any time in a frame may be drawn in it.
    void willDraw(const Held& held) {
        if (held.range != kNoRange) draws_.push_back({cache_.at(held.range), held.truth});
    }

    void changeLevels(Instance& instance) {
        const AssetView& asset = view(instance);
        States levels = random_.levels(asset);
        if (random_.below(2)) std::fill(levels.begin(), levels.end(), levels[0]);
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            uint32_t range = kNoRange;
            const Status status = cache_.acquire(instance.asset, p, levels, range);
            take(status, range, instance.patches[p], levels, [&] { return trianglesOf(asset, p, levels); });
        }
    }
    void changeWhole(Instance& instance) {
        const AssetView& asset = view(instance);
        const uint32_t material = random_.below(asset.record->materialCount);
        const auto level = uint8_t(random_.below(asset.levelCount()));
        uint32_t range = kNoRange;
        const Status status = cache_.acquireWhole(instance.asset, material, level, uniform(asset, level), range);
        take(status, range, instance.whole, {level}, [&] { return wholeTriangles(asset, material, level); });
    }
    template <typename Truth>
    void take(const Status& status, uint32_t range, Held& held, const States& levels, const Truth& truth) {
        if (!status.ok()) {
            CHECK(status.code == StatusCode::outOfCapacity);
            CHECK(status.element > 0);
            CHECK(range == kNoRange);
            ++refused_;
            return;
        }
        if (held.range != kNoRange) cache_.release(held.range);
        held = {range, levels, truth()};
        willDraw(held);
        const IndexRange at = cache_.at(range);
        CHECK(at.indexCount == 3 * held.truth.size());
        tally_.empty += at.indexCount == 0;
        tally_.narrow += at.indexCount > 0 && at.indexBytes == 2;
        tally_.wide += at.indexCount > 0 && at.indexBytes == 4;
        tally_.digest = tally_.digest * 31 + range + at.firstIndex;
    }

    void checkFrame() {
        const xgc::IndexCacheStats stats = cache_.stats();
        CHECK(stats.refusals == refused_);
        for (size_t i = stagingBytes_; i < staging_.size(); ++i) CHECK(staging_[i] == kGuard);
        for (const xgc::CopyRange& c : cache_.copies()) tally_.digest = (tally_.digest * 31 + c.arena) * 31 + c.bytes;
        tally_.refused += refused_;
        tally_.hits += stats.hits;
        tally_.misses += stats.misses;
        tally_.evictions += stats.evictions;

        std::map<uint32_t, IndexRange> distinct;
        for (const Instance& instance : instances_) {
            for (const Held& held : instance.patches) note(held, distinct);
            note(instance.whole, distinct);
        }
        CHECK(stats.heldRanges == distinct.size());
        CHECK(stats.ranges >= stats.heldRanges);
        CHECK(stats.usedBytes <= config_.arenaBytes);
        checkApart(distinct);
        for (const Instance& a : instances_) {
            for (const Instance& b : instances_) checkShared(a, b);
        }
    }
    void note(const Held& held, std::map<uint32_t, IndexRange>& distinct) const {
        if (held.range != kNoRange) distinct.emplace(held.range, cache_.at(held.range));
    }
    /// No two ranges overlap.
    static void checkApart(const std::map<uint32_t, IndexRange>& distinct) {
        std::map<uint64_t, uint64_t> runs;
        for (const auto& [id, r] : distinct) {
            const uint64_t first = uint64_t(r.firstIndex) * r.indexBytes;
            if (r.indexCount) CHECK(runs.emplace(first, first + uint64_t(r.indexCount) * r.indexBytes).second);
        }
        uint64_t end = 0;
        for (const auto& [first, last] : runs) {
            CHECK(first % 4 == 0);
            CHECK(first >= end);
            end = last;
        }
    }
    /// Two instances share the range of a patch where it looks alike, and nowhere else.
    void checkShared(const Instance& a, const Instance& b) const {
        if (a.asset != b.asset) return;
        for (uint32_t p = 0; p < a.patches.size(); ++p) {
            const Held &x = a.patches[p], &y = b.patches[p];
            if (x.range == kNoRange || y.range == kNoRange) continue;
            CHECK((x.range == y.range) == !xgc::needsRebuild(view(a), p, x.levels, y.levels));
        }
    }

    const Assets& assets_;
    Random random_;
    IndexCache cache_;
    FakeGpu gpu_;
    std::vector<std::byte> staging_;
    uint32_t stagingBytes_;
    IndexCacheConfig config_;
    std::array<const AssetView*, kIds> views_{};
    std::vector<Instance> instances_;
    std::vector<FakeGpu::Draw> draws_;
    uint32_t refused_ = 0;
    Tally tally_;
};

/// One asset in a cache, a frame at a time; nothing is copied.
struct OneAsset {
    IndexCache cache;
    const AssetView& asset;
    std::vector<std::byte> staging;

    OneAsset(const AssetView& view, const IndexCacheConfig& config, uint32_t stagingBytes = 1u << 20)
        : asset(view), staging(guarded(stagingBytes)) {
        REQUIRE(cache.create(config).ok());
        REQUIRE(cache.addAsset(0, view).ok());
    }
    void begin() { cache.beginFrame(std::span(staging).first(staging.size() - 4)); }
    void emptyFrames(uint32_t count) {
        for (uint32_t i = 0; i < count; ++i) {
            begin();
            cache.endFrame();
        }
    }
    Status acquire(uint32_t patch, const States& levels, uint32_t& range) {
        return cache.acquire(0, patch, levels, range);
    }
    uint32_t hold(uint32_t patch, const States& levels) {
        uint32_t range = kNoRange;
        CHECK(acquire(patch, levels, range).ok());
        return range;
    }
    States uniform(uint32_t level) const { return States(asset.patchCount(), uint8_t(level)); }
};

/// Bytes of a patch of the small torus at level 0: 32 triangles of 16-bit indices.
constexpr uint32_t kSmallPatch = 32 * 3 * 2;

void checkSays(const Status& status, const char* setting, uint64_t element) {
    CHECK(status.code == StatusCode::outOfCapacity);
    CHECK_MESSAGE(std::string(status.message).find(setting) != std::string::npos, status.message);
    CHECK(status.element == element);
}

} // namespace

TEST_CASE("the arena holds what buildIndices draws in each state that is held or in flight") {
    const Assets assets;
    for (const uint32_t framesInFlight : {1u, 2u, 3u}) {
        const IndexCacheConfig roomy{.arenaBytes = 4u << 20, .framesInFlight = framesInFlight};
        const Tally fits = Workload(assets, roomy, 1u << 20, framesInFlight + 40).run(150);
        CHECK(fits.refused == 0);
        CHECK(fits.evictions == 0);
        CHECK(fits.hits > 500);
        CHECK(fits.wide == 0);
        CHECK(fits.empty > 20);
        // Too little of everything: some must wait, and nothing breaks.
        IndexCacheConfig tight = roomy;
        tight.arenaBytes = 16000;
        const Tally full = Workload(assets, tight, 6001, framesInFlight + 50).run(150);
        CHECK(full.refused > 100);
        CHECK(full.evictions > 500);
        // An arena that suffices for what is held, so that ranges come and go without end.
        tight.arenaBytes = 40000;
        tight.narrowIndices = framesInFlight != 2;
        const Tally busy = Workload(assets, tight, 1u << 20, framesInFlight + 30).run(150);
        CHECK(busy.evictions > 500);
        CHECK(busy.hits > 500);
        CHECK((busy.narrow == 0) == !tight.narrowIndices);
    }
}

TEST_CASE("full pools refuse, and nothing leaks: the whole arena can be had as one range again") {
    const Assets assets;
    const AssetView& asset = assets.small.view;
    uint32_t whole = 0;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) whole += asset.patches[p].material == 0 ? kSmallPatch : 0;
    for (const int scarce : {0, 1, 2, 3}) {
        IndexCacheConfig config{.arenaBytes = whole};
        if (scarce == 1) config = {.arenaBytes = 1u << 20, .rangeCapacity = 50};
        if (scarce == 2) config = {.arenaBytes = 1u << 20, .keyBytes = 1500};
        if (scarce == 3) config = {.arenaBytes = 1u << 20, .copyCapacity = 3};
        config.assetCapacity = 5;
        Workload workload(assets, config, 1u << 20, 40 + uint32_t(scarce));
        CHECK(workload.run(120).refused > 50);
        IndexCache& cache = workload.finish();
        CHECK(cache.stats().heldRanges == 0);
        REQUIRE(cache.addAsset(4, asset).ok());
        std::vector<std::byte> staging(1u << 20);
        cache.beginFrame(staging);
        uint32_t range = kNoRange;
        REQUIRE(cache.acquireWhole(4, 0, 0, uniform(asset, 0), range).ok());
        cache.endFrame();
        if (scarce == 0) {
            CHECK(cache.at(range).firstIndex == 0);
            CHECK(cache.stats().usedBytes == whole);
            CHECK(cache.stats().largestFreeBytes == 0);
        }
        // As many ranges as there may be: none is lost.
        cache.release(range);
        for (uint32_t id = 0; id < 5; ++id) cache.removeAsset(id);
        for (uint32_t f = 0; f <= config.framesInFlight; ++f) {
            cache.beginFrame(staging);
            cache.endFrame();
        }
        CHECK(cache.stats().ranges == 0);
        CHECK(cache.stats().usedBytes == 0);
        CHECK(cache.stats().largestFreeBytes == config.arenaBytes);
    }
}

TEST_CASE("the same calls give the same ranges and copies") {
    const Assets assets;
    const IndexCacheConfig config{.arenaBytes = 40000};
    const Tally a = Workload(assets, config, 12000, 5).run(60), b = Workload(assets, config, 12000, 5).run(60);
    CHECK(a.digest == b.digest);
    CHECK(a.digest != Workload(assets, config, 12000, 6).run(60).digest);
}

TEST_CASE("states that look alike share one range, others do not") {
    const Assets assets;
    OneAsset one(assets.large.view, {});
    REQUIRE(one.asset.levelCount() == 5); // the last repeats the one before
    one.begin();
    const uint32_t coarse = one.hold(5, one.uniform(3));
    CHECK(one.cache.stats().misses == 1);
    CHECK(one.hold(5, one.uniform(4)) == coarse);
    States far = one.uniform(3);
    far[15] = 0; // touches patch 5 nowhere: 4 x 4 patches around and along
    CHECK(one.hold(5, far) == coarse);
    CHECK(one.cache.stats().hits == 2);
    States beside = one.uniform(3);
    beside[6] = 2;
    CHECK(one.hold(5, beside) != coarse);
    States corner = one.uniform(3);
    corner[10] = 0; // meets it in one vertex that never collapses
    CHECK(one.hold(5, corner) == coarse);
    CHECK(one.hold(6, one.uniform(3)) != coarse);
    CHECK(one.cache.stats().misses == 3);
    CHECK(one.cache.stats().ranges == 3);
    one.cache.endFrame();
}

TEST_CASE("keys whose hashes are equal name different ranges") {
    const xgc::test::OpenAsset built = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 4, .levels = 4}));
    REQUIRE(built.failure == "");
    const AssetView& asset = built.view;
    struct State {
        uint32_t id, patch;
        States levels;
        std::vector<std::byte> key;
    };
    constexpr uint32_t kIds = 64;
    Random random(9);
    std::unordered_map<uint32_t, State> seen;
    State a{}, b{};
    std::vector<std::byte> key(xgc::stateKeyBytes(64));
    for (uint32_t tries = 0; tries < 1000000 && a.key.empty(); ++tries) {
        State s{random.below(kIds), random.below(asset.patchCount()), random.levels(asset), {}};
        s.levels[s.patch] = 4;
        s.key.assign(key.begin(), key.begin() + int(xgc::writePatchKey(s.id, asset, s.patch, s.levels, key.data())));
        const auto [at, isNew] = seen.try_emplace(xgc::KeyTable::hash(s.key), s);
        if (isNew || at->second.key == s.key) continue;
        a = at->second;
        b = s;
    }
    REQUIRE(!a.key.empty());
    IndexCache cache;
    REQUIRE(cache.create({.assetCapacity = kIds}).ok());
    for (uint32_t id = 0; id < kIds; ++id) REQUIRE(cache.addAsset(id, asset).ok());
    std::vector<std::byte> staging(1u << 20);
    cache.beginFrame(staging);
    uint32_t first = kNoRange, second = kNoRange;
    CHECK(cache.acquire(a.id, a.patch, a.levels, first).ok());
    CHECK(cache.acquire(b.id, b.patch, b.levels, second).ok());
    CHECK(first != second);
    CHECK(cache.stats().misses == 2);
    cache.endFrame();
}

TEST_CASE("the least recently used go first, only where room is needed, and when no frame in flight reads them") {
    const Assets assets;
    for (const uint32_t framesInFlight : {1u, 2u, 3u}) {
        OneAsset one(assets.small.view, {.arenaBytes = 4 * kSmallPatch + 4, .framesInFlight = framesInFlight});
        const States fine = one.uniform(0);
        const auto touch = [&](uint32_t patch) {
            one.begin();
            one.cache.release(one.hold(patch, fine));
            one.cache.endFrame();
            return one.cache.stats().hits == 1;
        };
        for (uint32_t p = 0; p < 4; ++p) CHECK_FALSE(touch(p));
        CHECK(touch(0));
        CHECK(touch(2));
        one.emptyFrames(framesInFlight - 1);
        CHECK(one.cache.stats().ranges == 4);

        one.begin(); // oldest first: 1 3 0 2
        const uint32_t four = one.hold(4, fine), five = one.hold(5, fine);
        CHECK(one.cache.stats().evictions == 2);
        CHECK(one.cache.stats().refusals == 0);
        const uint32_t zero = one.hold(0, fine), two = one.hold(2, fine);
        CHECK(one.cache.stats().hits == 2);
        CHECK(one.cache.stats().heldRanges == 4);
        uint32_t none = kNoRange;
        checkSays(one.acquire(1, fine, none), "arenaBytes", kSmallPatch);
        one.cache.release(five);
        checkSays(one.acquire(1, fine, none), "arenaBytes", kSmallPatch); // may be drawn yet
        one.cache.endFrame();
        for (uint32_t f = 1; f < framesInFlight; ++f) {
            one.begin();
            checkSays(one.acquire(1, fine, none), "arenaBytes", kSmallPatch);
            CHECK(one.cache.stats().evictions == 0);
            one.cache.endFrame();
        }
        CHECK(none == kNoRange);
        one.begin();
        one.hold(1, fine);
        CHECK(one.cache.stats().evictions == 1);
        CHECK(one.cache.stats().misses == 1);
        CHECK(one.hold(4, fine) == four);
        CHECK(one.hold(0, fine) == zero);
        CHECK(one.hold(2, fine) == two);
        one.cache.endFrame();
    }
}

TEST_CASE("a range that was let go of is had back without a copy, in the same frame and later") {
    const Assets assets;
    OneAsset one(assets.small.view, {.framesInFlight = 2});
    const States fine = one.uniform(0);
    one.begin();
    const uint32_t range = one.hold(3, fine);
    one.cache.release(range);
    CHECK(one.hold(3, fine) == range);
    one.cache.hold(range);
    one.cache.release(range);
    CHECK(one.cache.stats().heldRanges == 1);
    one.cache.release(range);
    CHECK(one.cache.stats().heldRanges == 0);
    one.cache.endFrame();
    CHECK(one.cache.copies().size() == 1);
    for (const uint32_t frames : {0u, 1u, 2u, 5u}) {
        one.emptyFrames(frames);
        one.cache.beginFrame({}); // no staging: nothing can be built
        CHECK(one.hold(3, fine) == range);
        CHECK(one.cache.stats().hits == 1);
        one.cache.release(range);
        one.cache.endFrame();
        CHECK(one.cache.copies().empty());
    }
}

TEST_CASE("the cap on a frame's upload delays and never loses") {
    const Assets assets;
    const AssetView& asset = assets.large.view;
    const uint32_t patchBytes = 4 * 3 * asset.record->maxPatchFaces; // before it is known that two bytes do
    const uint32_t cap = patchBytes + 1000;
    OneAsset one(asset, {}, cap);
    FakeGpu gpu(IndexCacheConfig{}.arenaBytes, 2);
    const States fine = one.uniform(0);
    std::vector<uint32_t> ranges(asset.patchCount(), kNoRange);
    uint32_t frames = 0;
    for (; std::count(ranges.begin(), ranges.end(), kNoRange) > 0 && frames < 100; ++frames) {
        gpu.waitForOldFrames();
        one.begin();
        uint32_t refusals = 0;
        std::vector<FakeGpu::Draw> draws;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            if (ranges[p] == kNoRange && !one.acquire(p, fine, ranges[p]).ok()) ++refusals;
            if (ranges[p] != kNoRange) draws.push_back({one.cache.at(ranges[p]), trianglesOf(asset, p, fine)});
        }
        CHECK(one.cache.stats().refusals == refusals);
        CHECK(one.cache.stats().uploadBytes <= cap);
        CHECK(one.cache.stats().uploadBytes > 0);
        one.cache.endFrame();
        gpu.submit(one.cache, std::span(one.staging).first(cap), draws);
    }
    gpu.waitForOldFrames();
    CHECK(frames > 5);
    CHECK(frames < 17);

    OneAsset never(asset, {}, patchBytes - 4);
    uint32_t range = kNoRange;
    never.begin();
    const Status tooLong = never.acquire(0, fine, range);
    checkSays(tooLong, "all of the frame's staging", patchBytes);
    CHECK(never.cache.stats().ranges == 0);
    never.cache.endFrame();
    OneAsset fits(asset, {}, patchBytes);
    fits.begin();
    fits.hold(0, fine);
    checkSays(fits.acquire(1, fine, range), "next frame", patchBytes);
    CHECK(range == kNoRange);
    fits.cache.endFrame();
}

TEST_CASE("a file that lies about its triangles makes no range longer than staging") {
    const Assets assets;
    const std::vector<uint32_t> zeros(size_t(assets.small.view.patchCount()) * assets.small.view.levelCount(), 0);
    AssetView liar = assets.small.view;
    liar.patchFaceCounts = zeros;
    OneAsset one(liar, {}, kSmallPatch - 4);
    one.begin();
    uint32_t range = kNoRange;
    checkSays(one.acquire(0, one.uniform(0), range), "all of the frame's staging", kSmallPatch);
    one.hold(0, one.uniform(1));
    one.cache.endFrame();
    for (size_t i = one.staging.size() - 4; i < one.staging.size(); ++i) CHECK(one.staging[i] == kGuard);
}

TEST_CASE("copies whose both ends meet are one") {
    const Assets assets;
    OneAsset one(assets.small.view, {.copyCapacity = 1});
    one.begin();
    const uint32_t first = one.hold(0, one.uniform(0));
    uint32_t range = kNoRange;
    checkSays(one.acquire(1, one.uniform(0), range), "copyCapacity", 2); // it might not meet
    CHECK(one.hold(0, one.uniform(0)) == first);
    one.cache.endFrame();

    OneAsset roomy(assets.small.view, {});
    roomy.begin();
    for (uint32_t p = 0; p < 9; ++p) roomy.hold(p, roomy.uniform(0));
    roomy.cache.endFrame();
    REQUIRE(roomy.cache.copies().size() == 1);
    CHECK(roomy.cache.copies()[0].bytes == 9 * kSmallPatch);
    CHECK(roomy.cache.stats().uploadBytes == 9 * kSmallPatch);
    CHECK(roomy.cache.stats().usedBytes == 9 * kSmallPatch);
    CHECK(roomy.cache.stats().largestFreeBytes == IndexCacheConfig{}.arenaBytes - 9 * kSmallPatch);
}

TEST_CASE("an asset that needs 32-bit indices has 16-bit ranges too, and wide slots do") {
    // 512 x 512 rows in four patches of more than 65,536 slots.
    const xgc::test::OpenAsset built = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 2, .levels = 8}));
    REQUIRE(built.failure == "");
    const AssetView& asset = built.view;
    REQUIRE(asset.record->vertexCount > 65536);
    const uint32_t arenaBytes = 8u << 20;
    for (const bool narrowIndices : {true, false}) {
        OneAsset one(asset, {.arenaBytes = arenaBytes, .slotCapacity = 66049, .narrowIndices = narrowIndices},
                     8u << 20);
        FakeGpu gpu(arenaBytes, 2);
        std::vector<FakeGpu::Draw> draws;
        std::set<uint32_t> sizes;
        const auto draw = [&](uint32_t range, const Triangles& truth) {
            draws.push_back({one.cache.at(range), truth});
            sizes.insert(one.cache.at(range).indexBytes);
            uint32_t least = UINT32_MAX, most = 0;
            for (const auto& t : truth) {
                least = std::min(least, *std::min_element(t.begin(), t.end()));
                most = std::max(most, *std::max_element(t.begin(), t.end()));
            }
            const bool narrow = narrowIndices && most - least < 65535;
            CHECK(one.cache.at(range).indexBytes == (narrow ? 2 : 4));
            CHECK(one.cache.at(range).vertexOffset == (narrow ? least : 0));
        };
        gpu.waitForOldFrames();
        one.begin();
        for (uint32_t p = 0; p < 4; ++p) {
            for (const States& levels : {States{0, 3, 5, 8}, States{2, 1, 8, 6}, States{8, 8, 8, 8}}) {
                draw(one.hold(p, levels), trianglesOf(asset, p, levels));
            }
        }
        for (const uint32_t level : {2u, 6u, 8u}) {
            uint32_t range = kNoRange;
            REQUIRE(one.cache.acquireWhole(0, 1, level, uniform(asset, level), range).ok());
            draw(range, wholeTriangles(asset, 1, level));
        }
        one.cache.endFrame();
        gpu.submit(one.cache, std::span(one.staging).first(one.staging.size() - 4), draws);
        one.emptyFrames(1);
        gpu.submit(one.cache, {}, {});
        gpu.waitForOldFrames();
        CHECK(sizes.size() == (narrowIndices ? 2 : 1));
    }
}

TEST_CASE("16 bits hold rows that lie within 65,534 of each other") {
    const auto span = [](std::vector<uint32_t> rows) {
        xgc::RowSpan s;
        s.add(rows);
        return s;
    };
    CHECK(span({7, 1000, 7 + 65534}).isNarrow());
    CHECK_FALSE(span({7, 1000, 7 + 65535}).isNarrow()); // 0xffff means another thing to some APIs
    CHECK_FALSE(span({}).isNarrow());
    CHECK(span({4000000000u}).first == 4000000000u);
    std::vector<uint32_t> rows(1000);
    std::iota(rows.begin(), rows.end(), 123456u);
    std::vector<std::byte> packed = guarded(2002);
    xgc::packNarrow(rows, 123456, packed.data() + 2);
    for (uint32_t i = 0; i < 1000; ++i) {
        uint16_t index = 0;
        std::memcpy(&index, &packed[2 + 2 * i], 2);
        CHECK(index == i);
    }
    CHECK(packed[0] == kGuard);
    CHECK(packed[2002] == kGuard);
}

TEST_CASE("what does not fit the configuration is refused with the setting's name") {
    const Assets assets;
    const AssetView& asset = assets.large.view;
    const auto says = [&](const IndexCacheConfig& config, const char* setting, uint64_t needed) {
        IndexCache cache;
        REQUIRE(cache.create(config).ok());
        checkSays(cache.addAsset(1, asset), setting, needed);
    };
    uint32_t domains = 0;
    for (const auto& patch : asset.patches) domains = std::max(domains, patch.domainCount);
    says({.assetCapacity = 1}, "assetCapacity", 2);
    says({.slotCapacity = 80}, "slotCapacity", 81);
    says({.faceCapacity = 127}, "faceCapacity", 128);
    says({.patchCapacity = 15}, "patchCapacity", 16);
    says({.domainsPerPatchCapacity = domains - 1}, "domainsPerPatchCapacity", domains);
    IndexCache exact;
    REQUIRE(exact
                .create({.assetCapacity = 2,
                         .slotCapacity = 81,
                         .faceCapacity = 128,
                         .patchCapacity = 16,
                         .domainsPerPatchCapacity = domains})
                .ok());
    CHECK(exact.addAsset(1, asset).ok());

    OneAsset few(asset, {.rangeCapacity = 1});
    uint32_t range = kNoRange;
    few.begin();
    const uint32_t first = few.hold(0, few.uniform(0));
    checkSays(few.acquire(1, few.uniform(0), range), "rangeCapacity", 2);
    few.cache.release(first);
    checkSays(few.acquire(1, few.uniform(0), range), "rangeCapacity", 2);
    few.cache.endFrame();
    few.emptyFrames(1);
    few.begin();
    CHECK(few.acquire(1, few.uniform(0), range).ok());
    CHECK(few.cache.stats().evictions == 1);
    few.cache.endFrame();

    const uint32_t keyBytes = 9 + asset.patches[0].domainCount;
    OneAsset brief(asset, {.keyBytes = keyBytes + 8});
    brief.begin();
    const uint32_t named = brief.hold(0, brief.uniform(0));
    range = kNoRange;
    checkSays(brief.acquire(1, brief.uniform(0), range), "keyBytes", 2 * keyBytes + 8);
    CHECK(range == kNoRange);
    brief.cache.release(named);
    brief.cache.endFrame();
    brief.emptyFrames(1);
    brief.begin();
    CHECK(brief.acquire(1, brief.uniform(0), range).ok());
    brief.cache.endFrame();

    IndexCache cache;
    CHECK(cache.create({.framesInFlight = 0}).code == StatusCode::badArgument);
    CHECK(cache.create({.arenaBytes = 3}).code == StatusCode::badArgument);
}

TEST_CASE("frames allocate nothing") {
    const Assets assets;
    const AssetView& asset = assets.large.view;
    IndexCache cache;
    const uint64_t beforeCreate = xgc::test::allocations;
    REQUIRE(cache.create({.arenaBytes = 20000, .rangeCapacity = 100}).ok());
    CHECK(xgc::test::allocations > beforeCreate); // the counter counts
    Random random(5);
    std::vector<States> states;
    for (int i = 0; i < 32; ++i) states.push_back(random.levels(asset));
    std::vector<std::byte> staging(1u << 16);
    uint32_t acquired = 0, evictions = 0;
    std::array<uint32_t, 16> ranges{};
    bool added = cache.addAsset(0, asset).ok() && cache.addAsset(1, asset).ok();
    const uint64_t before = xgc::test::allocations;
    for (uint32_t frame = 0; frame < 200; ++frame) {
        if (frame % 16 == 0) {
            cache.removeAsset(0);
            added &= cache.addAsset(0, asset).ok();
        }
        cache.beginFrame(staging);
        uint32_t count = 0;
        for (uint32_t p = 0; p < 16; ++p) {
            count += cache.acquire(frame % 2, p, states[(frame + p) % 32], ranges[count]).ok();
        }
        acquired += count;
        while (count > 0) cache.release(ranges[--count]);
        cache.endFrame();
        evictions += cache.stats().evictions;
    }
    CHECK(xgc::test::allocations == before);
    CHECK(added);
    CHECK(acquired > 1000);
    CHECK(evictions > 0);
}

TEST_CASE("an arena of twice the bytes that are held refuses nothing") {
    // Patches of 2 to 2,048 triangles and wholes of up to four times that: three orders of magnitude in size.
    const xgc::test::OpenAsset built = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 4, .levels = 5}));
    REQUIRE(built.failure == "");
    const AssetView& asset = built.view;
    const auto bytesOf = [](const Triangles& t) { return uint32_t((6 * t.size() + 3) / 4 * 4); };
    for (const uint32_t seed : {1u, 2u, 3u, 4u}) {
        Random random(seed);
        const uint32_t arenaBytes = 100000; // eight times the longest
        OneAsset one(asset, {.arenaBytes = arenaBytes, .framesInFlight = 1 + seed % 3}, 1u << 20);
        std::map<uint32_t, uint32_t> held; // range, bytes
        uint32_t heldBytes = 0, evictions = 0, mostHeld = 0;
        for (int step = 0; step < 1500; ++step) {
            States levels = random.levels(asset);
            const uint32_t patch = random.below(16);
            const bool whole = random.below(8) == 0;
            const uint32_t level = 2 + random.below(4);
            const uint32_t bytes = bytesOf(whole ? wholeTriangles(asset, 0, level) : trianglesOf(asset, patch, levels));
            while (heldBytes + bytes > arenaBytes / 2) {
                const auto gone = std::next(held.begin(), random.below(uint32_t(held.size())));
                one.cache.release(gone->first);
                heldBytes -= gone->second;
                held.erase(gone);
            }
            one.emptyFrames(one.cache.stats().heldRanges == held.size() ? 3 : 0);
            one.begin();
            uint32_t range = kNoRange;
            const Status status = whole ? one.cache.acquireWhole(0, 0, level, uniform(asset, level), range)
                                        : one.acquire(patch, levels, range);
            REQUIRE_MESSAGE(status.ok(), status.message << " step " << step);
            if (held.emplace(range, bytes).second)
                heldBytes += bytes;
            else
                one.cache.release(range);
            mostHeld = std::max(mostHeld, heldBytes);
            evictions += one.cache.stats().evictions;
            one.cache.endFrame();
        }
        CHECK(evictions > 500);
        CHECK(mostHeld > arenaBytes / 2 * 9 / 10);
    }
}

TEST_CASE("key table: finds what a map finds, whatever came and went") {
    constexpr uint32_t kIds = 40;
    xgc::KeyTable table;
    REQUIRE(table.create(kIds, 600));
    std::map<std::string, uint32_t> truth;
    std::vector<uint32_t> unused(kIds);
    std::iota(unused.begin(), unused.end(), 0u);
    Random random(2);
    int full = 0;
    for (int step = 0; step < 20000; ++step) {
        const std::string text(1 + random.below(30), char('a' + random.below(3)));
        const xgc::KeyTable::Key key = std::as_bytes(std::span(text));
        const uint32_t hash = xgc::KeyTable::hash(key);
        const uint32_t found = table.find(key, hash);
        const auto known = truth.find(text);
        REQUIRE((found != xgc::KeyTable::kNone) == (known != truth.end()));
        if (known != truth.end()) {
            CHECK(found == known->second);
            if (random.below(2)) continue;
            table.remove(found);
            unused.push_back(found);
            truth.erase(known);
        } else if (!unused.empty()) {
            if (table.insert(unused.back(), key, hash)) {
                truth[text] = unused.back();
                unused.pop_back();
            } else {
                ++full;
                CHECK(table.find(key, hash) == xgc::KeyTable::kNone);
            }
        }
    }
    CHECK(full > 100);
}
