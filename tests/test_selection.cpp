#include "counted_allocations.h"
#include "meshes/patched_torus.h"
#include "meshes/toy_asset.h"
#include "random.h"

#include <xgc/parts.h>
#include <xgc/selection.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

namespace {

using namespace xgc;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using test::Random;

const test::OpenAsset& torus() {
    static const test::OpenAsset asset = test::openBuilt(test::patchedTorus({.patches = 6, .levels = 4}));
    REQUIRE(asset.failure == "");
    return asset;
}

/// A scene of placed assets and one selection of it.
struct Stage {
    Scene scene;
    Selection selection;
    SceneConfig config;

    explicit Stage(const SceneConfig& c = {}) : config(c) {
        REQUIRE(scene.create(config).ok());
        REQUIRE(selection.create(config).ok());
    }
    uint32_t add(const AssetView& asset) {
        uint32_t id = 0;
        REQUIRE(scene.addAsset({.asset = &asset}, id).ok());
        return id;
    }
    uint32_t place(uint32_t asset, const Placement& placement) {
        uint32_t id = 0;
        REQUIRE(scene.addInstance(asset, placement, id).ok());
        return id;
    }
};

/// The levels of an instance, of whatever kind; empty where it is culled.
std::vector<uint8_t> levelsOf(const Stage& stage, const Selection& selection, uint32_t id) {
    const size_t count = stage.scene.asset(stage.scene.assetOf(id)).asset->patchCount();
    if (selection.kind(id) == InstanceKind::culled) return {};
    if (selection.kind(id) == InstanceKind::whole) {
        std::vector<uint8_t> levels(count);
        stage.scene.wholeLevels(stage.scene.assetOf(id), selection.wholeState(id), levels);
        return levels;
    }
    return {selection.levels(id).begin(), selection.levels(id).end()};
}

View viewFrom(const glm::vec3& eye, float nearest = 0) {
    View view = makeView(eye, 1, 1080);
    view.nearest = nearest;
    return view;
}

/// Distance from the eye to a sphere of mesh space, in double precision.
double distanceTo(const Placement& placement, const View& view, const float (&c)[3], float radius) {
    const glm::dvec3 center = glm::dmat4x3(placement.toWorld) * glm::dvec4(c[0], c[1], c[2], 1);
    return glm::length(center - glm::dvec3(view.eye)) - double(placement.maxScale) * double(radius);
}

double projectedAt(double away, const AssetView& asset, const Placement& placement, const View& view, uint32_t patch,
                   uint32_t level) {
    const double error = double(asset.error(patch, level));
    if (error == 0) return 0;
    away = std::max(away, double(view.nearest));
    return away > 0 ? error * double(placement.maxScale) * double(view.pixelsPerUnit) / away : kInfinity;
}

/// The error of a patch at a level on screen, at the nearest point of its sphere.
double projectedBySphere(const AssetView& asset, const Placement& placement, const View& view, uint32_t patch,
                         uint32_t level) {
    const format::PatchRecord& p = asset.patches[patch];
    return projectedAt(distanceTo(placement, view, p.sphereCenter, p.sphereRadius), asset, placement, view, patch,
                       level);
}

/// At the nearest point that lies in the asset's sphere too, as all of the patch does.
double projected(const AssetView& asset, const Placement& placement, const View& view, uint32_t patch, uint32_t level) {
    const format::PatchRecord& p = asset.patches[patch];
    const format::AssetRecord& all = *asset.record;
    const double away = std::max(distanceTo(placement, view, p.sphereCenter, p.sphereRadius),
                                 distanceTo(placement, view, all.sphereCenter, all.sphereRadius));
    return projectedAt(away, asset, placement, view, patch, level);
}

uint32_t triangles(const AssetView& asset, uint32_t patch, Levels levels) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out(indexCapacity(asset, patch, levels));
    return buildIndices(asset, patch, levels, scratch, out) / 3;
}

/// Triangles that the selection draws.
uint64_t drawnTriangles(const Stage& stage, const Selection& selection) {
    uint64_t sum = 0;
    for (uint32_t id = 0; id < stage.scene.instanceEnd(); ++id) {
        if (!stage.scene.hasInstance(id)) continue;
        const AssetView& asset = *stage.scene.asset(stage.scene.assetOf(id)).asset;
        const std::vector<uint8_t> levels = levelsOf(stage, selection, id);
        for (uint32_t p = 0; p < levels.size(); ++p) {
            if (selection.kind(id) == InstanceKind::whole || selection.visible(id)[p]) {
                sum += triangles(asset, p, levels);
            }
        }
    }
    return sum;
}

