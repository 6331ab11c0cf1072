#include "counted_allocations.h"
#include "meshes/baked_model.h"
#include "meshes/patched_torus.h"
#include "random.h"

#include <xgc/draw_list.h>
#include <xgc/morph.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>

namespace {

using namespace xgc;
using test::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Steps between levels are at least an eighth: a part in n of the distance is at most 9 / n of a level.
constexpr float kLevelsPerPart = 9;

const AssetView& torus() {
    static const test::OpenAsset asset = test::openBuilt(test::patchedTorus({.patches = 6, .levels = 4}));
    REQUIRE(asset.failure == "");
    return asset.view;
}

const AssetView& creature() {
    static const test::BakedModel model(bake::BundledModel::creature, 6000, 256);
    REQUIRE(model.failure == "");
    return model.view;
}

/// One instance and a selection of it.
struct Stage {
    const AssetView& asset;
    Scene scene;
    Selection selection;
    uint32_t id = 0;

    explicit Stage(const AssetView& a, const Placement& placement = {}) : asset(a) {
        uint32_t kind = 0;
        REQUIRE(scene.create({}).ok());
        REQUIRE(selection.create({}).ok());
        REQUIRE(scene.addAsset({.asset = &asset}, kind).ok());
        REQUIRE(scene.addInstance(kind, placement, id).ok());
    }
    std::vector<float> lambdas(const Selection& of) const {
        std::vector<float> out(asset.patchCount());
        REQUIRE(of.fractions(id).size() == out.size());
        for (size_t p = 0; p < out.size(); ++p) {
            REQUIRE(of.fractions(id)[p] >= 0);
            REQUIRE(of.fractions(id)[p] <= kMaxFraction);
            out[p] = float(of.levels(id)[p]) + of.fractions(id)[p];
        }
        return out;
    }
    std::vector<float> select(const SelectionDesc& desc) {
        selection.update(scene, desc);
        return lambdas(selection);
    }
    /// From the eye to the bounds of a patch.
    double distance(const glm::vec3& eye, uint32_t patch) const {
        const format::PatchRecord& p = asset.patches[patch];
        const Placement& placement = scene.placement(id);
        const glm::dvec4 center(p.sphereCenter[0], p.sphereCenter[1], p.sphereCenter[2], 1);
        return glm::length(glm::dmat4x3(placement.toWorld) * center - glm::dvec3(eye)) -
               double(placement.maxScale) * double(p.sphereRadius);
    }
};

SelectionDesc morphing(const glm::vec3& eye, float rate = kInfinity) {
    SelectionDesc desc;
    desc.view = makeView(eye, 1, 1080);
    desc.morph = true;
    desc.morphRate = rate;
    return desc;
}

const std::vector<float> kBands = {0.5f, 1, 1, 2.5f, 4, 4.1f};

} // namespace

// Levels ------------------------------------------------------------------------------------------------------------

TEST_CASE("lambdas follow the distance without a jump, by no more than nine times its change") {
    for (const AssetView* asset : {&torus(), &creature()}) {
        Random random(1);
        double changed[2] = {};
        for (int flight = 0; flight < 12; ++flight) {
            Stage stage(*asset, random.placement(3));
            const glm::vec3 from = random.point(40), to = random.point(4);
            std::vector<float> before;
            for (int i = 0; i <= 400; ++i) {
                SelectionDesc desc = morphing(glm::mix(from, to, float(i) / 400));
                if (flight % 2) {
                    desc.policy = Policy::distanceBands;
                    desc.bands = kBands;
                }
                const std::vector<float> after = stage.select(desc);
                const glm::vec3 last = glm::mix(from, to, float(i - 1) / 400);
                for (uint32_t p = 0; p < after.size() && i > 0; ++p) {
                    const double a = stage.distance(last, p), b = stage.distance(desc.view.eye, p);
                    if (std::min(a, b) <= 0.01) continue;
                    const double part = std::abs(a - b) / std::min(a, b);
                    CHECK(std::abs(after[p] - before[p]) <= double(kLevelsPerPart) * part + 1e-3);
                    changed[flight % 2] += double(std::abs(after[p] - before[p]));
                }
                before = after;
            }
        }
        CHECK(changed[0] > 50);
        CHECK(changed[1] > 50);
    }
}

