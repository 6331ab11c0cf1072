#include "meshes/builders.h"

#include "hierarchy/card_fit.h"

#include <xgc/bake/default_hierarchy.h>
#include <xgc/bake/error.h>
#include <xgc/bake/models.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <random>

using namespace xgc::bake;

namespace {

/// An upright square that faces +z, its texture over the square from `uv` on.
Card squareAt(glm::dvec3 at, double side, glm::vec2 uv = glm::vec2(0)) {
    Card card;
    card.cornerCount = 4;
    card.faceCount = 2;
    card.corner = {at, at + glm::dvec3(side, 0, 0), at + glm::dvec3(side, side, 0), at + glm::dvec3(0, side, 0)};
    card.uv = {uv, uv + glm::vec2(1, 0), uv + glm::vec2(1, 1), uv + glm::vec2(0, 1)};
    card.face = {{{0, 1, 2}, {0, 2, 3}}};
    card.normal = {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, 1)};
    card.points.assign(card.corner.begin(), card.corner.end());
    card.wantedArea = side * side;
    return card;
}

/// Leaves scattered in a unit cube: `rim` corners each, about flat, with texture coordinates.
Model leaves(uint32_t count, uint32_t rim, float size, uint32_t seed) {
    std::mt19937 random(seed);
    const auto between = [&](float low, float high) {
        return low + (high - low) * (float(random() % 65536) / 65536.0f);
    };
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    std::vector<glm::vec2> uvs;
    for (uint32_t i = 0; i < count; ++i) {
        const float x = between(0, 1), y = between(0, 1), z = between(0, 1);
        const glm::vec3 at(x, y, z);
        const float a = between(-0.5f, 0.5f), b = between(-0.5f, 0.5f);
        const glm::vec3 u = glm::normalize(glm::vec3(1, a, b)), v = glm::normalize(glm::cross(glm::vec3(b, a, 1), u));
        const auto first = uint32_t(positions.size());
        for (uint32_t k = 0; k < rim; ++k) {
            const float turn = 6.2831853f * (float(k) + 0.5f) / float(rim);
            const glm::vec2 c(std::cos(turn), std::sin(turn));
            positions.push_back(at + size * (c.x * u + c.y * v));
            uvs.push_back(0.5f + 0.5f * c);
        }
        for (uint32_t k = 1; k + 1 < rim; ++k) triangles.emplace_back(first, first + k, first + k + 1);
    }
    Model model = xgc::test::modelOf(std::move(positions), std::move(triangles));
    model.attributes.uvs[0] = std::move(uvs);
    return model;
}

/// Patches by the cell of a grid of n x n x n cells in which a leaf of so many faces begins.
PatchAssignment patchesByPlace(const Mesh& mesh, uint32_t leafFaces, int n) {
    PatchAssignment out;
    out.patches.assign(size_t(n * n * n), {});
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::vec3 p = mesh.positions[mesh.facePositions(f / leafFaces * leafFaces).x];
        const glm::ivec3 c = glm::clamp(glm::ivec3(p * float(n)), glm::ivec3(0), glm::ivec3(n - 1));
        out.facePatch.push_back(uint32_t((c.z * n + c.y) * n + c.x));
    }
    return out;
}

double areaOf(const Hierarchy& h, const DrawnSurface& surface) {
    double area = 0;
    for (const glm::uvec3 t : surface.triangles) {
        const auto at = [&](uint32_t wedge) { return glm::dvec3(h.positions[h.wedgePosition[wedge]]); };
        area += glm::length(glm::cross(at(t.y) - at(t.x), at(t.z) - at(t.x))) / 2;
    }
    return area;
}

DrawnSurface drawLevel(const Mesh& mesh, const Hierarchy& h, uint32_t level) {
    return drawSurface(mesh, h, std::vector<uint8_t>(h.patchCount(), uint8_t(level)));
}

/// Faces that turn over against the input's, or have no area.
uint32_t faultsOf(const Mesh& mesh, const Hierarchy& h, const DrawnSurface& surface) {
    uint32_t faults = 0;
    const auto normal = [](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) { return glm::cross(b - a, c - a); };
    for (size_t i = 0; i < surface.triangles.size(); ++i) {
        const glm::uvec3 t = surface.triangles[i], base = mesh.facePositions(surface.face[i]);
        const auto at = [&](uint32_t wedge) { return glm::dvec3(h.positions[h.wedgePosition[wedge]]); };
        const auto& p = mesh.positions;
        faults += glm::dot(normal(at(t.x), at(t.y), at(t.z)), normal(p[base.x], p[base.y], p[base.z])) <= 0;
    }
    return faults;
}

} // namespace

TEST_CASE("two squares side by side become one of their joint area") {
    const Card a = squareAt({0, 0, 0}, 1), b = squareAt({1.1, 0, 0}, 1);
    const auto fit = fitCards(a, b, {0.3 * 0.3, 2});
    REQUIRE(fit);
    CHECK(fit->area == doctest::Approx(2.1));
    CHECK(std::sqrt(fit->squaredError) == doctest::Approx(0.05).epsilon(0.1)); // the gap between them
    const Card one = joined(a, b, *fit);
    CHECK(one.area() == doctest::Approx(2.1));
    CHECK(one.wantedArea == 2);
    CHECK(!fitCards(a, b, {0.04 * 0.04, 2}));
}