glm::mat4 lookFrom(const glm::vec3& eye, const glm::vec3& target) {
    return glm::perspectiveRH_ZO(1.0f, 1.5f, 0.1f, 1000.0f) * glm::lookAt(eye, target, glm::vec3(0, 1, 0));
}

} // namespace

TEST_CASE("without culling, controls and hysteresis a selection is what select gives, to the bit") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    Random random(1);
    const std::vector<float> bands = {0.5f, 1, 2, 4};
    std::vector<uint8_t> expected(asset.patchCount());
    for (int i = 0; i < 500; ++i) {
        const Placement placement = random.placement(5);
        stage.scene.setPlacement(id, placement);
        SelectionDesc desc;
        desc.view = viewFrom(random.point(40), i % 3 == 0 ? 0.5f : 0.0f);
        if (i % 5 == 0)
            desc.view = makeOrthographicView(random.point(9), random.direction(), random.between(1, 900), 512);
        desc.wholeBeyond = std::numeric_limits<float>::infinity();
        desc.pixels = random.between(0, 4);
        select(asset, placement, desc.view, ErrorPixels{desc.pixels}, expected);
        stage.selection.update(stage.scene, desc);
        CHECK(levelsOf(stage, stage.selection, id) == expected);
        desc.policy = Policy::distanceBands;
        desc.bands = bands;
        desc.wholeBeyond = SelectionDesc{}.wholeBeyond; // whole states know no bands
        select(asset, placement, desc.view, DistanceBands{bands}, expected);
        stage.selection.update(stage.scene, desc);
        CHECK(levelsOf(stage, stage.selection, id) == expected);
    }
}

TEST_CASE("a view that asks for the same again chooses what it would choose otherwise, to the bit") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t asset0 = stage.add(asset);
    Random random(21);
    std::vector<uint32_t> ids;
    for (int i = 0; i < 12; ++i) ids.push_back(stage.place(asset0, random.placement(9)));
    Selection asksAnew;
    REQUIRE(asksAnew.create(stage.config).ok());
    uint64_t kept = 0, changed = 0, culled = 0;
    glm::vec3 eye(0, 0, 30);
    SelectionDesc desc;
    for (int i = 0; i < 1500; ++i) {
        // Small steps, and leaps now and then; something else asked for, now and then.
        eye = i % 97 == 0 ? random.point(40) : eye + random.point(i % 2 ? 0.5f : 0.02f);
        if (i % 150 == 0) {
            desc.pixels = i % 600 == 450 ? 0 : random.between(0.2f, 3);
            desc.hysteresis = i % 300 == 0 ? 0.0f : 0.1f;
            desc.cullBackfaces = i % 450 != 0;
        }
        if (i % 31 == 0) stage.scene.setPlacement(ids[random.below(12)], random.placement(9));
        if (i % 53 == 0) REQUIRE(stage.scene.setPart(ids[0], random.below(36), {.importance = 2}).ok());
        if (i % 53 == 26) stage.scene.clearParts(ids[0]);
        desc.view = viewFrom(eye);
        stage.selection.update(stage.scene, desc);
        desc.view.nearest = i % 2 ? 1e-30f : 0.0f; // another wish, and nothing that it changes
        asksAnew.update(stage.scene, desc);
        for (const uint32_t id : ids) {
            REQUIRE(stage.selection.kind(id) == asksAnew.kind(id));
            REQUIRE(levelsOf(stage, stage.selection, id) == levelsOf(stage, asksAnew, id));
            if (asksAnew.kind(id) != InstanceKind::mixed) continue;
            const std::span<const uint8_t> one = stage.selection.visible(id), other = asksAnew.visible(id);
            REQUIRE(std::equal(one.begin(), one.end(), other.begin(), other.end()));
        }
        kept += stage.selection.stats().consideredPatches - stage.selection.stats().changedPatches;
        changed += stage.selection.stats().changedPatches;
        culled += stage.selection.stats().culledPatches;
    }
    CHECK(kept > 100000);
    CHECK(changed > 1000);
    CHECK(culled > 500);
}

TEST_CASE("with error-pixels P no patch projects to more than P, near or far, whatever happened before") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    Random random(2);
    uint32_t whole = 0, mixed = 0;
    for (int i = 0; i < 4000; ++i) {
        const Placement placement = random.placement(3);
        stage.scene.setPlacement(id, placement);
        SelectionDesc desc;
        desc.view = viewFrom(random.direction() * std::exp(random.between(0, 6)), 0.01f);
        desc.pixels = random.between(0.25f, 8);
        desc.hysteresis = i % 4 == 0 ? 0.0f : 0.1f;
        stage.selection.update(stage.scene, desc);
        (stage.selection.kind(id) == InstanceKind::whole ? whole : mixed) += 1;
        const std::vector<uint8_t> levels = levelsOf(stage, stage.selection, id);
        for (uint32_t p = 0; p < levels.size(); ++p) {
            CHECK(projected(asset, placement, desc.view, p, levels[p]) <= double(desc.pixels) * 1.001);
        }
    }
    CHECK(whole > 100);
    CHECK(mixed > 100);
}

