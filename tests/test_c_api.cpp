#include "c_api/flight.h"
#include "meshes/patched_torus.h"

#include <xgc/draw_list.h>
#include <xgc/parts.h>

#include <doctest/doctest.h>
#include <glm/gtc/type_ptr.hpp>

#include <vector>

// xgc.h is used from C (c_api/*.c, compiled as C11); what it gives is compared with the C++ API here.

namespace {

using namespace xgc;

struct Assets {
    test::OpenAsset assets[2] = {
        test::openBuilt(test::patchedTorus({.patches = 3, .levels = 3})),
        test::openBuilt(test::patchedTorus({.patches = 4, .levels = 3, .materials = 3, .repeatedLevels = 1})),
    };
    Assets() {
        for (const test::OpenAsset& asset : assets) REQUIRE(asset.failure == "");
    }
    std::span<const std::byte> bytes(int i) const { return assets[i].bytes.span(); }
};

const Assets& made() {
    static const Assets assets;
    return assets;
}

/// Null where a check in C held.
void holds(const char* failure) {
    CHECK_MESSAGE(failure == nullptr, (failure ? failure : ""));
}

template <typename T>
uint64_t hashOf(uint64_t hash, std::span<const T> values) {
    return flightHash(hash, values.data(), values.size_bytes());
}

template <typename T>
uint64_t hashOf(uint64_t hash, const T& value) {
    return flightHash(hash, &value, sizeof value);
}

/// The flight of flight.c with the C++ API.
class Flight {
public:
    Flight() {
        const SceneConfig config;
        REQUIRE(scene_.create(config).ok());
        REQUIRE(cache_.create({.arenaBytes = kFlightArena}).ok());
        for (int v = 0; v < 2; ++v) {
            REQUIRE(selections_[v].create(config).ok());
            REQUIRE(lists_[v].create({.scene = config, .wholeTriangles = 400}).ok());
        }
        int32_t row = 0;
        uint32_t material = 0;
        for (int i = 0; i < 2; ++i) {
            const AssetView& asset = made().assets[i].view;
            REQUIRE(scene_.addAsset({&asset, row, material}, ids_[i]).ok());
            REQUIRE(cache_.addAsset(ids_[i], asset).ok());
            row += int32_t(asset.record->vertexCount);
            material += asset.record->materialCount;
            radius_ = asset.record->sphereRadius;
        }
        for (uint32_t i = 0; i < kFlightInstances; ++i) {
            float toWorld[16];
            flightPlace(i, radius_, toWorld);
            REQUIRE(scene_.addInstance(ids_[i % 2], makePlacement(glm::make_mat4(toWorld)), instances_[i]).ok());
        }
    }

    FlightFrame frame(uint32_t number) {
        const FlightStep step = flightStep(number, radius_);
        scene_.setPlacement(instances_[step.moved], makePlacement(glm::make_mat4(step.toWorld)));
        steer(number);
        choose(step);
        cache_.beginFrame(staging_);
        for (int v = 0; v < 2; ++v) lists_[v].update(scene_, selections_[v], cache_);
        cache_.endFrame();
        FlightFrame out{};
        out.copies = hashOf(1, cache_.copies());
        for (const CopyRange& copy : cache_.copies()) {
            out.copies = flightHash(out.copies, staging_.data() + copy.staging, copy.bytes);
        }
        for (int v = 0; v < 2; ++v) hashView(v, out);
        out.stats = stats();
        return out;
    }