TEST_CASE("a card takes no corner of another part of the texture, and never turns over") {
    const Card a = squareAt({0, 0, 0}, 1), other = squareAt({1.1, 0, 0}, 1, {5, 0});
    CHECK(!fitCards(a, other, {0.5 * 0.5, 2}));
    Card behind = squareAt({1.1, 0, 0}, 1);
    std::swap(behind.corner[0], behind.corner[1]);
    std::swap(behind.corner[2], behind.corner[3]);
    for (glm::dvec3& n : behind.normal) n = -n;
    const auto fit = fitCards(a, behind, {4, 2});
    if (fit) {
        const Card one = joined(a, behind, *fit);
        for (uint32_t f = 0; f < 2; ++f) {
            const auto& t = one.face[f];
            CHECK(glm::dot(glm::cross(one.corner[t[1]] - one.corner[t[0]], one.corner[t[2]] - one.corner[t[0]]),
                           one.normal[f]) > 0);
        }
    }
}

TEST_CASE("foliage keeps its area within 10 % at errors of up to 4 pixels where a tree is 128 pixels high") {
    const Model model = makeModel(BundledModel::tree, 20000);
    const Mesh mesh = xgc::test::welded(model);
    const Topology topology = buildTopology(mesh);
    const Hierarchy h = buildDefaultHierarchy(mesh, topology, splitPatches(mesh, topology, segmentByMaterial(mesh)),
                                              HierarchyOptions{});
    const PatchErrors errors = measureErrors(mesh, topology, h, {});
    glm::vec3 low(mesh.positions[0]), high = low;
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    float radius = 0;
    for (const glm::vec3& p : mesh.positions) radius = std::max(radius, glm::distance(p, (low + high) / 2.0f));

    const auto leafArea = [&](uint32_t level, uint32_t& faces) {
        DrawnSurface all = drawLevel(mesh, h, level), some;
        for (size_t i = 0; i < all.triangles.size(); ++i) {
            if (mesh.materials[mesh.faceMaterial[all.face[i]]].name == "leaves")
                some.triangles.push_back(all.triangles[i]);
        }
        faces = uint32_t(some.triangles.size());
        return areaOf(h, some);
    };
    uint32_t baseFaces = 0, faces = 0;
    const double whole = leafArea(0, baseFaces);
    uint32_t least = baseFaces;
    for (uint32_t level = 1; level < h.levelCount; ++level) {
        float error = 0;
        for (uint32_t p = 0; p < h.patchCount(); ++p) {
            if (mesh.materials[h.patches[p].material].name == "leaves")
                error = std::max(error, errors.values[p * h.levelCount + level]);
        }
        const double area = leafArea(level, faces);
        CAPTURE(level);
        CAPTURE(faces);
        if (error > 2 * radius * 4 / 128) break;
        least = faces;
        CHECK(area >= 0.9 * whole);
        CHECK(area <= 1.1 * whole);
    }
    CHECK(least < 0.7 * baseFaces); // not by keeping them all
    leafArea(h.levelCount - 1, faces);
    CHECK(faces < baseFaces / 10);
}

TEST_CASE("leaves of several triangles keep the area of a cloud, and no state turns one over") {
    for (const uint32_t rim : {3u, 4u, 6u}) {
        for (const Placement placement : {Placement::subset, Placement::optimal}) {
            CAPTURE(rim);
            CAPTURE(int(placement));
            const Mesh mesh = xgc::test::welded(leaves(600, rim, 0.03f, rim));
            const Topology topology = buildTopology(mesh);
            HierarchyOptions options;
            options.placement = placement;
            options.maxLevels = 25;
            const Hierarchy h = buildDefaultHierarchy(mesh, topology, patchesByPlace(mesh, rim - 2, 2), options);
            const Status status = checkHierarchy(mesh, h);
            REQUIRE_MESSAGE(status.ok(), status.message);
            const double whole = areaOf(h, drawLevel(mesh, h, 0));
            const uint32_t last = h.levelCount - 1;
            CHECK(drawLevel(mesh, h, last).triangles.size() < mesh.faces.size() / 4);
            for (uint32_t level = 0; level <= last; ++level) {
                CAPTURE(level);
                if (drawLevel(mesh, h, level).triangles.size() < 200) break;
                CHECK(areaOf(h, drawLevel(mesh, h, level)) == doctest::Approx(whole).epsilon(0.15));
            }
            std::mt19937 random(7);
            std::vector<uint8_t> levels(h.patchCount());
            uint32_t faults = 0;
            for (int state = 0; state < 200; ++state) {
                for (uint8_t& l : levels) l = uint8_t(random() % h.levelCount);
                faults += faultsOf(mesh, h, drawSurface(mesh, h, levels));
            }
            CHECK(faults == 0);
        }
    }
}

TEST_CASE("stickers on a body go, and leave no floor") {
    Model body = xgc::test::sphere(12);
    const auto count = uint32_t(body.positions.size());
    std::vector<glm::vec3> spots;
    for (uint32_t i = 0; i < count; i += 17) spots.push_back(1.004f * body.positions[i]);
    for (const glm::vec3& p : spots) {
        const glm::vec3 u = 0.02f * glm::normalize(glm::cross(p, glm::vec3(0.3f, 0.5f, 0.8f)));
        const glm::vec3 v = 0.02f * glm::normalize(glm::cross(p, u));
        const auto first = uint32_t(body.positions.size());
        for (const glm::vec3& q : {p - u - v, p + u - v, p + u + v, p - u + v}) body.positions.push_back(q);
        body.triangles.emplace_back(first, first + 1, first + 2);
        body.triangles.emplace_back(first, first + 2, first + 3);
    }
    const Mesh mesh = xgc::test::welded(xgc::test::modelOf(std::move(body.positions), std::move(body.triangles)));
    const Topology topology = buildTopology(mesh);
    const Hierarchy h = buildDefaultHierarchy(mesh, topology, splitPatches(mesh, topology, segmentNone(mesh)), {});
    CHECK(drawLevel(mesh, h, h.levelCount - 1).triangles.size() < 60);
}
