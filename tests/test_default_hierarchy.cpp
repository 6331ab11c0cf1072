#include "meshes/builders.h"

#include <xgc/bake/default_hierarchy.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

using namespace xgc;
using namespace xgc::bake;

namespace {

/// Patches grown breadth-first from random faces.
PatchAssignment randomPatches(const Mesh& mesh, const Topology& topology, uint32_t count, uint32_t seed) {
    std::mt19937 random(seed);
    PatchAssignment out;
    out.facePatch.assign(mesh.faces.size(), kNone);
    std::vector<uint32_t> queue;
    for (uint32_t f = 0; queue.size() < mesh.faces.size(); ++f) {
        const uint32_t seedFace =
            out.patches.size() < count ? uint32_t(random() % mesh.faceCount()) : f % mesh.faceCount();
        if (out.facePatch[seedFace] != kNone) continue;
        out.facePatch[seedFace] = std::min(uint32_t(out.patches.size()), count - 1);
        if (out.patches.size() < count) out.patches.push_back({0, 0});
        queue.push_back(seedFace);
        if (out.patches.size() < count) continue;
        for (size_t i = 0; i < queue.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                for (const uint32_t g : topology.facesOfEdge(topology.faceEdges[queue[i]][k])) {
                    if (out.facePatch[g] != kNone) continue;
                    out.facePatch[g] = out.facePatch[queue[i]];
                    queue.push_back(g);
                }
            }
        }
    }
    return out;
}

glm::dvec3 normalOf(const Hierarchy& h, const glm::uvec3& p) {
    const glm::dvec3 a(h.positions[p.x]);
    return glm::cross(glm::dvec3(h.positions[p.y]) - a, glm::dvec3(h.positions[p.z]) - a);
}

struct StateFaults {
    uint32_t flips = 0, odd = 0, degenerate = 0;
};

/// What is wrong with a state; `borders`: whether the input has any.
StateFaults faultsOf(const Mesh& mesh, const Hierarchy& h, std::span<const uint8_t> levels) {
    StateFaults faults;
    const DrawnSurface surface = drawSurface(mesh, h, levels);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> uses;
    for (size_t i = 0; i < surface.triangles.size(); ++i) {
        const glm::uvec3 t = surface.triangles[i];
        const glm::uvec3 p(h.wedgePosition[t.x], h.wedgePosition[t.y], h.wedgePosition[t.z]);
        const glm::dvec3 n = normalOf(h, p);
        faults.flips += glm::dot(n, normalOf(h, mesh.facePositions(surface.face[i]))) < 0;
        faults.degenerate += n == glm::dvec3(0);
        for (int k = 0; k < 3; ++k) ++uses[std::minmax(p[k], p[(k + 1) % 3])];
    }
    for (const auto& [edge, count] : uses) faults.odd += count % 2;
    return faults;
}

struct Subject {
    const char* name;
    Model model;
    bool closed = true;
};

/// A sphere whose upper half has texture coordinates of its own: a seam around the equator.
Model seamedSphere(uint32_t n) {
    Model model = test::sphere(n);
    const auto rows = uint32_t(model.positions.size());
    model.attributes.uvs[0].resize(rows);
    for (uint32_t r = 0; r < rows; ++r) model.attributes.uvs[0][r] = {model.positions[r].x, model.positions[r].y};
    for (glm::uvec3& t : model.triangles) {
        if (model.positions[t.x].z + model.positions[t.y].z + model.positions[t.z].z < 0) continue;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 p = model.positions[t[k]];
            model.attributes.uvs[0].push_back({p.x + 5, p.y});
            model.positions.push_back(p);
            t[k] = uint32_t(model.positions.size()) - 1;
        }
    }
    return model;
}

Model torus(uint32_t around, uint32_t along) {
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (uint32_t j = 0; j < along; ++j) {
        for (uint32_t i = 0; i < around; ++i) {
            const float u = 6.2831853f * float(i) / float(around), v = 6.2831853f * float(j) / float(along);
            p.emplace_back((2 + std::cos(v)) * std::cos(u), (2 + std::cos(v)) * std::sin(u), std::sin(v));
            const uint32_t i1 = (i + 1) % around, j1 = (j + 1) % along;
            t.emplace_back(j * around + i, j * around + i1, j1 * around + i1);
            t.emplace_back(j * around + i, j1 * around + i1, j1 * around + i);
        }
    }
    return test::modelOf(std::move(p), std::move(t));
}

/// Two spheres beside each other, the second one smaller.
Model twoSpheres() {
    Model model = test::sphere(5);
    const Model other = test::sphere(3);
    const auto base = uint32_t(model.positions.size());
    for (const glm::vec3& q : other.positions) model.positions.push_back(0.4f * q + glm::vec3(2, 0, 0));
    for (const glm::uvec3& q : other.triangles) model.triangles.push_back(q + base);
    return test::modelOf(std::move(model.positions), std::move(model.triangles));
}

