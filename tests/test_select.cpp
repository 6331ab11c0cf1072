#include "random.h"

#include <xgc/select.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// An asset of bounds and errors alone: all that selection reads.
struct Bounds {
    xgc::format::AssetRecord record{};
    std::vector<xgc::format::PatchRecord> patches;
    std::vector<float> errors;
    xgc::AssetView view;

    Bounds(std::vector<glm::vec4> spheres, std::vector<float> levelErrors, float radius = 1) {
        record.levelCount = uint32_t(levelErrors.size());
        record.patchCount = uint32_t(spheres.size());
        record.sphereRadius = radius;
        for (const glm::vec4& s : spheres) {
            xgc::format::PatchRecord& p = patches.emplace_back();
            for (int i = 0; i < 3; ++i) p.sphereCenter[i] = s[i];
            p.sphereRadius = s.w;
            errors.insert(errors.end(), levelErrors.begin(), levelErrors.end());
        }
        view.record = &record;
        view.patches = patches;
        view.patchErrors = errors;
    }
    Bounds(const Bounds&) = delete;
};

template <typename Policy>
std::vector<uint8_t> levelsOf(const Bounds& b, const xgc::Placement& placement, const xgc::View& view,
                              const Policy& policy) {
    std::vector<uint8_t> levels(b.record.patchCount, 77);
    xgc::select(b.view, placement, view, policy, levels);
    return levels;
}

template <typename Policy>
int levelAt(const Bounds& b, glm::vec3 eye, const Policy& policy, float pixelsPerUnit = 1) {
    return levelsOf(b, xgc::Placement{}, {eye, pixelsPerUnit}, policy)[0];
}

} // namespace

TEST_CASE("makeView: a world unit at distance one covers pixelsPerUnit pixels") {
    // 90 degrees: the screen shows two units at distance one.
    const xgc::View view = xgc::makeView({1, 2, 3}, 1.57079632679f, 1000);
    CHECK(view.pixelsPerUnit == doctest::Approx(500));
    CHECK(view.eye == glm::vec3(1, 2, 3));
}

TEST_CASE("makePlacement: maxScale is the largest singular value, never below it") {
    CHECK(xgc::makePlacement(glm::mat4(1)).maxScale == 1);
    CHECK(xgc::makePlacement(glm::scale(glm::mat4(1), {2, -8, 0.5f})).maxScale == 8);
    glm::mat4 shear(1);
    shear[1].x = 1; // singular values: golden ratio and its inverse
    CHECK(xgc::makePlacement(shear).maxScale == doctest::Approx(1.6180340f).epsilon(1e-6));
    glm::mat4 flat(0); // rank one
    flat[0] = {1, 2, 2, 0};
    flat[3].w = 1;
    CHECK(xgc::makePlacement(flat).maxScale == 3);

    xgc::test::Random random(7);
    for (int i = 0; i < 2000; ++i) {
        glm::mat4 m(1);
        const float size = i % 2 ? 1e-6f : 1e6f;
        for (int c = 0; c < 4; ++c) m[c] = glm::vec4(random.point(size), c == 3 ? 1 : 0);
        const float scale = xgc::makePlacement(m).maxScale;
        // The norm is the largest stretch over all directions: climb to it by power iteration.
        glm::dvec3 v(random.point(1));
        const glm::dmat3 a(m);
        for (int k = 0; k < 200; ++k) v = glm::normalize(glm::transpose(a) * (a * v));
        const double stretch = glm::length(a * v);
        CHECK(double(scale) >= stretch * (1 - 1e-12));
        CHECK(double(scale) <= stretch * 1.01);
    }
}

TEST_CASE("distance bands: the level is the number of thresholds at or below the distance in radii") {
    // The patch's sphere has radius 1, the asset's 2: at distance x from the centre the eye is (x - 1) / 2 radii away.
    const Bounds b({{0, 0, 0, 1}}, {0, 1, 2, 3, 4}, 2);
    const std::vector<float> thresholds = {1, 2, 4};
    const xgc::DistanceBands bands{thresholds};
    CHECK(levelAt(b, {0, 0, 0}, bands) == 0);
    CHECK(levelAt(b, {2.99f, 0, 0}, bands) == 0);
    CHECK(levelAt(b, {3, 0, 0}, bands) == 1); // exactly at the threshold
    CHECK(levelAt(b, {0, 4.99f, 0}, bands) == 1);
    CHECK(levelAt(b, {0, 5, 0}, bands) == 2);
    CHECK(levelAt(b, {0, 0, 9}, bands) == 3);
    CHECK(levelAt(b, {0, 0, 1e6f}, bands) == 3);
    CHECK(levelAt(b, {1e6f, 0, 0}, xgc::DistanceBands{}) == 0);

    const std::vector<float> many(9, 0.5f);
    CHECK(levelAt(b, {2, 0, 0}, xgc::DistanceBands{many}) == 4); // not past the asset's levels
    const std::vector<float> zeros = {-1, 0, 0, 8};
    CHECK(levelAt(b, {0.1f, 0, 0}, xgc::DistanceBands{zeros}) == 3); // inside: distance 0
}