TEST_CASE("a far instance is decided as a whole, in the coarsest state that fits") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    const float radius = asset.record->sphereRadius;
    for (float radii = 2; radii < 2000; radii *= 1.2f) {
        SelectionDesc desc;
        desc.view = viewFrom({radii * radius, 0, 0});
        stage.selection.update(stage.scene, desc);
        const bool far = radii > 6;
        REQUIRE((stage.selection.kind(id) == InstanceKind::whole) == far);
        CHECK(stage.selection.stats().wholeInstances == (far ? 1 : 0));
        CHECK(stage.selection.stats().consideredPatches == (far ? 0 : asset.patchCount()));
        if (!far) continue;
        // The next state would break the bound at the near side of the asset.
        const uint32_t state = stage.selection.wholeState(id), kind = stage.scene.assetOf(id);
        const auto covers = [&](float error) {
            return double(error) * double(desc.view.pixelsPerUnit) / double(radii * radius - radius);
        };
        CHECK(covers(stage.scene.wholeError(kind, state)) <= 1.001 * double(desc.pixels));
        if (state + 1 < stage.scene.wholeStateCount(kind)) {
            CHECK(covers(stage.scene.wholeError(kind, state + 1)) > 0.999 * double(desc.pixels));
        }
    }
    // Steered parts are chosen one by one.
    REQUIRE(stage.scene.setPart(id, 3, {.importance = 2}).ok());
    SelectionDesc desc;
    desc.view = viewFrom({100, 0, 0});
    stage.selection.update(stage.scene, desc);
    CHECK(stage.selection.kind(id) == InstanceKind::mixed);
    stage.scene.clearParts(id);
    stage.selection.update(stage.scene, desc);
    CHECK(stage.selection.kind(id) == InstanceKind::whole);
}

TEST_CASE("parts are steered: importance, bias, limits, pins, hiding, by name or stable id") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    const uint32_t part = findPart(asset, "part7");
    REQUIRE(part != format::kNone);
    CHECK(findPart(asset, asset.parts[part].stableId) == part);
    CHECK(findPart(asset, "nothing") == format::kNone);
    const uint32_t patch = asset.parts[part].firstPatch;

    SelectionDesc desc;
    desc.wholeBeyond = std::numeric_limits<float>::infinity();
    const auto levels = [&](float distance) {
        desc.view = viewFrom({0, 0, distance});
        stage.selection.update(stage.scene, desc);
        return levelsOf(stage, stage.selection, id);
    };
    std::vector<std::vector<uint8_t>> free;
    std::vector<float> distances;
    for (float d = 2; d < 3000; d *= 1.3f) distances.push_back(d);
    for (const float d : distances) free.push_back(levels(d));

    const auto steeredLevels = [&](const PartControl& control) {
        REQUIRE(stage.scene.setPart(id, part, control).ok());
        std::vector<int> own;
        for (size_t i = 0; i < distances.size(); ++i) {
            std::vector<uint8_t> now = levels(distances[i]);
            own.push_back(now[patch]);
            now[patch] = free[i][patch];
            CHECK(now == free[i]); // nothing else changes
        }
        return own;
    };
    const int last = int(asset.levelCount()) - 1;
    const std::vector<int> important = steeredLevels({.importance = 4}), coarser = steeredLevels({.bias = 2}),
                           finer = steeredLevels({.bias = -1}), limited = steeredLevels({.finest = 1, .coarsest = 2}),
                           pinned = steeredLevels(PartControl::pinned(3)), past = steeredLevels({.finest = 99});
    uint32_t refined = 0;
    for (size_t i = 0; i < distances.size(); ++i) {
        const int own = free[i][patch];
        CHECK(coarser[i] == std::min(own + 2, last));
        CHECK(finer[i] == std::max(own - 1, 0));
        CHECK(limited[i] == std::clamp(own, 1, 2));
        CHECK(pinned[i] == 3);
        CHECK(past[i] == last);
        // Four times the importance is a quarter of the pixels.
        CHECK(important[i] <= own);
        refined += important[i] < own;
        desc.pixels = 0.25f;
        REQUIRE(stage.scene.setPart(id, part, {}).ok());
        CHECK(levels(distances[i])[patch] == important[i]);
        desc.pixels = 1;
    }
    CHECK(refined > 3);

    REQUIRE(stage.scene.setPart(id, part, {.hidden = true}).ok());
    levels(4);
    for (uint32_t p = 0; p < asset.patchCount(); ++p) CHECK(stage.selection.visible(id)[p] == (p != patch));
}

