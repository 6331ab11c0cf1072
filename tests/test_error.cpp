#include "meshes/builders.h"

#include <bake/surface_distance.h>
#include <verify/nearest.h>
#include <xgc/bake/error.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace xgc;
using namespace xgc::bake;

namespace {

/// Deterministic numbers in [-1, 1].
struct Numbers {
    uint32_t state = 1;
    float next() {
        state = state * 1664525u + 1013904223u;
        return float(state >> 8) / float(1 << 23) - 1.0f;
    }
    glm::vec3 point() {
        const float x = next(), y = next(), z = next();
        return {x, y, z};
    }
};

std::vector<Triangle> soup(uint32_t count, Numbers& numbers) {
    std::vector<Triangle> triangles;
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 center = numbers.point();
        triangles.push_back(
            {center + 0.1f * numbers.point(), center + 0.1f * numbers.point(), center + 0.1f * numbers.point()});
    }
    return triangles;
}

/// A grid of one patch in which the centre vertex, lifted by `height`, collapses at level 1 into its neighbour.
Hierarchy collapseCentre(Mesh& mesh, float height) {
    const auto at = [&](float x, float y) {
        for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
            if (mesh.positions[p].x == x && mesh.positions[p].y == y) return p;
        }
        return kNone;
    };
    const uint32_t centre = at(0.5f, 0.5f), neighbour = at(0.25f, 0.5f);
    mesh.positions[centre].z = height;
    Hierarchy h;
    h.levelCount = 2;
    h.positions = mesh.positions;
    h.collapseLevel.assign(mesh.positions.size(), kNeverCollapses);
    h.birthLevel.assign(mesh.positions.size(), 0);
    h.domain.assign(mesh.positions.size(), 0);
    h.wedgePosition = mesh.wedgePosition;
    h.wedgeParent.assign(mesh.wedgePosition.size(), kNone);
    h.collapseLevel[centre] = 1;
    h.wedgeParent[centre] = neighbour; // a mesh without attributes has one wedge a position, in order
    h.domainPatches = {{0}};
    h.patches.resize(1);
    h.facePatch.assign(mesh.faces.size(), 0);
    h.levelThreshold.assign(2, 0.0f);
    return h;
}

} // namespace

TEST_CASE("the distance to a triangle is the least over its points") {
    Numbers numbers;
    for (const Triangle& t : soup(50, numbers)) {
        const glm::dvec3 p(numbers.point()), a(t.a), b(t.b), c(t.c);
        const double exact = std::sqrt(squaredDistance(p, a, b, c));
        double least = 1e9;
        constexpr int kSteps = 200;
        for (int i = 0; i <= kSteps; ++i) {
            for (int j = 0; i + j <= kSteps; ++j) {
                least = std::min(
                    least, glm::length(p - (a + (b - a) * (double(i) / kSteps) + (c - a) * (double(j) / kSteps))));
            }
        }
        CHECK(exact <= least + 1e-12);
        CHECK(exact >= least - 0.01); // the grid's spacing on triangles of size 0.1..0.3
    }
}

TEST_CASE("a triangle without area has the distance of its longest side") {
    CHECK(squaredDistance({0, 1, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}) == doctest::Approx(1));
    CHECK(squaredDistance({3, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}) == doctest::Approx(4));
    CHECK(squaredDistance({0, 2, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}) == doctest::Approx(4));
}

TEST_CASE("the tree finds what brute force finds, and so does Embree") {
    Numbers numbers;
    const std::vector<Triangle> triangles = soup(500, numbers);
    const SurfaceDistance tree(triangles);
    std::vector<glm::vec3> points;
    std::vector<glm::uvec3> faces;
    for (const Triangle& t : triangles) {
        const auto i = uint32_t(points.size());
        points.insert(points.end(), {t.a, t.b, t.c});
        faces.emplace_back(i, i + 1, i + 2);
    }
    const Nearest nearest(points, faces);
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 p = 2.0f * numbers.point();
        double brute = INFINITY;
        for (const Triangle& s : triangles) brute = std::min(brute, squaredDistance(p, s.a, s.b, s.c));
        const SurfaceDistance::Hit hit = tree.nearest(p);
        CHECK(hit.squared == brute);
        const Triangle& t = triangles[hit.triangle];
        CHECK(squaredDistance(p, t.a, t.b, t.c) == brute);
        CHECK(nearest.distance(p) == doctest::Approx(std::sqrt(brute)).epsilon(1e-9));
        CHECK(tree.nearest(p, brute * 1.5).squared <= brute * 1.5);
    }
    CHECK(std::isinf(SurfaceDistance({}).nearest({0, 0, 0}).squared));
    CHECK(std::isinf(Nearest({}, {}).distance({0, 0, 0})));
}

TEST_CASE("a collapsed bump costs 1.3 times its height, a flat collapse nothing") {
    Mesh flat = test::welded(test::grid(4));
    const Hierarchy none = collapseCentre(flat, 0.0f);
    REQUIRE(checkHierarchy(flat, none).ok());
    const PatchErrors still = estimateErrors(flat, none);
    CHECK(still.values[0] == 0.0f);
    CHECK(still.values[1] < 1e-7f);

    Mesh bump = test::welded(test::grid(4));
    const Hierarchy one = collapseCentre(bump, 0.1f);
    const PatchErrors errors = estimateErrors(bump, one);
    CHECK(errors.estimate);
    CHECK(errors.values[0] == 0.0f);
    CHECK(errors.values[1] == doctest::Approx(0.13).epsilon(1e-5));
}

TEST_CASE("a measurement that is told to stop stops") {
    Mesh mesh = test::welded(test::grid(4));
    const Hierarchy h = collapseCentre(mesh, 0.1f);
    int calls = 0;
    estimateErrors(mesh, h, [&](double) { return ++calls < 1; });
    CHECK(calls == 1);
}