TEST_CASE("error in pixels: the coarsest level whose projected error is within the bound, equality included") {
    const Bounds b({{0, 0, 0, 2}}, {0, 1, 2, 4});
    // At distance x from the centre a level's error covers E * 8 / (x - 2) pixels.
    const xgc::ErrorPixels two{2};
    CHECK(levelAt(b, {5.99f, 0, 0}, two, 8) == 0);
    CHECK(levelAt(b, {6, 0, 0}, two, 8) == 1);
    CHECK(levelAt(b, {10, 0, 0}, two, 8) == 2);
    CHECK(levelAt(b, {17.99f, 0, 0}, two, 8) == 2);
    CHECK(levelAt(b, {0, 0, -18}, two, 8) == 3);
}

TEST_CASE("inside the bounds and for zero pixels only levels without error are drawn") {
    const Bounds some({{0, 0, 0, 2}}, {0, 0.001f, 1});
    const Bounds flat({{0, 0, 0, 2}}, {0, 0, 0, 1});
    for (const float x : {0.0f, 1.0f, 1.9f}) {
        CHECK(levelAt(some, {x, 0, 0}, xgc::ErrorPixels{100}, 500) == 0);
        CHECK(levelAt(flat, {x, 0, 0}, xgc::ErrorPixels{100}, 500) == 2);
    }
    CHECK(levelAt(some, {1e9f, 0, 0}, xgc::ErrorPixels{0}, 500) == 0);
    CHECK(levelAt(flat, {1e9f, 0, 0}, xgc::ErrorPixels{0}, 500) == 2);
    CHECK(levelAt(some, {1e9f, 0, 0}, xgc::ErrorPixels{1}, 0) == 2); // a view without size shows no error
}

TEST_CASE("squares that overflow or vanish choose the finer level") {
    const Bounds tiny({{0, 0, 0, 1e-30f}}, {0, 1e-30f});
    CHECK(levelAt(tiny, {1e-29f, 0, 0}, xgc::ErrorPixels{1}) == 0);
    const Bounds huge({{0, 0, 0, 1e25f}}, {0, 1e25f});
    CHECK(levelAt(huge, {1e30f, 0, 0}, xgc::ErrorPixels{1}) == 0);
    const Bounds usual({{0, 0, 0, 1}}, {0, 1});
    CHECK(levelAt(usual, {1e30f, 0, 0}, xgc::ErrorPixels{1}) == 1); // farther than a float's square: still far
}

TEST_CASE("levels never become finer as the eye goes away") {
    xgc::test::Random random(7);
    const std::vector<float> thresholds = {0.5f, 1, 2, 4, 8};
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 c = random.point(10);
        const Bounds b({{c, random.between(0, 3)}}, {0, 0.01f, 0.01f, 0.1f, 0.5f, 1}, 4);
        const glm::vec3 direction = glm::normalize(random.point(1) + glm::vec3(0.001f));
        int band = 0, error = 0;
        for (float d = 0.01f; d < 1e5f; d *= 1.09f) {
            const int nextBand = levelAt(b, c + d * direction, xgc::DistanceBands{thresholds});
            const int nextError = levelAt(b, c + d * direction, xgc::ErrorPixels{1.5f}, 900);
            CHECK(nextBand >= band);
            CHECK(nextError >= error);
            band = nextBand;
            error = nextError;
        }
        CHECK(band == 5);
        CHECK(error == 5);
    }
}