TEST_CASE("while the eye jitters within the amplitude no patch changes its level more than once") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t asset0 = stage.add(asset);
    std::vector<uint32_t> ids;
    Random random(3);
    for (int i = 0; i < 12; ++i) ids.push_back(stage.place(asset0, random.placement(8)));
    constexpr float kHysteresis = 0.1f;
    uint32_t changedOnce = 0, wholeChanges = 0;
    for (int walk = 0; walk < 400; ++walk) {
        SelectionDesc desc;
        desc.hysteresis = kHysteresis;
        desc.policy = walk % 3 == 0 ? Policy::distanceBands : Policy::errorPixels;
        const std::vector<float> bands = {1, 2, 3, 5};
        desc.bands = bands;
        // A state with a history: fly somewhere first.
        const glm::vec3 stand = random.direction() * std::exp(random.between(1.5f, 5));
        for (float t = 4; t > 1; t -= 0.2f) {
            desc.view = viewFrom(stand * (walk % 2 ? t : 1 / t));
            stage.selection.update(stage.scene, desc);
        }
        // Distances to the bounds of what may change stay within a factor of 1 - h of one another.
        const auto nearest = [&](const Placement& placement, const glm::vec4& sphere) {
            return glm::length(placement.toWorld * glm::vec4(glm::vec3(sphere), 1) - stand) -
                   placement.maxScale * sphere.w;
        };
        const float amplitude = 0.02f * glm::length(stand);
        std::vector<std::vector<uint8_t>> before(ids.size());
        std::vector<std::vector<uint32_t>> changes(ids.size(), std::vector<uint32_t>(asset.patchCount()));
        std::vector<InstanceKind> kinds(ids.size());
        for (int frame = 0; frame < 60; ++frame) {
            desc.view = viewFrom(stand + amplitude * random.between(0, 1) * random.direction());
            stage.selection.update(stage.scene, desc);
            for (size_t i = 0; i < ids.size(); ++i) {
                const std::vector<uint8_t> now = levelsOf(stage, stage.selection, ids[i]);
                if (frame > 0) {
                    for (uint32_t p = 0; p < now.size(); ++p) changes[i][p] += now[p] != before[i][p];
                    wholeChanges += kinds[i] != stage.selection.kind(ids[i]);
                }
                before[i] = now;
                kinds[i] = stage.selection.kind(ids[i]);
            }
        }
        for (size_t i = 0; i < ids.size(); ++i) {
            const Placement& placement = stage.scene.placement(ids[i]);
            for (uint32_t p = 0; p < asset.patchCount(); ++p) {
                const format::PatchRecord& r = asset.patches[p];
                const float d =
                    nearest(placement, {r.sphereCenter[0], r.sphereCenter[1], r.sphereCenter[2], r.sphereRadius});
                const float whole = nearest(
                    placement, {r.sphereCenter[0], r.sphereCenter[1], r.sphereCenter[2], asset.record->sphereRadius});
                if ((std::min(d, whole) - amplitude) < (1 - kHysteresis) * (std::min(d, whole) + amplitude)) continue;
                CHECK(changes[i][p] <= 1);
                changedOnce += changes[i][p] == 1;
            }
        }
    }
    CHECK(changedOnce > 1000);
    CHECK(wholeChanges > 3);
}

TEST_CASE("the frustum culls only what no pixel shows") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    Random random(4);
    uint32_t culled = 0, shown = 0, gone = 0;
    for (int i = 0; i < 400; ++i) {
        stage.scene.setPlacement(id, random.placement(4));
        const glm::vec3 eye = random.point(9);
        const glm::mat4 clip = lookFrom(eye, random.point(9));
        SelectionDesc desc;
        desc.view = viewFrom(eye);
        desc.frustum = makeFrustum(clip);
        stage.selection.update(stage.scene, desc);
        const std::vector<uint8_t> levels = levelsOf(stage, stage.selection, id);
        std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
        const std::vector<uint8_t> finest(asset.patchCount(), 0);
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            const bool visible =
                !levels.empty() && (stage.selection.kind(id) == InstanceKind::whole || stage.selection.visible(id)[p]);
            gone += levels.empty();
            if (visible) {
                ++shown;
                continue;
            }
            ++culled;
            if (!levels.empty()) CHECK(levels[p] == asset.levelCount() - 1);
            indices.resize(indexCapacity(asset, p, finest));
            indices.resize(buildIndices(asset, p, finest, scratch, indices));
            for (const uint32_t row : indices) {
                const glm::vec4 at =
                    clip * glm::vec4(stage.scene.placement(id).toWorld * glm::vec4(asset.positions[row], 1), 1);
                const bool inside = std::fabs(at.x) < at.w && std::fabs(at.y) < at.w && at.z > 0 && at.z < at.w;
                CHECK_FALSE(inside);
            }
        }
    }
    CHECK(culled > 1000);
    CHECK(shown > 1000);
    CHECK(gone > 100);
}