/// A cube blown up to a sphere, a chart of texture coordinates a side: seams that meet in threes.
Model boxMappedSphere(uint32_t n) {
    Model model = test::sphere(n);
    const uint32_t side = (n + 1) * (n + 1);
    for (uint32_t r = 0; r < model.positions.size(); ++r) {
        const uint32_t axis = r / side / 2;
        const glm::vec3 q = model.positions[r];
        model.attributes.uvs[0].emplace_back(q[(axis + 1) % 3] + 3 * float(r / side), q[(axis + 2) % 3]);
    }
    return model;
}

std::vector<Subject> subjects() {
    return {{"sphere", test::sphere(6)},
            {"cube", test::cube(5)},
            {"torus", torus(18, 9)},
            {"two spheres", twoSpheres()},
            {"box-mapped sphere", boxMappedSphere(6)},
            {"seamed sphere", seamedSphere(6)},
            {"grid", test::grid(9), false}};
}

} // namespace

namespace {

/// Tries all states of a mesh cut into so many patches.
void checkAllStates(const Subject& s, uint32_t patchCount, Placement placement) {
    const Mesh mesh = test::welded(s.model);
    const Topology topology = buildTopology(mesh);
    HierarchyOptions options;
    options.placement = placement;
    options.firstError = patchCount == 4 ? 0.04 : 0.02; // few levels, so that all states can be tried
    options.maxLevels = patchCount == 4 ? 4 : 7;
    const PatchAssignment patches = randomPatches(mesh, topology, patchCount, patchCount);
    const Hierarchy h = buildDefaultHierarchy(mesh, topology, patches, options);
    const bake::Status status = checkHierarchy(mesh, h);
    REQUIRE_MESSAGE(status.ok(), status.message);
    CHECK(h.levelCount > 2);
    if (placement == Placement::subset) CHECK(h.positions.size() == mesh.positions.size());
    std::vector<uint8_t> levels(h.patchCount(), 0);
    const uint32_t borders = faultsOf(mesh, h, levels).odd;
    CHECK((borders == 0) == s.closed);
    StateFaults sum;
    for (bool more = true; more;) {
        const StateFaults f = faultsOf(mesh, h, levels);
        sum.flips += f.flips;
        sum.degenerate += f.degenerate;
        sum.odd += s.closed ? f.odd : 0;
        more = false;
        for (uint8_t& level : levels) { // the next state
            if (++level < h.levelCount) {
                more = true;
                break;
            }
            level = 0;
        }
    }
    CHECK(sum.flips == 0);
    CHECK(sum.degenerate == 0);
    CHECK(sum.odd == 0);
}

} // namespace

TEST_CASE("in every state of small meshes nothing is flipped, torn or degenerate") {
    for (const Placement placement : {Placement::subset, Placement::optimal, Placement::midpoint}) {
        CAPTURE(int(placement));
        for (const Subject& s : subjects()) {
            CAPTURE(s.name);
            for (const uint32_t patchCount : {1u, 2u, 3u, 4u}) {
                CAPTURE(patchCount);
                checkAllStates(s, patchCount, placement);
            }
        }
    }
}

TEST_CASE("placements that make vertices draw them, between the attributes of what they replace") {
    const Mesh mesh = test::welded(seamedSphere(10));
    const Topology topology = buildTopology(mesh);
    HierarchyOptions options;
    options.placement = Placement::optimal;
    const Hierarchy h = buildDefaultHierarchy(mesh, topology, randomPatches(mesh, topology, 3, 1), options);
    CHECK(h.positions.size() > mesh.positions.size() + 50);
    for (size_t p = mesh.positions.size(); p < h.positions.size(); ++p) {
        CHECK(h.birthLevel[p] > 0);
        CHECK(glm::length(h.positions[p]) > 0.5f);
        CHECK(glm::length(h.positions[p]) < 1.5f);
    }
    const float xMost = 5 + 1;
    for (size_t w = mesh.wedgePosition.size(); w < h.wedgePosition.size(); ++w) {
        const glm::vec2 uv = h.attributes.uvs[0][w];
        const bool upper = uv.x > 3; // no made vertex lies between the charts
        CHECK(uv.x >= (upper ? 4.0f : -1.0f));
        CHECK(uv.x <= (upper ? xMost : 1.0f));
    }
}

TEST_CASE("closed meshes fall to a few faces, however they are cut") {
    const Mesh mesh = test::welded(test::sphere(20));
    const Topology topology = buildTopology(mesh);
    for (const uint32_t patchCount : {1u, 10u, 40u}) {
        std::vector<HierarchyLevelReport> report;
        buildDefaultHierarchy(mesh, topology, randomPatches(mesh, topology, patchCount, 1), {}, &report);
        CAPTURE(patchCount);
        CHECK(report.back().faces <= 40);
    }
}

