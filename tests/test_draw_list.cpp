#include "counted_allocations.h"
#include "meshes/patched_torus.h"
#include "random.h"

#include <xgc/draw_list.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <map>
#include <set>

namespace {

using namespace xgc;
using test::Random;

/// What a renderer with an index arena does, and more: it fails where a copy lands in memory that a frame in flight
/// draws, and poisons all that is not in flight and that no list holds.
class FakeGpu {
public:
    FakeGpu(uint32_t arenaBytes, uint32_t framesInFlight)
        : arena_(arenaBytes, std::byte(0xcd)), lastDrawn_(arenaBytes, 0), framesInFlight_(framesInFlight) {}

    void copy(const IndexCache& cache, std::span<const std::byte> staging) {
        ++frame_;
        uint32_t clashes = 0;
        for (const CopyRange& c : cache.copies()) {
            for (uint32_t i = 0; i < c.bytes; ++i) {
                clashes += lastDrawn_[c.arena + i] > 0 && lastDrawn_[c.arena + i] + framesInFlight_ > frame_;
                arena_[c.arena + i] = staging[c.staging + i];
            }
        }
        CHECK(clashes == 0);
    }
    /// The rows of a draw, as its asset numbers them.
    std::vector<uint32_t> draw(const DrawCommand& command, uint32_t indexBytes, int32_t assetOffset) {
        std::vector<uint32_t> rows;
        for (uint32_t i = 0; i < command.indexCount; ++i) {
            const size_t at = size_t(command.firstIndex + i) * indexBytes;
            uint32_t index = 0;
            std::memcpy(&index, arena_.data() + at, indexBytes);
            for (uint32_t b = 0; b < indexBytes; ++b) lastDrawn_[at + b] = frame_;
            rows.push_back(uint32_t(int32_t(index) + command.vertexOffset - assetOffset));
        }
        return rows;
    }

private:
    std::vector<std::byte> arena_;
    std::vector<uint64_t> lastDrawn_;
    uint32_t framesInFlight_;
    uint64_t frame_ = 0;
};

using Triangles = std::vector<std::array<uint32_t, 3>>;

/// Equal sets of triangles may come in another order.
Triangles sorted(std::span<const uint32_t> indices) {
    Triangles triangles;
    for (size_t i = 0; i + 2 < indices.size(); i += 3) {
        std::array<uint32_t, 3> t = {indices[i], indices[i + 1], indices[i + 2]};
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        triangles.push_back(t);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

void append(const AssetView& asset, uint32_t patch, Levels levels, std::vector<uint32_t>& to) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out(indexCapacity(asset, patch, levels));
    out.resize(buildIndices(asset, patch, levels, scratch, out));
    to.insert(to.end(), out.begin(), out.end());
}

struct Assets {
    test::OpenAsset small = test::openBuilt(test::patchedTorus({.patches = 3, .levels = 2}));
    test::OpenAsset large =
        test::openBuilt(test::patchedTorus({.patches = 4, .levels = 3, .materials = 3, .repeatedLevels = 1}));
    Assets() {
        REQUIRE(small.failure == "");
        REQUIRE(large.failure == "");
    }
};

/// A scene, views of it, and what a renderer keeps.
struct Stage {
    static constexpr uint32_t kFramesInFlight = 2;
    SceneConfig config{.assetCapacity = 4, .instanceCapacity = 24, .assetPatchCapacity = 64, .patchCapacity = 24 * 16};
    Scene scene;
    IndexCache cache;
    std::vector<Selection> selections;
    std::vector<DrawList> lists;
    FakeGpu gpu;
    std::vector<std::byte> staging;

    Stage(uint32_t views, uint32_t arenaBytes, uint32_t stagingBytes, uint32_t wholeTriangles = 10000)
        : gpu(arenaBytes, kFramesInFlight) {
        REQUIRE(scene.create(config).ok());
        REQUIRE(
            cache.create({.arenaBytes = arenaBytes, .rangeCapacity = 4096, .framesInFlight = kFramesInFlight}).ok());
        for (uint32_t i = 0; i < views; ++i) {
            REQUIRE(selections.emplace_back().create(config).ok());
            REQUIRE(lists.emplace_back()
                        .create({.scene = config, .materialCapacity = 16, .wholeTriangles = wholeTriangles})
                        .ok());
        }
        staging.resize(stagingBytes);
    }
    uint32_t add(const AssetView& asset, int32_t vertexOffset, uint32_t firstMaterial) {
        uint32_t id = 0;
        REQUIRE(scene.addAsset({&asset, vertexOffset, firstMaterial}, id).ok());
        REQUIRE(cache.addAsset(id, asset).ok());
        return id;
    }
    uint32_t place(uint32_t asset, const Placement& placement) {
        uint32_t id = 0;
        REQUIRE(scene.addInstance(asset, placement, id).ok());
        return id;
    }
    void frame() {
        cache.beginFrame(staging);
        for (size_t v = 0; v < lists.size(); ++v) lists[v].update(scene, selections[v], cache);
        cache.endFrame();
        gpu.copy(cache, staging);
    }
    const AssetView& assetOf(uint32_t id) const { return *scene.asset(scene.assetOf(id)).asset; }
};

/// What is drawn of each instance is what buildIndices writes for the levels that it is drawn at, in batches that
/// tell the truth. Returns, per instance, the patches that are drawn.
std::map<uint32_t, std::set<uint32_t>> checkDraws(Stage& stage, const DrawList& list) {
    std::map<uint32_t, std::set<uint32_t>> patches;
    std::map<uint32_t, std::vector<uint32_t>> drawn;
    REQUIRE(list.sources().size() == list.draws().size());
    uint32_t next = 0, lastKey = 0;
    uint64_t triangles = 0;
    for (const DrawBatch& batch : list.batches()) {
        CHECK(batch.firstDraw == next);
        CHECK(batch.drawCount > 0);
        const uint32_t key = batch.material * 8 + batch.indexBytes;
        if (next > 0) CHECK(key > lastKey);
        lastKey = key;
        for (; next < batch.firstDraw + batch.drawCount; ++next) {
            const DrawCommand& command = list.draws()[next];
            const DrawSource& source = list.sources()[next];
            const AssetDesc& asset = stage.scene.asset(source.asset);
            const std::vector<uint32_t> rows = stage.gpu.draw(command, batch.indexBytes, asset.vertexOffset);
            triangles += uint64_t(command.indexCount / 3) * command.instanceCount;
            for (uint32_t i = 0; i < command.instanceCount; ++i) {
                const uint32_t id = list.drawInstances()[command.firstInstance + i];
                REQUIRE(stage.scene.assetOf(id) == source.asset);
                drawn[id].insert(drawn[id].end(), rows.begin(), rows.end());
                for (uint32_t p = 0; p < asset.asset->patchCount(); ++p) {
                    if (source.patch != format::kNone && source.patch != p) continue;
                    if (asset.firstMaterial + asset.asset->patches[p].material != batch.material) continue;
                    CHECK(patches[id].insert(p).second);
                }
            }
        }
    }
    CHECK(next == list.draws().size());
    CHECK(list.stats().triangles == triangles);
    for (uint32_t id = 0; id < stage.scene.instanceEnd(); ++id) {
        if (!stage.scene.hasInstance(id)) {
            CHECK(drawn.count(id) == 0);
            continue;
        }
        const AssetView& asset = stage.assetOf(id);
        std::vector<uint32_t> truth;
        if (list.kind(id) == InstanceKind::whole) {
            std::vector<uint8_t> levels(asset.patchCount());
            stage.scene.wholeLevels(stage.scene.assetOf(id), list.wholeState(id), levels);
            for (uint32_t p = 0; p < asset.patchCount(); ++p) append(asset, p, levels, truth);
        } else if (list.kind(id) == InstanceKind::mixed) {
            for (const uint32_t p : patches[id]) append(asset, p, list.levels(id), truth);
        }
        CHECK(sorted(drawn[id]) == sorted(truth));
    }
    return patches;
}

/// True where an instance is drawn as selected: the same levels, and exactly the visible patches.
bool followed(const Stage& stage, const Selection& selection, const DrawList& list, uint32_t id,
              const std::set<uint32_t>& drawn) {
    if (selection.kind(id) == InstanceKind::whole && list.kind(id) == InstanceKind::mixed) { // too large for one range
        std::vector<uint8_t> levels(list.levels(id).size());
        stage.scene.wholeLevels(stage.scene.assetOf(id), selection.wholeState(id), levels);
        return drawn.size() == levels.size() && std::ranges::equal(levels, list.levels(id));
    }
    if (list.kind(id) != selection.kind(id)) return false;
    if (list.kind(id) == InstanceKind::whole) return list.wholeState(id) == selection.wholeState(id);
    if (list.kind(id) == InstanceKind::culled) return true;
    for (uint32_t p = 0; p < stage.assetOf(id).patchCount(); ++p) {
        if (bool(selection.visible(id)[p]) != bool(drawn.count(p))) return false;
    }
    return std::ranges::equal(list.levels(id), selection.levels(id));
}

/// No patch that is in sight is missing.
void checkNoHole(const Stage& stage, const Selection& selection, const DrawList& list, uint32_t id,
                 const std::set<uint32_t>& drawn) {
    const uint32_t count = stage.assetOf(id).patchCount();
    if (selection.kind(id) == InstanceKind::culled) return;
    CHECK(list.kind(id) != InstanceKind::culled);
    for (uint32_t p = 0; p < count; ++p) {
        const bool needed = selection.kind(id) == InstanceKind::whole || selection.visible(id)[p];
        if (needed) CHECK(drawn.count(p) == 1);
    }
}

Placement somewhere(Random& random, float size) {
    return makePlacement(glm::translate(glm::mat4(1), random.point(size)));
}

SelectionDesc wandering(Random& random) {
    SelectionDesc desc;
    const glm::vec3 eye = random.point(20), target = random.point(20);
    desc.view = makeView(eye, 1, 1080);
    desc.view.nearest = 0.1f;
    desc.pixels = random.between(0.5f, 30);
    desc.hysteresis = 0.05f;
    desc.frustum =
        makeFrustum(glm::perspectiveRH_ZO(1.0f, 1.5f, 0.1f, 100.0f) * glm::lookAt(eye, target, glm::vec3(0, 1, 0)));
    desc.cullBackfaces = random.below(2) == 0;
    return desc;
}

/// Hundreds of frames of views, levels and instances that come and go; returns how often an instance was deferred.
uint64_t randomRun(const Assets& assets, uint32_t arenaBytes, uint32_t stagingBytes, uint32_t seed, bool roomy) {
    Random random(seed);
    Stage stage(2, arenaBytes, stagingBytes, stagingBytes / 12);
    const uint32_t kinds[] = {stage.add(assets.small.view, 0, 0), stage.add(assets.large.view, 5000, 2)};
    std::set<uint32_t> ids, seen;
    uint64_t deferred = 0, wholes = 0, mixeds = 0;
    for (int frame = 0; frame < 300; ++frame) {
        if (random.below(4) == 0 && ids.size() < 20) {
            const uint32_t id = stage.place(kinds[random.below(2)], somewhere(random, 15));
            ids.insert(id);
            seen.erase(id);
        }
        if (random.below(15) == 0 && !ids.empty()) {
            const uint32_t gone = *std::next(ids.begin(), random.below(uint32_t(ids.size())));
            stage.scene.removeInstance(gone);
            ids.erase(gone);
        }
        for (Selection& selection : stage.selections) {
            if (random.below(3) > 0) selection.update(stage.scene, wandering(random));
            for (const uint32_t id : ids) {
                if (random.below(8) > 0) continue;
                std::vector<uint8_t> own(stage.assetOf(id).patchCount());
                for (uint8_t& l : own) l = uint8_t(random.below(stage.assetOf(id).levelCount()));
                selection.set(stage.scene, id, own);
            }
        }
        stage.frame();
        for (size_t v = 0; v < stage.lists.size(); ++v) {
            auto drawn = checkDraws(stage, stage.lists[v]);
            uint32_t late = 0;
            for (const uint32_t id : ids) {
                checkNoHole(stage, stage.selections[v], stage.lists[v], id, drawn[id]);
                late += !followed(stage, stage.selections[v], stage.lists[v], id, drawn[id]);
                wholes += stage.lists[v].kind(id) == InstanceKind::whole;
                mixeds += stage.lists[v].kind(id) == InstanceKind::mixed;
            }
            CHECK(stage.lists[v].stats().deferredInstances == late);
            CHECK(stage.lists[v].refusal().ok() == (late == 0));
            if (roomy) CHECK(late == 0);
            deferred += late;
        }
    }
    CHECK(wholes > 100);
    CHECK(mixeds > 100);
    for (DrawList& list : stage.lists) list.clear(stage.cache);
    CHECK(stage.cache.stats().heldRanges == 0);
    return deferred;
}

constexpr uint32_t kRoomy = 8u << 20;

} // namespace

TEST_CASE("whatever comes and goes, each instance is drawn in one state, with nothing in sight missing") {
    const Assets assets;
    for (const uint32_t seed : {1u, 2u, 3u}) {
        CHECK(randomRun(assets, kRoomy, kRoomy, seed, true) == 0);
        // A cap of less than some instances need at once: changes come in pieces.
        CHECK(randomRun(assets, kRoomy, 12 * 700, seed, false) > 100);
    }
}

TEST_CASE("under a cap of uploads every instance comes to what was selected, if that stays") {
    const Assets assets;
    Stage stage(1, kRoomy, 12 * 700, 700);
    const uint32_t kind = stage.add(assets.large.view, 0, 0);
    Random random(5);
    std::vector<uint32_t> ids;
    for (int i = 0; i < 6; ++i) ids.push_back(stage.place(kind, somewhere(random, 5)));
    for (int round = 0; round < 4; ++round) {
        SelectionDesc desc = wandering(random);
        desc.frustum = {};
        desc.pixels = round % 2 ? 0 : 20; // all in full, then coarse again
        stage.selections[0].update(stage.scene, desc);
        uint32_t frames = 0;
        for (bool late = true; late && frames < 200; ++frames) {
            stage.frame();
            auto drawn = checkDraws(stage, stage.lists[0]);
            late = false;
            for (const uint32_t id : ids) {
                checkNoHole(stage, stage.selections[0], stage.lists[0], id, drawn[id]);
                late |= !followed(stage, stage.selections[0], stage.lists[0], id, drawn[id]);
            }
            CHECK(stage.cache.stats().uploadBytes <= stage.staging.size());
        }
        CHECK(frames < 200);
        if (round == 1) CHECK(frames > 3); // it did take several
    }
}

TEST_CASE("instances of an asset at one level are one draw a material") {
    const Assets assets;
    Stage stage(1, kRoomy, kRoomy);
    const AssetView& asset = assets.large.view;
    const uint32_t kind = stage.add(asset, 0, 0);
    for (int i = 0; i < 20; ++i) {
        stage.place(kind, makePlacement(glm::translate(glm::mat4(1), glm::vec3(i % 2 ? 30 : 3000, 0, 0))));
    }
    SelectionDesc desc;
    desc.view = makeView({0, 0, 0}, 1, 1080);
    stage.selections[0].update(stage.scene, desc);
    stage.frame();
    checkDraws(stage, stage.lists[0]);
    CHECK(stage.selections[0].wholeState(0) != stage.selections[0].wholeState(1));
    CHECK(stage.lists[0].draws().size() == 2 * asset.materials.size());
    for (const DrawCommand& draw : stage.lists[0].draws()) CHECK(draw.instanceCount == 10);
    CHECK(stage.lists[0].draws()[0].firstInstance != stage.lists[0].draws()[1].firstInstance);
    CHECK(stage.lists[0].stats().instances == 20);
}

TEST_CASE("what a list was not created for is refused by name, and not drawn") {
    const Assets assets;
    Stage stage(1, kRoomy, kRoomy);
    stage.place(stage.add(assets.large.view, 0, 0), makePlacement(glm::mat4(1)));
    SelectionDesc desc;
    desc.view = makeView({0, 0, 3}, 1, 1080);
    stage.selections[0].update(stage.scene, desc);
    REQUIRE(stage.selections[0].kind(0) == InstanceKind::mixed);
    for (const bool domains : {true, false}) {
        DrawListConfig config;
        config.scene = stage.scene.config();
        (domains ? config.domainCapacity : config.materialCapacity) = 1;
        DrawList list;
        REQUIRE(list.create(config).ok());
        list.update(stage.scene, stage.selections[0], stage.cache);
        CHECK(list.refusal().code == StatusCode::outOfCapacity);
        CHECK(list.refusal().element ==
              (domains ? assets.large.view.record->domainCount : assets.large.view.materials.size()));
        CHECK(list.draws().empty());
        CHECK(list.stats().deferredInstances == 1);
    }
}

TEST_CASE("a second view with the same levels uploads nothing") {
    const Assets assets;
    Stage one(1, kRoomy, kRoomy), two(2, kRoomy, kRoomy);
    for (Stage* stage : {&one, &two}) {
        const uint32_t kind = stage->add(assets.large.view, 0, 0);
        for (int i = 0; i < 5; ++i)
            stage->place(kind, makePlacement(glm::translate(glm::mat4(1), glm::vec3(4.0f * float(i)))));
        SelectionDesc desc;
        desc.view = makeView({1, 2, 9}, 1, 1080);
        for (Selection& selection : stage->selections) selection.update(stage->scene, desc);
        stage->frame();
        for (DrawList& list : stage->lists) checkDraws(*stage, list);
    }
    CHECK(one.cache.stats().uploadBytes > 0);
    CHECK(one.cache.stats().uploadBytes == two.cache.stats().uploadBytes);
    CHECK(one.lists[0].draws().size() == two.lists[1].draws().size());
}

TEST_CASE("a frame in which nothing changes copies nothing and keeps its draws") {
    const Assets assets;
    Stage stage(1, kRoomy, kRoomy);
    const uint32_t kind = stage.add(assets.large.view, 0, 0);
    stage.place(kind, {});
    SelectionDesc desc;
    desc.view = makeView({0, 0, 6}, 1, 1080);
    stage.selections[0].update(stage.scene, desc);
    stage.frame();
    const std::vector<DrawSource> before(stage.lists[0].sources().begin(), stage.lists[0].sources().end());
    CHECK(stage.lists[0].stats().reboundPatches == assets.large.view.patchCount());
    stage.selections[0].update(stage.scene, desc);
    stage.frame();
    CHECK(stage.cache.copies().empty());
    CHECK(stage.lists[0].stats().reboundPatches == 0);
    CHECK(stage.lists[0].draws().size() == before.size());
    CHECK(stage.lists[0].stats().triangles > 0);
}

TEST_CASE("what is drawn keeps a budget while uploads lag behind") {
    const Assets assets;
    Stage stage(1, kRoomy, 12 * 500);
    const uint32_t kind = stage.add(assets.large.view, 0, 0);
    Random random(6);
    for (int i = 0; i < 10; ++i) stage.place(kind, somewhere(random, 8));
    uint32_t late = 0;
    for (int i = 0; i < 200; ++i) {
        SelectionDesc desc = wandering(random);
        desc.pixels = 0.1f;
        desc.triangleBudget = 1500 + random.below(4000);
        stage.selections[0].update(stage.scene, desc);
        REQUIRE_FALSE(stage.selections[0].stats().overBudget);
        stage.frame();
        checkDraws(stage, stage.lists[0]);
        CHECK(stage.lists[0].stats().triangles <= desc.triangleBudget);
        late += stage.lists[0].stats().deferredInstances;
    }
    CHECK(late > 50);
}

TEST_CASE("an asset can leave while frames that draw it are in flight") {
    const Assets assets;
    Stage stage(1, kRoomy, kRoomy);
    Random random(7);
    for (int i = 0; i < 30; ++i) {
        const uint32_t kind = stage.add(i % 2 ? assets.large.view : assets.small.view, 0, 0);
        const uint32_t id = stage.place(kind, somewhere(random, 9));
        stage.selections[0].update(stage.scene, wandering(random));
        stage.frame();
        checkDraws(stage, stage.lists[0]);
        stage.scene.removeInstance(id);
        stage.lists[0].forgetAsset(kind, stage.cache);
        stage.cache.removeAsset(kind);
        stage.scene.removeAsset(kind);
        CHECK(stage.cache.stats().heldRanges == 0);
    }
}

TEST_CASE("updates allocate nothing") {
    const Assets assets;
    Stage stage(2, kRoomy, kRoomy);
    const uint32_t kind = stage.add(assets.large.view, 0, 0);
    Random random(8);
    for (int i = 0; i < 20; ++i) stage.place(kind, somewhere(random, 15));
    const uint64_t before = test::allocations;
    uint64_t triangles = 0;
    for (int i = 0; i < 100; ++i) {
        stage.cache.beginFrame(stage.staging);
        for (size_t v = 0; v < 2; ++v) {
            stage.selections[v].update(stage.scene, wandering(random));
            stage.lists[v].update(stage.scene, stage.selections[v], stage.cache);
            triangles += stage.lists[v].stats().triangles;
        }
        stage.cache.endFrame();
    }
    CHECK(test::allocations == before);
    CHECK(triangles > 0);
}