TEST_CASE("a frustum has the far plane only where the projection has one") {
    CHECK(makeFrustum(glm::perspectiveRH_ZO(1.0f, 1.0f, 0.1f, 10.0f)).planeCount == 6);
    glm::mat4 infinite(0); // reversed, no far plane
    infinite[0][0] = infinite[1][1] = 1;
    infinite[2][3] = -1;
    infinite[3][2] = 0.1f;
    const Frustum frustum = makeFrustum(infinite);
    CHECK(frustum.planeCount == 5);
    for (const glm::vec3& inside : {glm::vec3(0, 0, -1), glm::vec3(0, 0, -1e6f), glm::vec3(0.9f, 0.9f, -1)}) {
        for (uint32_t i = 0; i < frustum.planeCount; ++i) {
            CHECK(glm::dot(glm::vec3(frustum.planes[i]), inside) + frustum.planes[i].w > 0);
        }
    }
    CHECK(frustum.planes[4].w < 0); // nothing nearer than the near plane
}

TEST_CASE("cones cull only patches whose every triangle faces away") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    Random random(5);
    uint32_t culled = 0;
    for (int i = 0; i < 400; ++i) {
        stage.scene.setPlacement(id, random.placement(4));
        SelectionDesc desc;
        const bool orthographic = i % 4 == 0;
        desc.view = orthographic ? makeOrthographicView(random.point(20), random.direction(), 40, 512)
                                 : viewFrom(random.point(20));
        desc.cullBackfaces = true;
        desc.wholeBeyond = std::numeric_limits<float>::infinity();
        stage.selection.update(stage.scene, desc);
        const Placement& placement = stage.scene.placement(id);
        const float mirrored = glm::determinant(glm::mat3(placement.toWorld)) < 0 ? -1.0f : 1.0f;
        const std::vector<uint8_t> levels = levelsOf(stage, stage.selection, id);
        std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            if (stage.selection.visible(id)[p]) continue;
            ++culled;
            indices.resize(indexCapacity(asset, p, levels));
            indices.resize(buildIndices(asset, p, levels, scratch, indices));
            for (size_t k = 0; k + 2 < indices.size(); k += 3) {
                const auto at = [&](size_t c) {
                    return placement.toWorld * glm::vec4(asset.positions[indices[k + c]], 1);
                };
                const glm::vec3 a = at(0), normal = mirrored * glm::cross(at(1) - a, at(2) - a);
                const glm::vec3 sight = orthographic ? desc.view.forward : a - desc.view.eye;
                CHECK(glm::dot(normal, sight) >= -1e-4f * glm::length(normal) * glm::length(sight));
            }
        }
    }
    CHECK(culled > 500);
}

TEST_CASE("contribution culls what covers less than the pixels") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    SelectionDesc desc;
    desc.contributionPixels = 10;
    const auto covers = [&](float radius, float distance) { return radius * desc.view.pixelsPerUnit / distance; };
    for (float d = 20; d < 5000; d *= 1.1f) {
        desc.view = viewFrom({0, 0, d});
        stage.selection.update(stage.scene, desc);
        const float whole = covers(asset.record->sphereRadius, d);
        if (whole < 9.9f) CHECK(stage.selection.kind(id) == InstanceKind::culled);
        if (whole > 10.1f) CHECK(stage.selection.kind(id) != InstanceKind::culled);
    }
}