TEST_CASE("levels keep the pixels, and fractions share out what is left of them") {
    Random random(2);
    size_t between = 0;
    for (int i = 0; i < 200; ++i) {
        Stage stage(creature(), random.placement(3));
        const SelectionDesc desc = morphing(random.point(60));
        const std::vector<float> lambdas = stage.select(desc);
        for (uint32_t p = 0; p < lambdas.size(); ++p) {
            const uint32_t level = stage.selection.levels(stage.id)[p];
            const float fraction = stage.selection.fractions(stage.id)[p];
            const double away = std::max(stage.distance(desc.view.eye, p), 0.0);
            const auto projected = [&](double error) {
                return error * double(stage.scene.placement(stage.id).maxScale) * double(desc.view.pixelsPerUnit);
            };
            const double own = double(stage.asset.error(p, level));
            const double next = level + 1 < stage.asset.levelCount() ? double(stage.asset.error(p, level + 1)) : own;
            CHECK(projected(own + double(fraction) * (next - own)) <= 1.0001 * away);
            between += fraction > 0;
        }
    }
    CHECK(between > 1000);
}

TEST_CASE("no update changes a level by more than the rate, and slow views never feel it") {
    Random random(3);
    Selection free;
    REQUIRE(free.create({}).ok());
    for (const float part : {0.01f, 0.3f}) { // of the distance, an update
        Stage stage(creature());
        bool bound = false;
        std::vector<float> before;
        glm::vec3 eye(0, 0, 200);
        for (int i = 0; i < 300; ++i) {
            double nearest = 1e9;
            for (uint32_t p = 0; p < stage.asset.patchCount(); ++p) nearest = std::min(nearest, stage.distance(eye, p));
            if (nearest > 0.05) eye.z -= float(nearest) * part;
            const std::vector<float> after = stage.select(morphing(eye, 0.125f));
            free.update(stage.scene, morphing(eye));
            for (size_t p = 0; p < after.size() && i > 0; ++p) CHECK(std::abs(after[p] - before[p]) <= 0.125001f);
            bound = bound || after != stage.lambdas(free);
            before = after;
        }
        CHECK(bound == (part > 1.0f / 72));
        CHECK(stage.lambdas(free) == before); // it has caught up
    }
}

TEST_CASE("culling changes no level, so no boundary that is in sight") {
    Random random(4);
    Stage stage(creature());
    Selection other;
    REQUIRE(other.create({}).ok());
    size_t culled = 0;
    for (int i = 0; i < 100; ++i) {
        SelectionDesc desc = morphing(random.point(3));
        const std::vector<float> all = stage.select(desc);
        desc.frustum = makeFrustum(glm::perspective(0.7f, 1.5f, 0.01f, 100.0f) *
                                   glm::lookAt(desc.view.eye, random.point(1), glm::vec3(0, 1, 0.1f)));
        desc.cullBackfaces = true;
        other.update(stage.scene, desc);
        if (other.kind(stage.id) == InstanceKind::culled) continue;
        CHECK(stage.lambdas(other) == all);
        for (const uint8_t visible : other.visible(stage.id)) culled += !visible;
    }
    CHECK(culled > 200);
}

TEST_CASE("what comes into sight takes its levels at once") {
    Stage stage(creature());
    const std::vector<float> far = stage.select(morphing({0, 0, 100}, 0.125f));
    stage.scene.setVisible(stage.id, false);
    stage.selection.update(stage.scene, morphing({0, 0, 100}, 0.125f));
    stage.scene.setVisible(stage.id, true);
    const std::vector<float> near = stage.select(morphing({0, 0, 3}, 0.125f));
    Stage fresh(creature());
    CHECK(near == fresh.select(morphing({0, 0, 3}, 0.125f)));
    CHECK(near != far);
}

