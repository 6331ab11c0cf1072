#include "models.h"
#include "picking.h"
#include "uniform_error.h"
#include "view_request.h"

#include "meshes/baked_model.h"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <limits>

namespace {

using namespace xgc;
using namespace xgc::viewer;

const test::BakedModel& creature() {
    static const test::BakedModel model(bake::BundledModel::creature, 3000, 256);
    return model;
}

/// An asset at one level, all of it in sight.
struct Still {
    std::vector<uint8_t> levels, visible;
    DrawnAsset drawn;

    Still(const AssetView& asset, uint8_t level, const glm::mat4& toWorld = glm::mat4(1))
        : levels(asset.patchCount(), level),
          visible(asset.patchCount(), 1), drawn{&asset, glm::mat4x3(toWorld), levels, visible} {}
};

/// The nearest triangle by looking at all of them, in double precision: distance and part.
struct Found {
    double along = std::numeric_limits<double>::infinity();
    uint32_t part = 0;
};
Found searchAll(const DrawnAsset& drawn, const Ray& ray) {
    const AssetView& asset = *drawn.asset;
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
    Found found;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        indices.resize(indexCapacity(asset, patch, drawn.levels));
        const uint32_t count = buildIndices(asset, patch, drawn.levels, scratch, indices);
        for (uint32_t i = 0; i < count && drawn.visible[patch]; i += 3) {
            glm::dvec3 p[3];
            for (uint32_t k = 0; k < 3; ++k)
                p[k] =
                    glm::dvec3(drawn.toWorld * glm::vec4(asset.positions[indices[i + k]], 1)) - glm::dvec3(ray.origin);
            const glm::dvec3 d(ray.direction);
            // The ray passes the triangle where it sees its corners turn one way.
            const double a = glm::dot(d, glm::cross(p[0], p[1])), b = glm::dot(d, glm::cross(p[1], p[2])),
                         c = glm::dot(d, glm::cross(p[2], p[0]));
            if ((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0)) continue;
            const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
            const double along = glm::dot(n, p[0]) / glm::dot(n, d);
            if (along >= 0 && along < found.along) found = {along, asset.patches[patch].part};
        }
    }
    return found;
}

uint32_t lcg(uint32_t& state) {
    return state = state * 1664525u + 1013904223u;
}

/// Triangles of what is visible, built anew, with what is not at its coarsest.
uint64_t trianglesOf(std::span<const DrawnAsset> drawn, const UniformError& uniform) {
    uint64_t sum = 0;
    for (uint32_t m = 0; m < drawn.size(); ++m) {
        const AssetView& asset = *drawn[m].asset;
        std::vector<uint8_t> levels(uniform.levels(m).begin(), uniform.levels(m).end());
        for (uint32_t patch = 0; patch < levels.size(); ++patch)
            if (!drawn[m].visible[patch]) levels[patch] = uint8_t(asset.levelCount() - 1);
        std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
        for (uint32_t patch = 0; patch < levels.size(); ++patch) {
            indices.resize(indexCapacity(asset, patch, levels));
            if (drawn[m].visible[patch]) sum += buildIndices(asset, patch, levels, scratch, indices) / 3;
        }
    }
    return sum;
}

/// Most triangles that a patch and those beside it lose where it takes its next level.
uint64_t largestStep(const AssetView& asset) {
    uint64_t largest = 0;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch)
        largest = std::max<uint64_t>(largest, uniformTriangles(asset, patch, 0));
    return largest;
}

} // namespace

TEST_CASE("a click finds the nearest triangle that is drawn, at any placement") {
    REQUIRE(creature().failure.empty());
    const glm::mat4 toWorld = glm::scale(glm::rotate(glm::translate(glm::mat4(1), {3, -1, 2}), 0.7f, {0.3f, 1, 0.2f}),
                                         glm::vec3(2, 2, -2)); // mirrored
    for (const uint8_t level : {uint8_t(0), uint8_t(4)}) {
        Still still(creature().view, level, toWorld);
        for (uint32_t patch = 0; patch < still.visible.size(); patch += 3) still.visible[patch] = 0;
        const float* c = creature().view.record->sphereCenter;
        const glm::vec3 center = still.drawn.toWorld * glm::vec4(c[0], c[1], c[2], 1);
        const float radius = 2 * creature().view.record->sphereRadius;
        vulkan::Camera camera;
        camera.target = center;
        camera.eye = center + radius * glm::vec3(1.5f, 1, 2);
        uint32_t hits = 0, seed = 5;
        for (int i = 0; i < 200; ++i) {
            const glm::vec2 place(float(lcg(seed) >> 8) / 16777216.0f, float(lcg(seed) >> 8) / 16777216.0f);
            const Ray ray = rayThrough(camera, place);
            const Found found = searchAll(still.drawn, ray);
            const std::optional<Hit> hit = pick(std::span(&still.drawn, 1), ray);
            REQUIRE(hit.has_value() == std::isfinite(found.along));
            if (!hit) continue;
            ++hits;
            CHECK(hit->along == doctest::Approx(found.along).epsilon(1e-4));
            CHECK(hit->part == found.part);
            CHECK(glm::distance(hit->position, ray.origin + hit->along * ray.direction) < 1e-3f * radius);
        }
        CHECK(hits > 10);
    }
}