TEST_CASE("a shadow is never coarser than told, and never changes the main view") {
    Random random(6);
    uint32_t held = 0;
    Stage stage, alone;
    const AssetView& asset = torus().view;
    const uint32_t ours = stage.add(asset), theirs = alone.add(asset);
    std::vector<uint32_t> ids;
    for (int i = 0; i < 20; ++i) {
        const Placement placement = random.placement(60);
        ids.push_back(stage.place(ours, placement));
        alone.place(theirs, placement);
    }
    REQUIRE(stage.scene.setPart(ids[0], 2, {.importance = 3, .bias = 1}).ok());
    REQUIRE(alone.scene.setPart(ids[0], 2, {.importance = 3, .bias = 1}).ok());
    Selection shadow;
    REQUIRE(shadow.create(stage.config).ok());
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 eye = random.point(70), target = random.point(70);
        SelectionDesc main;
        main.view = viewFrom(eye);
        main.frustum = makeFrustum(lookFrom(eye, target));
        main.hysteresis = 0.1f;
        stage.selection.update(stage.scene, main);
        alone.selection.update(alone.scene, main);
        SelectionDesc cast;
        cast.view = makeOrthographicView(random.point(90), random.direction(), 100, 512);
        cast.pixels = 4;
        cast.reference = &stage.selection;
        cast.coarserThanReference = i % 3;
        shadow.update(stage.scene, cast);
        for (const uint32_t id : ids) {
            const std::vector<uint8_t> own = levelsOf(stage, stage.selection, id);
            CHECK(own == levelsOf(alone, alone.selection, id));
            const std::vector<uint8_t> cheap = levelsOf(stage, shadow, id);
            REQUIRE(!cheap.empty());
            for (uint32_t p = 0; p < asset.patchCount(); ++p) {
                const bool seen =
                    !own.empty() && (stage.selection.kind(id) == InstanceKind::whole || stage.selection.visible(id)[p]);
                uint32_t there = own.empty() ? 0 : own[p];
                if (!seen) {
                    // What the main view would choose without a history.
                    const Placement& placement = stage.scene.placement(id);
                    there = asset.levelCount() - 1;
                    while (projected(asset, placement, main.view, p, there) > 1.001 * double(main.pixels)) --there;
                    if (id == ids[0]) continue; // steered
                }
                CHECK(cheap[p] <= there + cast.coarserThanReference);
                held += cheap[p] == there + cast.coarserThanReference;
            }
        }
    }
    CHECK(held > 1000);
}

TEST_CASE("a budget of triangles is never exceeded, and its pixels are near the least that any choice could hold") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t kind = stage.add(asset);
    Random random(7);
    for (int i = 0; i < 10; ++i) stage.place(kind, random.placement(20));
    REQUIRE(stage.scene.setPart(2, 5, {.importance = 5, .coarsest = 2}).ok());
    uint32_t raised = 0, over = 0, kept = 0;
    for (int i = 0; i < 300; ++i) {
        SelectionDesc desc;
        const glm::vec3 eye = random.point(30);
        desc.view = viewFrom(eye, 0.05f);
        if (i % 2) desc.frustum = makeFrustum(lookFrom(eye, random.point(20)));
        desc.cullBackfaces = i % 3 == 0;
        desc.hysteresis = i % 5 == 0 ? 0.1f : 0.0f;
        desc.triangleBudget = uint32_t(std::exp(random.between(4, 12)));
        desc.boundPixels = true;
        stage.selection.update(stage.scene, desc);
        const SelectionStats& stats = stage.selection.stats();
        const uint64_t drawn = drawnTriangles(stage, stage.selection);
        CHECK(drawn <= stats.triangleBound);
        if (stats.overBudget) {
            ++over;
            CHECK(stats.triangleBound > desc.triangleBudget);
            for (uint32_t id = 0; id < stage.scene.instanceEnd(); ++id) {
                if (stage.selection.kind(id) != InstanceKind::mixed) continue;
                for (uint32_t p = 0; p < asset.patchCount(); ++p) {
                    const bool limited = id == 2 && asset.patches[p].part == 5;
                    const bool coarsest = stage.selection.levels(id)[p] == asset.levelCount() - 1;
                    CHECK((limited || coarsest));
                }
            }
            continue;
        }
        CHECK(drawn <= desc.triangleBudget);
        CHECK(stats.pixels >= desc.pixels * 0.999f * (1 - desc.hysteresis) * (1 - desc.hysteresis));
        raised += stats.pixels > desc.pixels;
        kept += stats.pixels == desc.pixels;
        if (desc.hysteresis == 0) CHECK(stats.pixelsBound <= stats.pixels);
    }
    CHECK(raised > 50);
    CHECK(kept > 20);
    CHECK(over > 20);
}