TEST_CASE("parts are steered smoothly, and a limit is a whole level") {
    Stage stage(creature());
    const uint32_t part = stage.asset.patches[0].part;
    const glm::vec3 eye(0, 0, 12);
    const std::vector<float> own = stage.select(morphing(eye, 0.125f));
    REQUIRE(stage.scene.setPart(stage.id, part, PartControl::pinned(2)).ok());
    std::vector<float> before = own;
    for (int i = 0; i < 300; ++i) {
        const std::vector<float> after = stage.select(morphing(eye, 0.125f));
        for (uint32_t p = 0; p < after.size(); ++p) {
            CHECK(std::abs(after[p] - before[p]) <= 0.125001f);
            if (stage.asset.patches[p].part != part) CHECK(after[p] == own[p]);
        }
        before = after;
    }
    for (uint32_t p = 0; p < before.size(); ++p) {
        if (stage.asset.patches[p].part == part) CHECK(before[p] == 2);
    }
    REQUIRE(stage.scene.setPart(stage.id, part, {.bias = 1}).ok());
    const float last = float(stage.asset.levelCount() - 1);
    for (int i = 0; i < 300; ++i) before = stage.select(morphing(eye, 0.125f));
    for (uint32_t p = 0; p < before.size(); ++p) {
        if (stage.asset.patches[p].part == part)
            CHECK(before[p] == doctest::Approx(double(std::min(own[p] + 1, last))));
    }
}

TEST_CASE("a shadow is never coarser than told relative to a main view that morphs") {
    Stage stage(creature());
    Selection shadow;
    REQUIRE(shadow.create({}).ok());
    Random random(5);
    size_t limited = 0;
    for (int i = 0; i < 100; ++i) {
        const std::vector<float> main = stage.select(morphing(random.point(6)));
        SelectionDesc desc = morphing(random.point(100));
        desc.reference = &stage.selection;
        desc.coarserThanReference = 1;
        shadow.update(stage.scene, desc);
        const std::vector<float> lambdas = stage.lambdas(shadow);
        for (size_t p = 0; p < main.size(); ++p) {
            CHECK(lambdas[p] <= main[p] + 1.0001f);
            limited += lambdas[p] >= main[p] + 0.9999f;
        }
    }
    CHECK(limited > 100);
}

TEST_CASE("an update that does not morph has no fractions, and one after it starts afresh") {
    Stage stage(creature());
    const std::vector<float> lambdas = stage.select(morphing({0, 0, 12}, 0.125f));
    SelectionDesc desc = morphing({0, 0, 3});
    desc.morph = false;
    stage.selection.update(stage.scene, desc);
    CHECK(stage.selection.fractions(stage.id).empty());
    CHECK(stage.select(morphing({0, 0, 12}, 0.125f)) == lambdas);
    std::vector<uint8_t> levels(stage.asset.patchCount(), 1);
    std::vector<float> fractions(levels.size(), 0.25f);
    stage.selection.set(stage.scene, stage.id, levels, fractions);
    CHECK(stage.lambdas(stage.selection) == std::vector<float>(levels.size(), 1.25f));
    stage.selection.set(stage.scene, stage.id, levels);
    CHECK(stage.selection.fractions(stage.id).empty());
}

TEST_CASE("updates allocate nothing") {
    Stage stage(creature());
    const uint64_t before = test::allocations;
    for (int i = 0; i < 50; ++i) stage.selection.update(stage.scene, morphing({0, 0, 20.0f / float(i + 1)}, 0.125f));
    CHECK(test::allocations == before);
}

// Draws -------------------------------------------------------------------------------------------------------------