TEST_CASE("of several models the nearest is found, and of none nothing") {
    const Still near(creature().view, 2, glm::translate(glm::mat4(1), {0, 0, 5}));
    const Still far(creature().view, 2);
    const DrawnAsset both[] = {far.drawn, near.drawn};
    const float* c = creature().view.record->sphereCenter;
    const std::optional<Hit> hit = pick(both, {{c[0], c[1], 50}, {0, 0, -1}});
    REQUIRE(hit);
    CHECK(hit->asset == 1);
    CHECK_FALSE(pick({}, {{0, 0, 5}, {0, 0, -1}}));
    CHECK_FALSE(pick(both, {{c[0], c[1], 50}, {0, 0, 1}}));
}

TEST_CASE("rays go through the pixels that points are drawn to") {
    vulkan::Camera camera;
    camera.eye = {1, 2, 3};
    camera.target = {-1, 0.5f, 0};
    camera.aspect = 1.7f;
    for (const glm::vec2& place : {glm::vec2(0.5f, 0.5f), glm::vec2(0.1f, 0.9f), glm::vec2(0.83f, 0.2f)}) {
        const Ray ray = rayThrough(camera, place);
        const glm::vec4 clip = camera.worldToClip() * glm::vec4(ray.origin + 4.0f * ray.direction, 1);
        CHECK(0.5f + 0.5f * clip.x / clip.w == doctest::Approx(place.x).epsilon(1e-4));
        CHECK(0.5f + 0.5f * clip.y / clip.w == doctest::Approx(place.y).epsilon(1e-4));
    }
}

TEST_CASE("one error draws as many triangles as are asked for, but for one patch's step, and each patch is within it") {
    const AssetView& asset = creature().view;
    Still still(asset, 0), other(asset, 0, glm::scale(glm::mat4(1), glm::vec3(0.5f)));
    for (uint32_t patch = 0; patch < asset.patchCount(); patch += 3) still.visible[patch] = 0;
    const DrawnAsset both[] = {still.drawn, other.drawn};
    UniformError uniform;
    uniform.create(both);
    uniform.hold(both, 0);
    const uint64_t least = uniform.triangles();
    uniform.hold(both, 1u << 30);
    const uint64_t most = uniform.triangles();
    CHECK(uniform.error() == 0);
    REQUIRE(most > 10 * least);

    uint32_t seed = 3;
    for (int i = 0; i < 40; ++i) {
        const uint64_t target = least + uint64_t(lcg(seed)) % (most - least);
        uniform.hold(both, target);
        CHECK(uniform.triangles() == trianglesOf(both, uniform));
        CHECK(uniform.triangles() <= target);
        CHECK(target - uniform.triangles() <= std::max<uint64_t>(target / 100, largestStep(asset)));
        for (uint32_t m = 0; m < 2; ++m) {
            const float error = uniform.error() / (m == 0 ? 1.0f : 0.5f);
            for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
                const uint32_t level = uniform.levels(m)[patch];
                CHECK(asset.error(patch, level) <= error * 1.00001f);
                if (level + 1 < asset.levelCount()) CHECK(asset.error(patch, level + 1) >= error * 0.99999f);
            }
        }
    }
}

