#include "meshes/baked_model.h"
#include "verify/nearest.h"

#include <xgc/selection.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <random>

// Selection's promise against the truth: points of what is drawn, and how far they lie from the model as it was made,
// seen from the eye.

namespace {

using namespace xgc;

/// E of a patch and its neighbours bounds what it draws up to this (FORMAT.md).
constexpr double kMargin = 1.05;

const test::BakedModel& creature() {
    static const test::BakedModel model(bake::BundledModel::creature, 6000, 250);
    REQUIRE(model.failure == "");
    return model;
}

void append(const AssetView& asset, uint32_t patch, Levels levels, std::vector<glm::uvec3>& to) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out(indexCapacity(asset, patch, levels));
    const uint32_t count = buildIndices(asset, patch, levels, scratch, out);
    for (uint32_t i = 0; i + 2 < count; i += 3) to.emplace_back(out[i], out[i + 1], out[i + 2]);
}

std::vector<glm::vec3> positions(const AssetView& asset) {
    return {asset.positions.begin(), asset.positions.end()};
}

} // namespace

TEST_CASE("with error-pixels P nothing that is drawn lies farther than P from the input, on screen") {
    const AssetView& asset = creature().view;
    REQUIRE(asset.patchCount() > 20);
    std::vector<glm::uvec3> input;
    const std::vector<uint8_t> finest(asset.patchCount(), 0);
    for (uint32_t p = 0; p < asset.patchCount(); ++p) append(asset, p, finest, input);
    const bake::Nearest truth(positions(asset), input);

    Scene scene;
    Selection selection;
    REQUIRE(scene.create({}).ok());
    REQUIRE(selection.create({}).ok());
    uint32_t kind = 0, id = 0;
    REQUIRE(scene.addAsset({.asset = &asset}, kind).ok());
    REQUIRE(scene.addInstance(kind, {}, id).ok());
    const float* c = asset.record->sphereCenter;
    const glm::vec3 center(c[0], c[1], c[2]);
    const float radius = asset.record->sphereRadius;

    std::mt19937 random(4);
    const auto between = [&](float a, float b) { return a + (b - a) * float(random() % 10001u) / 10000.0f; };
    uint32_t samples = 0, beyond = 0, wholes = 0, culled = 0;
    double largest = 0;
    for (int state = 0; state < 150; ++state) {
        const glm::vec3 from = glm::normalize(glm::vec3(between(-1, 1), between(-1, 1), between(-1, 1)) + 1e-3f);
        const glm::vec3 eye = center + from * radius * std::exp(between(-0.1f, 3));
        SelectionDesc desc;
        desc.view = makeView(eye, 1, 1080);
        desc.view.nearest = 0.01f * radius;
        desc.pixels = between(0.5f, 6);
        desc.hysteresis = state % 2 ? 0.1f : 0.0f;
        desc.cullBackfaces = state % 3 == 0;
        if (state % 4 == 0) {
            desc.frustum = makeFrustum(
                glm::perspectiveRH_ZO(1.0f, 1.3f, 0.01f * radius, 100 * radius) *
                glm::lookAt(eye, center + 0.7f * radius * glm::vec3(from.y, from.z, from.x), glm::vec3(0.1f, 1, 0)));
        }
        selection.update(scene, desc);
        const InstanceKind seen = selection.kind(id);
        if (seen == InstanceKind::culled) continue;
        std::vector<uint8_t> levels(asset.patchCount());
        std::vector<glm::uvec3> drawn;
        if (seen == InstanceKind::whole) {
            scene.wholeLevels(kind, selection.wholeState(id), levels);
        } else {
            std::copy(selection.levels(id).begin(), selection.levels(id).end(), levels.begin());
        }
        wholes += seen == InstanceKind::whole;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            const bool visible = seen == InstanceKind::whole || selection.visible(id)[p];
            if (visible) append(asset, p, levels, drawn);
            culled += !visible;
        }
        for (int i = 0; i < 400 && !drawn.empty(); ++i) {
            const glm::uvec3 t = drawn[random() % drawn.size()];
            float u = between(0, 1), v = between(0, 1);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const glm::vec3 a = asset.positions[t.x], b = asset.positions[t.y], d = asset.positions[t.z];
            const glm::vec3 point = a + u * (b - a) + v * (d - a);
            const double away = std::max(double(glm::length(point - eye)), double(desc.view.nearest));
            const double pixels = truth.distance(point) * double(desc.view.pixelsPerUnit) / away;
            ++samples;
            beyond += pixels > double(desc.pixels) * kMargin;
            largest = std::max(largest, pixels / double(desc.pixels));
        }
    }
    CHECK(samples > 40'000);
    CHECK(beyond == 0);
    CHECK(largest > 0.3); // the levels do use what they are given
    CHECK(wholes > 10);
    CHECK(culled > 50);
    MESSAGE("largest deviation over the pixels asked for: " << largest);
}