TEST_CASE("locked vertices stay, important ones go later") {
    const Mesh mesh = test::welded(test::sphere(12));
    const Topology topology = buildTopology(mesh);
    HierarchyOptions options;
    options.vertexImportance.assign(mesh.positions.size(), 1);
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
        if (mesh.positions[p].z > 0.5f) options.vertexImportance[p] = std::numeric_limits<float>::infinity();
        if (mesh.positions[p].z < -0.5f) options.vertexImportance[p] = 4;
    }
    const Hierarchy h = buildDefaultHierarchy(mesh, topology, randomPatches(mesh, topology, 3, 1), options);
    double plain = 0, important = 0;
    uint32_t plainCount = 0, importantCount = 0;
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
        if (mesh.positions[p].z > 0.5f) {
            CHECK(h.collapseLevel[p] == kNeverCollapses);
        } else if (mesh.positions[p].z < -0.5f) {
            important += std::min<uint8_t>(h.collapseLevel[p], 30);
            ++importantCount;
        } else {
            plain += std::min<uint8_t>(h.collapseLevel[p], 30);
            ++plainCount;
        }
    }
    CHECK(important / importantCount > plain / plainCount + 2);
}

TEST_CASE("colours hold a surface where they bend, and cost nothing where they are linear") {
    const auto facesAt = [](auto&& colorAt, double weight) {
        Model model = test::grid(40);
        for (const glm::vec3& p : model.positions) model.attributes.colors[0].push_back(glm::vec4(colorAt(p), 0, 0, 1));
        const Mesh mesh = test::welded(model);
        HierarchyOptions options;
        options.colorWeight = weight;
        options.maxLevels = 10;
        std::vector<HierarchyLevelReport> report;
        buildDefaultHierarchy(mesh, buildTopology(mesh), randomPatches(mesh, buildTopology(mesh), 3, 1), options,
                              &report);
        return report.back().faces;
    };
    const auto disc = [](const glm::vec3& p) {
        return glm::distance(p, glm::vec3(0.5f, 0.5f, 0)) < 0.3f ? 1.0f : 0.0f;
    };
    const auto ramp = [](const glm::vec3& p) { return p.x; };
    CHECK(facesAt(disc, 0) < 50);
    CHECK(facesAt(ramp, 0.1) < 50);
    CHECK(facesAt(disc, 0.1) > 100); // the rim is a curve
}

TEST_CASE("patches are bounded, whole, and never cross parts or materials") {
    Model model = test::grid(60);
    model.materials.resize(2);
    for (size_t t = 0; t < model.triangles.size(); ++t) model.triangleMaterial[t] = t % 120 < 30;
    const Mesh mesh = test::welded(model);
    const Topology topology = buildTopology(mesh);
    const PatchAssignment split = splitPatches(mesh, topology, segmentNone(mesh), 500);
    std::vector<uint32_t> faces(split.patches.size(), 0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        CHECK(split.patches[split.facePatch[f]].material == mesh.faceMaterial[f]);
        ++faces[split.facePatch[f]];
    }
    CHECK(split.patches.size() >= 7200 / 500);
    CHECK(split.patches.size() <= 30);
    for (const uint32_t count : faces) {
        CHECK(count > 0);
        CHECK(count <= 1000);
    }
    CHECK(std::is_sorted(split.patches.begin(), split.patches.end(),
                         [](const Patch& a, const Patch& b) { return a.material < b.material; }));
}

TEST_CASE("pages that share a spine, an edge of many faces, are split into patches like any mesh") {
    constexpr uint32_t kPages = 7, kSide = 24;
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (uint32_t page = 0; page < kPages; ++page) {
        const bake::Model grid = test::grid(kSide); // x = 0 is the spine
        const auto offset = uint32_t(positions.size());
        for (const glm::vec3& p : grid.positions) positions.emplace_back(p.x, p.y, p.x * float(page));
        for (const glm::uvec3& t : grid.triangles) triangles.push_back(t + offset);
    }
    const bake::Mesh mesh = test::welded(test::modelOf(positions, triangles));
    const bake::Topology topology = bake::buildTopology(mesh);
    const bake::PatchAssignment patches = bake::splitPatches(mesh, topology, bake::segmentNone(mesh), 100);
    CHECK(patches.patches.size() > mesh.faceCount() / 100);
    std::vector<uint32_t> faceCounts(patches.patches.size(), 0);
    for (const uint32_t p : patches.facePatch) {
        REQUIRE(p < faceCounts.size());
        ++faceCounts[p];
    }
    CHECK(*std::min_element(faceCounts.begin(), faceCounts.end()) > 0);
}