TEST_CASE("what is drawn stands as near to the selected lambdas as its levels hold") {
    Stage stage(creature());
    const AssetView& asset = stage.asset;
    DrawList list;
    IndexCache cache;
    REQUIRE(list.create({}).ok());
    REQUIRE(cache.create({}).ok());
    REQUIRE(cache.addAsset(stage.scene.assetOf(stage.id), asset).ok());
    std::vector<std::byte> staging(1u << 20);
    size_t late = 0, behind = 0, ahead = 0, mixed = 0;
    for (int i = 0; i < 300; ++i) {
        const std::vector<float> wanted = stage.select(morphing({0, 0, 2 + 30 * std::abs(float(i % 100) - 50) / 50}));
        const bool starved = i % 4 != 0; // a whole refinement does not fit
        cache.beginFrame({staging.data(), starved ? 6000 : staging.size()});
        list.update(stage.scene, stage.selection, cache);
        cache.endFrame();
        late += list.stats().deferredInstances;
        if (list.kind(stage.id) != InstanceKind::mixed) continue;
        ++mixed;
        const Levels drawn = list.levels(stage.id);
        REQUIRE(list.fractions(stage.id).size() == wanted.size());
        for (uint32_t p = 0; p < wanted.size(); ++p) {
            const float lambda = float(drawn[p]) + list.fractions(stage.id)[p];
            CHECK(uint32_t(lambda) == drawn[p]);
            if (wanted[p] < float(drawn[p])) {
                CHECK(lambda == float(drawn[p]));
                ++behind;
            } else if (wanted[p] >= float(drawn[p]) + 1) {
                CHECK(lambda == float(drawn[p]) + kMaxFraction);
                ++ahead;
            } else {
                CHECK(lambda == wanted[p]);
            }
        }
        std::vector<float> lambdas(groupCount(asset));
        groupLambdas(asset, drawn, list.fractions(stage.id), lambdas);
        for (uint32_t d = 0; d < asset.record->domainCount; ++d) {
            CHECK(uint32_t(lambdas[d]) == domainLevel(asset, d, drawn));
        }
    }
    CHECK(mixed > 200);
    CHECK(late > 10);
    CHECK(behind > 10);
    CHECK(ahead > 10);
}

// On screen ---------------------------------------------------------------------------------------------------------

namespace {

/// The farthest that a row moved between two frames that drew it, or one of which did, beyond what the camera's own
/// motion does, in pixels; and what the promise allows for it.
struct Motion {
    double pixels = 0;
    double allowed = 0; ///< of any row in any frame
    size_t broken = 0;
};

/// Flies in by one part in 250 of the distance a frame.
Motion fly(const AssetView& asset, bool morphs) {
    constexpr float kPart = 1.0f / 250;
    Stage stage(asset);
    std::vector<MorphRow> rows(asset.record->vertexCount);
    REQUIRE(morphRows(asset, rows).ok());
    std::vector<glm::vec3> before(rows.size()), after(rows.size());
    std::vector<float> lambdas(groupCount(asset)), lambdasBefore;
    Motion motion;
    glm::vec3 eye(3, 4, 20);
    for (int i = 0; i < 500; ++i) {
        double nearest = 1e9;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) nearest = std::min(nearest, stage.distance(eye, p));
        eye -= glm::normalize(eye) * float(nearest) * kPart;
        SelectionDesc desc = morphing(eye, 0.125f);
        desc.morph = morphs;
        desc.wholeBeyond = kInfinity;
        stage.selection.update(stage.scene, desc);
        groupLambdas(asset, stage.selection.levels(stage.id), stage.selection.fractions(stage.id), lambdas);
        for (uint32_t row = 0; row < rows.size(); ++row) after[row] = morphedPosition(asset, rows, lambdas, row);
        for (uint32_t row = 0; row < rows.size() && i > 0; ++row) {
            const float lambda = std::min(lambdas[rows[row].group()], lambdasBefore[rows[row].group()]);
            if (rows[row].collapseLevel() <= uint32_t(lambda)) continue; // not drawn
            const double scale = double(desc.view.pixelsPerUnit) / (nearest * double(1 - kPart));
            const double allowed = scale * double(kLevelsPerPart * kPart * morphSpeed(asset, rows, row));
            const double moved = scale * double(glm::length(after[row] - before[row]));
            motion.pixels = std::max(motion.pixels, moved);
            motion.allowed = std::max(motion.allowed, allowed);
            motion.broken += moved > 1.01 * allowed + 1e-3;
        }
        std::swap(before, after);
        lambdasBefore = lambdas;
    }
    return motion;
}

} // namespace