TEST_CASE("the levels of one error go by the triangles alone, not by what was held before, and never cross") {
    const AssetView& asset = creature().view;
    Still still(asset, 0);
    const std::span<const DrawnAsset> drawn(&still.drawn, 1);
    UniformError up, down, jumping;
    for (UniformError* uniform : {&up, &down, &jumping}) uniform->create(drawn);
    std::vector<uint64_t> targets;
    for (uint64_t target = 100; target < asset.record->faceCount; target += 173) targets.push_back(target);
    std::vector<std::vector<uint8_t>> states;
    float error = std::numeric_limits<float>::infinity();
    for (const uint64_t target : targets) {
        up.hold(drawn, target);
        CHECK(up.error() <= error); // more triangles, less error
        error = up.error();
        states.emplace_back(up.levels(0).begin(), up.levels(0).end());
    }
    const auto same = [&](UniformError& uniform, size_t i) {
        uniform.hold(drawn, targets[i]);
        return std::equal(states[i].begin(), states[i].end(), uniform.levels(0).begin());
    };
    uint32_t seed = 9;
    for (size_t i = targets.size(); i-- > 0;) {
        CHECK(same(down, i));
        CHECK(same(jumping, lcg(seed) % targets.size()));
        if (i > 0) {
            const bool finer = std::equal(states[i].begin(), states[i].end(), states[i - 1].begin(), std::less_equal{});
            CHECK(finer);
        }
    }
}

TEST_CASE("the levels that a view asks for hold its pixels, and what the host chose is taken as it is") {
    const AssetView& asset = creature().view;
    ViewerState state;
    state.pixels = 2;
    const Area area{0, 0, 640, 480};
    const float* c = asset.record->sphereCenter;
    state.camera.focus({c[0], c[1], c[2]}, asset.record->sphereRadius, area.aspect());
    const SelectedFor view = selectedFor(state, area);

    SceneConfig config;
    Scene scene;
    Selection selection;
    REQUIRE(scene.create(config).ok());
    REQUIRE(selection.create(config).ok());
    uint32_t id = 0, instance = 0;
    REQUIRE(scene.addAsset({.asset = &asset}, id).ok());
    REQUIRE(scene.addInstance(id, makePlacement(glm::mat4(1)), instance).ok());

    selection.update(scene, selectionFor(state, view));
    REQUIRE(selection.kind(instance) == InstanceKind::mixed);
    const DrawnAsset drawn{&asset, glm::mat4x3(1), selection.levels(instance), selection.visible(instance)};
    View seen = makeView(view.camera.eye, view.camera.fovY, view.height);
    seen.nearest = view.camera.nearPlane;
    const float worst = worstErrorPixels(std::span(&drawn, 1), seen);
    CHECK(worst <= 2.001f);
    CHECK(worst > 0.5f);

    Selection own;
    REQUIRE(own.create(config).ok());
    std::vector<uint8_t> levels(asset.patchCount());
    for (uint32_t patch = 0; patch < levels.size(); ++patch) levels[patch] = uint8_t(patch % asset.levelCount());
    own.set(scene, instance, levels);
    selection.update(scene, selectionFor(view, &own));
    REQUIRE(selection.kind(instance) == InstanceKind::mixed);
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        if (selection.visible(instance)[patch]) CHECK(selection.levels(instance)[patch] == levels[patch]);
    }
}

TEST_CASE("frozen, the levels are those of the camera that was, and errors are measured from it") {
    ViewerState state;
    const Area area{0, 0, 640, 480};
    state.frozen = state.camera.camera(area.aspect());
    state.frozenHeight = 480;
    state.camera.orbit(300, 20, 480);
    const SelectedFor view = selectedFor(state, area);
    CHECK(view.camera.eye == state.frozen->eye);
    const vulkan::ViewDesc desc = viewFor(state, area, view);
    CHECK(desc.measured.eye == state.frozen->eye);
    CHECK(desc.camera.eye != state.frozen->eye);
}

TEST_CASE("models stand side by side, each at a radius of one") {
    Models models;
    for (int i = 0; i < 3; ++i) {
        LoadedFile file;
        file.name = "creature";
        file.view = creature().view;
        models.add(std::move(file));
    }
    CHECK(models.corners().size() == 24);
    for (uint32_t i = 0; i < 3; ++i) {
        const Model& model = *models.all()[i];
        const float* c = creature().view.record->sphereCenter;
        const glm::vec3 center(model.toWorld * glm::vec4(c[0], c[1], c[2], 1));
        CHECK(glm::distance(center, model.center) < 1e-5f);
        if (i > 0) CHECK(glm::distance(model.center, models.all()[i - 1]->center) >= 2);
    }
    Model& first = *models.all()[0];
    CHECK_FALSE(first.steered(0));
    first.controls[0] = PartControl::pinned(2);
    CHECK(first.steered(0));
    glm::vec3 center;
    float radius = 0;
    first.partSphere(0, center, radius);
    CHECK(radius > 0);
    CHECK(glm::distance(center, first.center) < 1.5f);
    models.remove(1);
    CHECK(models.all().size() == 2);
}