TEST_CASE("the pixel bound holds in double precision, and the next level breaks it") {
    xgc::test::Random random(7);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 c = random.point(20);
        const float e = random.between(1e-4f, 0.5f);
        const Bounds b({{c, random.between(0, 5)}}, {0, e, 2 * e, 4 * e, 8 * e, 16 * e});
        glm::mat4 m = glm::rotate(glm::mat4(1), random.between(0, 6), random.point(1) + glm::vec3(0.001f));
        m = glm::scale(m, glm::vec3(random.between(0.1f, 3), random.between(0.1f, 3), random.between(0.1f, 3)));
        m[3] = glm::vec4(random.point(50), 1);
        const xgc::Placement placement = xgc::makePlacement(m);
        const xgc::View view = {random.point(200), random.between(100, 2000)};
        const float pixels = random.between(0.25f, 8);
        std::vector<uint8_t> level = levelsOf(b, placement, view, xgc::ErrorPixels{pixels});

        // One part in a million of the eye's distance, against rounding.
        const glm::dvec3 center = glm::dmat4x3(m) * glm::dvec4(c, 1);
        const double d = glm::length(center - glm::dvec3(view.eye));
        const double slack = 1e-6 * (d + glm::length(glm::dvec3(m[3]) - glm::dvec3(view.eye)));
        const double s = double(placement.maxScale);
        const auto projects = [&](int l, double away) {
            return double(b.errors[size_t(l)]) * s * double(view.pixelsPerUnit) <=
                   double(pixels) * (away - s * double(b.patches[0].sphereRadius));
        };
        if (level[0] > 0) CHECK(projects(level[0], d + slack));
        if (level[0] < 5) CHECK_FALSE(projects(level[0] + 1, d - slack));
        if (level[0] > 0 && d - s * double(b.patches[0].sphereRadius) > 100 * slack)
            CHECK(double(xgc::projectedError(b.view, placement, view, level)) <= double(pixels) * 1.01);
    }
}

TEST_CASE("projectedError is the largest over the patches, infinite inside bounds that have an error") {
    const Bounds b({{0, 0, 0, 1}, {100, 0, 0, 1}}, {0, 0.5f, 1});
    const xgc::View view = {{5, 0, 0}, 8};
    const auto at = [&](std::vector<uint8_t> levels) { return xgc::projectedError(b.view, {}, view, levels); };
    CHECK(at({0, 0}) == 0);
    CHECK(at({2, 0}) == 2);
    CHECK(at({1, 2}) == 1);
    CHECK(at({0, 2}) == doctest::Approx(8.0 / 94));
    const xgc::View inside = {{0.5f, 0, 0}, 8};
    CHECK(xgc::projectedError(b.view, {}, inside, std::vector<uint8_t>{1, 0}) == kInfinity);
    CHECK(xgc::projectedError(b.view, {}, inside, std::vector<uint8_t>{0, 0}) == 0);
}

TEST_CASE("moving the eye and the asset together changes nothing") {
    xgc::test::Random random(7);
    const Bounds b({{1, 2, 3, 1}, {-4, 0, 2, 0.5f}, {0, 0, 0, 3}}, {0, 0.01f, 0.02f, 0.04f, 0.08f}, 6);
    const std::vector<float> thresholds = {1, 2, 3, 4};
    for (int i = 0; i < 2000; ++i) {
        // Multiples of 1/256 below 2^15: sums are exact.
        const auto exact = [&](float size) { return glm::round(random.point(size) * 256.0f) / 256.0f; };
        const glm::vec3 eye = exact(60), move = exact(10000);
        glm::mat4 m = glm::rotate(glm::mat4(1), random.between(0, 6), glm::vec3(1, 2, 2));
        const xgc::Placement here = xgc::makePlacement(m);
        m[3] = glm::vec4(move, 1);
        const xgc::Placement there = xgc::makePlacement(m);
        CHECK(levelsOf(b, here, {eye, 700}, xgc::ErrorPixels{1}) ==
              levelsOf(b, there, {eye + move, 700}, xgc::ErrorPixels{1}));
        CHECK(levelsOf(b, here, {eye, 700}, xgc::DistanceBands{thresholds}) ==
              levelsOf(b, there, {eye + move, 700}, xgc::DistanceBands{thresholds}));
    }
}

TEST_CASE("a non-uniform scale is never coarser than its largest axis allows") {
    const Bounds b({{0, 0, 0, 1}}, {0, 0.1f, 0.2f, 0.4f});
    for (float x = 4; x < 200; x *= 1.1f) {
        const xgc::View view = {{x, 0, 0}, 100};
        const auto at = [&](glm::vec3 scale) {
            const xgc::Placement placement = xgc::makePlacement(glm::scale(glm::mat4(1), scale));
            return levelsOf(b, placement, view, xgc::ErrorPixels{2})[0];
        };
        CHECK(at({1, 3, 1}) == at(glm::vec3(3)));
        CHECK(at({1, 3, 1}) <= at(glm::vec3(1)));
    }
}