    uint32_t morphed() const { return morphed_; }
    uint32_t deferred() const { return lists_[0].stats().deferredInstances; }
    uint32_t ofKind(InstanceKind kind) const {
        uint32_t count = 0;
        for (const uint32_t id : instances_) count += lists_[0].kind(id) == kind;
        return count;
    }

private:
    void steer(uint32_t number) {
        const uint32_t part = findPart(made().assets[0].view, made().assets[0].view.parts[1].stableId);
        if (number == 10) REQUIRE(scene_.setPart(instances_[0], part, {.importance = 4, .coarsest = 1}).ok());
        if (number == 15) REQUIRE(scene_.setPart(instances_[2], part, {.hidden = true}).ok());
        if (number == 25) scene_.clearParts(instances_[2]);
        if (number == 20 || number == 30) scene_.setVisible(instances_[4], number == 30);
    }
    void choose(const FlightStep& step) {
        const glm::vec3 eye = glm::make_vec3(step.eye);
        SelectionDesc main;
        main.view = makeView(eye, 1, 1080);
        main.view.nearest = 0.1f;
        main.pixels = 2;
        main.hysteresis = step.morphs ? 0 : 0.05f;
        main.morph = step.morphs;
        main.triangleBudget = step.triangleBudget;
        main.boundPixels = true;
        main.cullBackfaces = true;
        main.frustum = makeFrustum(glm::make_mat4(step.worldToClip));
        selections_[0].update(scene_, main);
        SelectionDesc second;
        second.view = makeOrthographicView(eye, glm::make_vec3(step.forward), 20 * radius_, 512);
        if (step.usesBands) {
            second.view = makeView(eye, 1, 512);
            second.policy = Policy::distanceBands;
            second.bands = step.bands;
        }
        second.reference = &selections_[0];
        second.coarserThanReference = 1;
        second.contributionPixels = 2;
        selections_[1].update(scene_, second);
    }
    void hashView(int v, FlightFrame& out) {
        const Selection& chosen = selections_[v];
        const DrawList& list = lists_[v];
        uint64_t levels = 1;
        const auto add = [&](const auto& of, uint32_t id, bool seen) {
            levels = hashOf(levels, uint32_t(of.kind(id)));
            levels = hashOf(levels, of.kind(id) == InstanceKind::whole ? of.wholeState(id) : format::kNone);
            if (of.kind(id) == InstanceKind::mixed) levels = hashOf(levels, of.levels(id));
            if (seen && of.kind(id) == InstanceKind::mixed) levels = hashOf(levels, chosen.visible(id));
            if (of.kind(id) == InstanceKind::mixed) levels = hashOf(levels, of.fractions(id));
            morphed_ += of.kind(id) == InstanceKind::mixed && !of.fractions(id).empty();
        };
        for (const uint32_t id : instances_) {
            add(chosen, id, true);
            add(list, id, false);
        }
        out.levels[v] = levels;
        out.draws[v] =
            hashOf(hashOf(hashOf(hashOf(1, list.draws()), list.sources()), list.batches()), list.drawInstances());
    }
    uint64_t stats() const {
        uint64_t hash = 1;
        for (int v = 0; v < 2; ++v) {
            const SelectionStats& s = selections_[v].stats();
            for (const uint32_t count :
                 {s.visibleInstances, s.wholeInstances, s.consideredPatches, s.culledPatches, s.changedPatches}) {
                hash = hashOf(hash, count);
            }
            hash = hashOf(hashOf(hashOf(hash, s.pixels), s.triangleBudget), s.triangleBound);
            hash = hashOf(hashOf(hash, uint32_t(s.overBudget)), s.pixelsBound);
            const DrawStats& d = lists_[v].stats();
            hash = hashOf(hashOf(hash, d.instances), d.triangles);
            for (const uint32_t count : {d.changedPatches, d.reboundPatches, d.deferredInstances, 0u}) {
                hash = hashOf(hash, count);
            }
        }
        const IndexCacheStats c = cache_.stats();
        for (const uint32_t count : {c.hits, c.misses, c.evictions, c.refusals, c.uploadBytes, c.ranges, c.heldRanges,
                                     c.usedBytes, c.largestFreeBytes}) {
            hash = hashOf(hash, count);
        }
        return hash;
    }

    Scene scene_;
    IndexCache cache_;
    Selection selections_[2];
    DrawList lists_[2];
    uint32_t ids_[2] = {}, instances_[kFlightInstances] = {};
    float radius_ = 0;
    uint32_t morphed_ = 0;
    std::vector<std::byte> staging_ = std::vector<std::byte>(kFlightStaging);
};

uint64_t buildAll(const AssetView& asset, const std::vector<uint8_t>& levels) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
    uint64_t hash = hashOf(1, std::span(levels));
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        indices.resize(indexCapacity(asset, p, levels));
        const uint32_t count = buildIndices(asset, p, levels, scratch, indices);
        hash = hashOf(hash, std::span<const uint32_t>(indices).first(count));
    }
    return hash;
}

} // namespace