TEST_CASE("a budget's choice is the best of all choices, but for the bound of the triangles") {
    const test::ToyAsset& toy = test::plain();
    REQUIRE(toy.error == "");
    const AssetView& asset = toy.asset;
    Stage stage;
    const uint32_t id = stage.place(stage.add(asset), {});
    const uint32_t patchCount = asset.patchCount(), levelCount = asset.levelCount();
    Random random(8);
    uint32_t exact = 0, checked = 0;
    for (int i = 0; i < 60; ++i) {
        SelectionDesc desc;
        desc.view = viewFrom(random.direction() * random.between(1.5f, 6), 0.05f);
        desc.pixels = 0.01f;
        desc.wholeBeyond = std::numeric_limits<float>::infinity();
        desc.triangleBudget = 20 + random.below(asset.record->faceCount);
        desc.boundPixels = true;
        stage.selection.update(stage.scene, desc);
        // Every state: the largest error on screen against what it draws and what it is bounded by.
        double best = kInfinity, bestBounded = kInfinity;
        std::vector<uint8_t> levels(patchCount, 0);
        for (bool more = true; more;) {
            double error = 0;
            uint64_t drawn = 0, bound = 0;
            for (uint32_t p = 0; p < patchCount; ++p) {
                error = std::max(error, projectedBySphere(asset, {}, desc.view, p, levels[p]));
                drawn += triangles(asset, p, levels);
                bound += triangleBound(asset, p, levels);
            }
            CHECK(drawn <= bound);
            error = std::max(error, double(desc.pixels));
            if (drawn <= desc.triangleBudget) best = std::min(best, error);
            if (bound <= desc.triangleBudget) bestBounded = std::min(bestBounded, error);
            more = false;
            for (uint32_t p = 0; p < patchCount && !more; ++p) {
                more = ++levels[p] < levelCount;
                if (!more) levels[p] = 0;
            }
        }
        const SelectionStats& stats = stage.selection.stats();
        CHECK(stats.overBudget == std::isinf(bestBounded));
        if (stats.overBudget) continue;
        ++checked;
        double error = double(desc.pixels);
        const std::vector<uint8_t> chosen = levelsOf(stage, stage.selection, id);
        for (uint32_t p = 0; p < patchCount; ++p)
            error = std::max(error, projectedBySphere(asset, {}, desc.view, p, chosen[p]));
        CHECK(error <= bestBounded * 1.01);
        CHECK(error >= best * 0.999);
        CHECK(double(stats.pixelsBound) <= best * 1.001);
        exact += error <= best * 1.01;
    }
    CHECK(checked > 30);
    CHECK(exact * 2 > checked);
}

TEST_CASE("jobs on any threads give the same levels and statistics") {
    struct Threads {
        static void run(void*, uint32_t count, void (*job)(void*, uint32_t), void* data) {
            std::atomic<uint32_t> next{0};
            std::vector<std::thread> threads;
            for (int t = 0; t < 3; ++t) {
                threads.emplace_back([&] {
                    for (uint32_t i = next++; i < count; i = next++) job(data, i);
                });
            }
            for (std::thread& t : threads) t.join();
        }
    };
    SceneConfig config;
    config.instanceCapacity = 500;
    config.patchCapacity = 500 * torus().view.patchCount();
    Stage stage(config);
    Selection threaded;
    REQUIRE(threaded.create(config).ok());
    const uint32_t kind = stage.add(torus().view);
    Random random(9);
    for (int i = 0; i < 500; ++i) stage.place(kind, random.placement(80));
    for (int i = 0; i < 20; ++i) {
        SelectionDesc desc;
        desc.view = viewFrom(random.point(80), 0.1f);
        desc.hysteresis = 0.05f;
        desc.frustum = makeFrustum(lookFrom(desc.view.eye, random.point(80)));
        if (i % 4 == 3) desc.triangleBudget = 50000;
        stage.selection.update(stage.scene, desc);
        desc.jobs.run = &Threads::run;
        threaded.update(stage.scene, desc);
        for (uint32_t id = 0; id < 500; ++id) {
            REQUIRE(stage.selection.kind(id) == threaded.kind(id));
            CHECK(levelsOf(stage, stage.selection, id) == levelsOf(stage, threaded, id));
        }
        CHECK(stage.selection.stats().consideredPatches == threaded.stats().consideredPatches);
        CHECK(stage.selection.stats().changedPatches == threaded.stats().changedPatches);
        CHECK(stage.selection.stats().triangleBound == threaded.stats().triangleBound);
    }
}

TEST_CASE("updates, and changes of a scene, allocate nothing") {
    Stage stage;
    const uint32_t kind = stage.add(torus().view);
    Random random(10);
    std::vector<Placement> placements;
    for (int i = 0; i < 20; ++i) placements.push_back(random.placement(30));
    for (int i = 0; i < 10; ++i) stage.place(kind, placements[size_t(i)]);
    const uint64_t before = test::allocations;
    bool ok = true;
    for (int i = 0; i < 100; ++i) {
        uint32_t id = 0;
        ok &= stage.scene.addInstance(kind, placements[size_t(i) % 20], id).ok();
        ok &= stage.scene.setPart(id, uint32_t(i) % 36, {.bias = 1}).ok();
        SelectionDesc desc;
        desc.view = viewFrom(random.point(30), 0.1f);
        desc.triangleBudget = i % 2 ? 1000 : 0;
        stage.selection.update(stage.scene, desc);
        stage.scene.removeInstance(id);
    }
    CHECK(test::allocations == before);
    CHECK(ok);
}