TEST_CASE("along a slow flight no vertex moves by more pixels a frame than promised, and without morphs many do") {
    const Motion with = fly(creature(), true), without = fly(creature(), false);
    INFO("with: " << with.pixels << " of " << with.allowed << " pixels; without: " << without.pixels);
    MESSAGE("farthest moves");
    CHECK(with.broken == 0);
    CHECK(without.broken > 100);
    CHECK(with.pixels * 8 < without.pixels);
}

namespace {

/// Squared distance from a point to a triangle.
double distanceSquared(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const auto toSegment = [&](const glm::dvec3& s, const glm::dvec3& e) {
        const glm::dvec3 way = e - s;
        const double t = std::clamp(glm::dot(p - s, way) / std::max(glm::dot(way, way), 1e-300), 0.0, 1.0);
        return glm::dot(p - s - t * way, p - s - t * way);
    };
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double area = glm::dot(n, n);
    const bool above = area > 0 && glm::dot(glm::cross(b - a, p - a), n) >= 0 &&
                       glm::dot(glm::cross(c - b, p - b), n) >= 0 && glm::dot(glm::cross(a - c, p - c), n) >= 0;
    if (above) return glm::dot(p - a, n) * glm::dot(p - a, n) / area;
    return std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
}

struct Triangles {
    std::vector<glm::dvec3> corners;

    double distanceTo(const glm::dvec3& p) const {
        double least = 1e300;
        for (size_t i = 0; i < corners.size(); i += 3) {
            least = std::min(least, distanceSquared(p, corners[i], corners[i + 1], corners[i + 2]));
        }
        return std::sqrt(least);
    }
    /// From points of this to the other.
    double farthestFrom(const Triangles& other, Random& random) const {
        double most = 0;
        for (int i = 0; i < 300; ++i) {
            const size_t t = 3 * size_t(random.below(uint32_t(corners.size() / 3)));
            const double u = double(random.between(0, 1)), v = double(random.between(0, 1)) * (1 - u);
            const glm::dvec3 p = (1 - u - v) * corners[t] + u * corners[t + 1] + v * corners[t + 2];
            most = std::max(most, other.distanceTo(p));
        }
        return most;
    }
};

/// All patches at one lambda.
Triangles surfaceAt(const AssetView& asset, std::span<const MorphRow> rows, float lambda) {
    const auto level = uint8_t(lambda);
    const std::vector<uint8_t> levels(asset.patchCount(), level);
    const std::vector<float> fractions(levels.size(), lambda - float(level));
    std::vector<float> lambdas(groupCount(asset));
    groupLambdas(asset, levels, fractions, lambdas);
    std::vector<uint32_t> scratch(scratchCapacity(asset));
    Triangles out;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        std::vector<uint32_t> indices(indexCapacity(asset, p, levels));
        indices.resize(buildIndices(asset, p, levels, scratch, indices));
        for (const uint32_t row : indices) out.corners.emplace_back(morphedPosition(asset, rows, lambdas, row));
    }
    return out;
}

} // namespace

TEST_CASE("between two levels the surface errs by no more than a mix of their errors says") {
    const AssetView& asset = creature();
    std::vector<MorphRow> rows(asset.record->vertexCount);
    REQUIRE(morphRows(asset, rows).ok());
    const Triangles base = surfaceAt(asset, rows, 0);
    Random random(6);
    double worst = 0;
    for (uint32_t level = 2; level + 1 < asset.levelCount(); level += 3) {
        for (const float fraction : {0.25f, 0.5f, 0.75f}) {
            const Triangles drawn = surfaceAt(asset, rows, float(level) + fraction);
            const double error = std::max(drawn.farthestFrom(base, random), base.farthestFrom(drawn, random));
            const double mixed =
                double(glm::mix(asset.levels[level].maxError, asset.levels[level + 1].maxError, fraction));
            worst = std::max(worst, error / mixed);
        }
    }
    INFO("worst: " << worst);
    CHECK(worst <= 1);
    CHECK(worst > 0.2);
}