TEST_CASE("a flight in C gives the levels, draws, copies and counts of the same flight in C++") {
    const void* const bytes[2] = {made().bytes(0).data(), made().bytes(1).data()};
    const size_t counts[2] = {made().bytes(0).size(), made().bytes(1).size()};
    std::vector<FlightFrame> frames(kFlightFrames);
    uint32_t jobCalls = 0;
    holds(fly(bytes, counts, frames.data(), &jobCalls));
    CHECK(jobCalls >= kFlightFrames);

    Flight flight;
    uint32_t wholes = 0, mixeds = 0, culled = 0, deferred = 0;
    for (uint32_t i = 0; i < kFlightFrames; ++i) {
        CAPTURE(i);
        const FlightFrame frame = flight.frame(i);
        for (int v = 0; v < 2; ++v) {
            CHECK(frames[i].levels[v] == frame.levels[v]);
            CHECK(frames[i].draws[v] == frame.draws[v]);
        }
        CHECK(frames[i].copies == frame.copies);
        CHECK(frames[i].stats == frame.stats);
        wholes += flight.ofKind(InstanceKind::whole);
        mixeds += flight.ofKind(InstanceKind::mixed);
        culled += flight.ofKind(InstanceKind::culled);
        deferred += flight.deferred();
    }
    // It comes by everything that there is.
    CHECK(wholes > 50);
    CHECK(mixeds > 50);
    CHECK(culled > 50);
    CHECK(deferred > 0);
    CHECK(flight.morphed() > 0);
}

TEST_CASE("C reads an asset and builds the same triangles without a scene") {
    for (int i = 0; i < 2; ++i) {
        const AssetView& asset = made().assets[i].view;
        uint64_t hashes[2] = {};
        holds(readAsset(made().bytes(i).data(), made().bytes(i).size(), hashes));
        float toWorld[16];
        flightPlace(3, asset.record->sphereRadius, toWorld);
        const Placement placement = makePlacement(glm::make_mat4(toWorld));
        const View view = makeView({0, 0, 3 * asset.record->sphereRadius}, 1, 1080);
        const float bands[3] = {0.5f, 1.5f, 2.5f};
        std::vector<uint8_t> levels(asset.patchCount());
        select(asset, placement, view, ErrorPixels{1.5f}, levels);
        CHECK(buildAll(asset, levels) == hashes[0]);
        select(asset, placement, view, DistanceBands{bands}, levels);
        CHECK(buildAll(asset, levels) == hashes[1]);
    }
}

TEST_CASE("what C callers get wrong is a status, and the objects work on") {
    holds(checkRefusals(made().bytes(1).data(), made().bytes(1).size()));
}

TEST_CASE("memory comes from the host's heap and goes back, and its log is told of each failure") {
    holds(checkServices(made().bytes(0).data(), made().bytes(0).size()));
}

TEST_CASE("hosts that know less or more of a struct are understood") {
    holds(checkSizes());
}

TEST_CASE("defaults in C are those of C++") {
    XgcSelectionDesc desc;
    xgcSelectionDescDefaults(&desc, sizeof desc);
    const SelectionDesc d;
    CHECK(desc.pixels == d.pixels);
    CHECK(desc.wholeBeyond == d.wholeBeyond);
    CHECK(desc.morphRate == d.morphRate);
    CHECK(desc.view.pixelsPerUnit == d.view.pixelsPerUnit);
    CHECK(desc.view.forward[2] == d.view.forward.z);
    CHECK(desc.frustum.planeCount == 0);
    CHECK(!desc.jobs.run);
    CHECK(desc.reference == nullptr);
    XgcPartControl control;
    xgcPartControlDefaults(&control, sizeof control);
    CHECK(control.coarsest == PartControl{}.coarsest);
    CHECK(control.importance == PartControl{}.importance);
}