TEST_CASE("a new instance under an old id starts afresh") {
    Stage stage;
    const uint32_t kind = stage.add(torus().view);
    uint32_t id = stage.place(kind, makePlacement(glm::translate(glm::mat4(1), glm::vec3(500, 0, 0))));
    SelectionDesc desc;
    desc.view = viewFrom({0, 0, 0});
    desc.hysteresis = 0.5f; // a level that was chosen would stay
    stage.selection.update(stage.scene, desc);
    CHECK(stage.selection.kind(id) == InstanceKind::whole);
    stage.scene.removeInstance(id);
    const uint32_t again = stage.place(kind, makePlacement(glm::translate(glm::mat4(1), glm::vec3(8, 0, 0))));
    REQUIRE(again == id);
    CHECK(stage.selection.kind(id) == InstanceKind::culled); // not known yet
    stage.selection.update(stage.scene, desc);
    const std::vector<uint8_t> levels = levelsOf(stage, stage.selection, id);
    Stage fresh;
    const uint32_t same = fresh.place(fresh.add(torus().view), stage.scene.placement(id));
    fresh.selection.update(fresh.scene, desc);
    CHECK(levels == levelsOf(fresh, fresh.selection, same));
}

TEST_CASE("a host's own levels are taken as they are") {
    Stage stage;
    const AssetView& asset = torus().view;
    const uint32_t id = stage.place(stage.add(asset), {});
    std::vector<uint8_t> own(asset.patchCount());
    for (uint32_t p = 0; p < own.size(); ++p) own[p] = uint8_t(p % asset.levelCount());
    stage.selection.set(stage.scene, id, own);
    CHECK(levelsOf(stage, stage.selection, id) == own);
}

TEST_CASE("an instance that is made invisible is culled, and comes back as it was") {
    Stage stage;
    const uint32_t id = stage.place(stage.add(torus().view), {});
    SelectionDesc desc;
    desc.view = viewFrom({0, 0, 9});
    stage.selection.update(stage.scene, desc);
    const std::vector<uint8_t> before = levelsOf(stage, stage.selection, id);
    stage.scene.setVisible(id, false);
    stage.selection.update(stage.scene, desc);
    CHECK(stage.selection.kind(id) == InstanceKind::culled);
    CHECK(stage.selection.stats().visibleInstances == 0);
    stage.scene.setVisible(id, true);
    stage.selection.update(stage.scene, desc);
    CHECK(levelsOf(stage, stage.selection, id) == before);
}

TEST_CASE("what does not fit a scene is refused with the setting's name") {
    const AssetView& asset = torus().view;
    const auto refused = [](const Status& status, std::string_view setting) {
        return status.code == StatusCode::outOfCapacity &&
               std::string_view(status.message).find(setting) != std::string_view::npos;
    };
    Stage stage({.assetCapacity = 1,
                 .instanceCapacity = 2,
                 .assetPatchCapacity = 40,
                 .patchCapacity = 40,
                 .steeredPartCapacity = 40});
    uint32_t id = 77;
    Scene small;
    REQUIRE(small.create({.assetPatchCapacity = 35}).ok());
    CHECK(refused(small.addAsset({.asset = &asset}, id), "assetPatchCapacity"));
    const uint32_t kind = stage.add(asset);
    CHECK(refused(stage.scene.addAsset({.asset = &asset}, id), "assetCapacity"));
    CHECK(id == 77);
    const uint32_t first = stage.place(kind, {});
    CHECK(refused(stage.scene.addInstance(kind, {}, id), "patchCapacity"));
    REQUIRE(stage.scene.setPart(first, 0, {}).ok());
    stage.scene.removeInstance(first);
    CHECK_FALSE(stage.scene.hasInstance(first));
    const uint32_t second = stage.place(kind, {});
    CHECK(stage.scene.part(second, 0).bias == 0);
    REQUIRE(stage.scene.setPart(second, 0, {.bias = 3}).ok()); // the first one's controls are free again
    CHECK(stage.scene.part(second, 0).bias == 3);
    stage.scene.removeInstance(second);
    stage.scene.removeAsset(kind);
    CHECK(stage.add(asset) == kind);
    CHECK(refused(Scene().create({.assetCapacity = 0}), "") == false);
}
