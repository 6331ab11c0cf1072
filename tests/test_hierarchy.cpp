#include "meshes/builders.h"

#include <xgc/bake/import.h>
#include <xgc/bake/thesis_hierarchy.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>

using namespace xgc;
using namespace xgc::bake;

namespace {

struct Subject {
    std::string name;
    Mesh mesh;
    Topology topology;
    Segmentation parts;
    WeldReport report;
};

Subject subjectOf(std::string name, const Model& model) {
    Subject s;
    s.name = std::move(name);
    REQUIRE(weld(model, {}, s.mesh, s.report).ok());
    s.topology = buildTopology(s.mesh);
    s.parts = segmentNone(s.mesh);
    return s;
}

/// Parts by the octant of the face's middle, counted from the mesh's own; eight names whether used or not.
Subject inOctants(Subject s) {
    glm::vec3 middle(0);
    for (const glm::vec3& p : s.mesh.positions) middle += p / float(s.mesh.positions.size());
    for (uint32_t f = 0; f < s.mesh.faceCount(); ++f) {
        const glm::uvec3 c = s.mesh.facePositions(f);
        const glm::vec3 at = (s.mesh.positions[c.x] + s.mesh.positions[c.y] + s.mesh.positions[c.z]) / 3.0f - middle;
        s.parts.facePart[f] = uint32_t(at.x > 0) + 2 * uint32_t(at.y > 0) + 4 * uint32_t(at.z > 0);
    }
    s.parts.partNames = {"0", "1", "2", "3", "4", "5", "6", "7"};
    return s;
}

std::vector<uint8_t> randomState(const Hierarchy& h, std::mt19937& random) {
    std::vector<uint8_t> levels(h.patchCount());
    for (uint8_t& level : levels) level = uint8_t(random() % h.levelCount);
    return levels;
}

struct EdgeUse {
    uint32_t odd = 0, more = 0;
};

/// How often the edges of a drawn surface are used, by position.
EdgeUse edgeUse(const Hierarchy& h, const DrawnSurface& surface) {
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (const glm::uvec3& t : surface.triangles) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = h.wedgePosition[t[k]], b = h.wedgePosition[t[(k + 1) % 3]];
            edges.emplace_back(std::min(a, b), std::max(a, b));
        }
    }
    std::sort(edges.begin(), edges.end());
    EdgeUse use;
    for (size_t i = 0; i < edges.size();) {
        size_t end = i;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        use.odd += (end - i) % 2;
        use.more += end - i > 2;
        i = end;
    }
    return use;
}

std::vector<Subject> subjects() {
    std::vector<Subject> all;
    all.push_back(subjectOf("sphere", test::sphere(20)));
    all.push_back(inOctants(subjectOf("sphere in octants", test::sphere(20))));
    all.push_back(inOctants(subjectOf("cube in octants", test::cube(11))));
    const auto data = test::dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        MESSAGE("SKIPPED: real meshes (no XGC_DATA)");
        return all;
    }
    for (const char* file : {"psb/off/61.off", "psb/off/101.off", "mesh/fandisk.obj"}) {
        Model model;
        REQUIRE(importModel(data / file, model).ok());
        all.push_back(inOctants(subjectOf(file, model)));
        ThesisSegmentOptions options;
        Subject byParts = subjectOf(file, model);
        byParts.parts = segmentThesis(byParts.mesh, byParts.topology, options);
        all.push_back(std::move(byParts));
    }
    return all;
}

} // namespace

namespace {

/// Corners by position, starting at the least: a triangle whatever its vertices are called.
using Triangle = std::array<std::array<float, 3>, 3>;

Triangle triangleOf(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    Triangle t{{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

std::multiset<Triangle> trianglesOf(const Hierarchy& h, const DrawnSurface& surface) {
    std::multiset<Triangle> out;
    const auto at = [&](uint32_t wedge) { return h.positions[h.wedgePosition[wedge]]; };
    for (const glm::uvec3& t : surface.triangles) out.insert(triangleOf(at(t.x), at(t.y), at(t.z)));
    return out;
}

std::multiset<Triangle> trianglesOf(const XgcMesh& x) {
    std::multiset<Triangle> out;
    for (uint32_t f = 0; f < x.faces().size(); ++f) {
        if (x.faces()[f].ghost) continue;
        const glm::uvec3 c = x.cornersOf(f);
        out.insert(triangleOf(x.vertices()[c.x].position, x.vertices()[c.y].position, x.vertices()[c.z].position));
    }
    return out;
}

/// Moves every segment to its level, or as near as it goes before it stalls.
void moveTo(XgcMesh& x, std::span<const uint8_t> levels) {
    for (uint32_t s = 0; s < x.segmentCount(); ++s) {
        while (x.level(s) > levels[s]) x.refine(s);
        while (x.level(s) < levels[s] && x.simplify(s).collapses > 0) {
        }
    }
}

} // namespace

TEST_CASE("any levels of the patches draw a watertight surface, each edge of two faces") {
    for (const Subject& s : subjects()) {
        CAPTURE(s.name);
        std::vector<HierarchyLevelReport> report;
        const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {}, &report);
        CHECK(checkHierarchy(s.mesh, h).message == "");
        REQUIRE(h.levelCount == report.size());
        CHECK(report.front().faces == s.mesh.faceCount());
        CHECK(report.back().faces < s.mesh.faceCount() / 2);
        REQUIRE(s.report.closed());
        REQUIRE(s.report.nonManifoldEdges == 0);
        std::mt19937 random(7);
        for (int i = 0; i < 60; ++i) {
            const EdgeUse use = edgeUse(h, drawSurface(s.mesh, h, randomState(h, random)));
            CHECK(use.odd == 0);
            CHECK(use.more == 0);
        }
        for (uint32_t level = 0; level < h.levelCount; ++level) {
            const std::vector<uint8_t> uniform(h.patchCount(), uint8_t(level));
            CHECK(drawSurface(s.mesh, h, uniform).triangles.size() == report[level].faces);
        }
    }
}

TEST_CASE("the runtime form draws what the thesis's mesh shows, at any levels") {
    for (const Subject& s : subjects()) {
        CAPTURE(s.name);
        if (s.mesh.faceCount() > 12000) continue;
        const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
        const PatchAssignment assignment = patchesOfParts(s.mesh, s.parts);
        XgcMesh x(s.mesh, s.topology, assignment.facePatch, uint32_t(assignment.patches.size()));
        std::mt19937 random(11);
        for (int i = 0; i < 8; ++i) {
            const std::vector<uint8_t> levels = randomState(h, random);
            moveTo(x, levels);
            CHECK(trianglesOf(x) == trianglesOf(h, drawSurface(s.mesh, h, levels)));
        }
    }
}

TEST_CASE("parts and materials cut patches, in order") {
    Subject s = subjectOf("sphere", test::sphere(8));
    s.mesh.materials.resize(3);
    s.parts.partNames = {"left", "right"};
    for (uint32_t f = 0; f < s.mesh.faceCount(); ++f) {
        const glm::vec3 p = s.mesh.positions[s.mesh.facePositions(f).x];
        s.parts.facePart[f] = p.x > 0;
        s.mesh.faceMaterial[f] = p.y > 0 ? 2 : 0;
    }
    const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
    REQUIRE(h.patchCount() == 4);
    const std::array<Patch, 4> expected{{{0, 0}, {0, 2}, {1, 0}, {1, 2}}};
    for (uint32_t p = 0; p < 4; ++p) {
        CHECK(h.patches[p].part == expected[p].part);
        CHECK(h.patches[p].material == expected[p].material);
    }
    CHECK(checkHierarchy(s.mesh, h).message == "");
    std::mt19937 random(5);
    for (int i = 0; i < 50; ++i) {
        const DrawnSurface surface = drawSurface(s.mesh, h, randomState(h, random));
        CHECK(edgeUse(h, surface).odd == 0);
        CHECK(edgeUse(h, surface).more == 0);
    }
}

TEST_CASE("open and non-manifold input keeps its borders and its even edges") {
    Model model = test::grid(12);
    const auto base = uint32_t(model.positions.size());
    const Model fin = test::grid(12); // stands on the grid's middle row: edges of three faces
    for (const glm::vec3& p : fin.positions) model.positions.emplace_back(p.x, 0.5f, p.y);
    for (const glm::uvec3& t : fin.triangles) model.triangles.push_back(t + base);
    const Subject s = inOctants(subjectOf("fin", test::modelOf(model.positions, model.triangles)));
    REQUIRE(s.report.nonManifoldEdges == 12);
    const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
    CHECK(checkHierarchy(s.mesh, h).message == "");
    const auto oddEdges = [&](const std::vector<uint8_t>& levels) {
        return edgeUse(h, drawSurface(s.mesh, h, levels)).odd;
    };
    const uint32_t atInput = oddEdges(std::vector<uint8_t>(h.patchCount(), 0));
    std::mt19937 random(5);
    for (int i = 0; i < 50; ++i) CHECK(oddEdges(randomState(h, random)) == atInput);
}

TEST_CASE("made vertices have the average of their ancestors' attributes") {
    Model model = test::grid(10);
    Attributes& a = model.attributes;
    for (const glm::vec3& p : model.positions) {
        a.normals.push_back(glm::normalize(glm::vec3(p.x, p.y, 1)));
        a.tangents.emplace_back(1, 0, 0, -1);
        a.uvs[0].emplace_back(p.x, p.y);
        a.colors[0].emplace_back(p, 1);
        const auto bone = uint16_t(p.x * 9.99f);
        a.joints[0].emplace_back(bone, bone + 1, bone + 2, bone + 3);
        a.weights[0].emplace_back(0.4f, 0.3f, 0.2f, 0.1f);
    }
    a.morphTargets.resize(1);
    for (const glm::vec3& p : model.positions) a.morphTargets[0].positions.emplace_back(0, 0, p.x);
    const Subject s = subjectOf("attributes", model);
    const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
    REQUIRE(checkHierarchy(s.mesh, h).message == "");
    REQUIRE(h.wedgePosition.size() > s.mesh.wedgePosition.size() + 20);
    for (uint32_t w = 0; w < h.wedgePosition.size(); ++w) {
        const glm::vec3 p = h.positions[h.wedgePosition[w]];
        const Attributes& made = h.attributes;
        CHECK(glm::length(made.normals[w]) == doctest::Approx(1));
        CHECK(made.tangents[w] == glm::vec4(1, 0, 0, -1));
        CHECK(glm::distance(made.uvs[0][w], glm::vec2(p)) < 1e-6f); // linear in the position, as midpoints are
        CHECK(glm::distance(glm::vec3(made.colors[0][w]), p) < 1e-6f);
        CHECK(made.morphTargets[0].positions[w].z == doctest::Approx(p.x));
        const glm::vec4 weights = made.weights[0][w];
        CHECK(weights.x + weights.y + weights.z + weights.w == doctest::Approx(1));
        CHECK((weights.x >= weights.y && weights.y >= weights.z && weights.z >= weights.w));
        CHECK(std::set<uint16_t>{made.joints[0][w].x, made.joints[0][w].y, made.joints[0][w].z, made.joints[0][w].w}
                  .size() == 4);
    }
}

TEST_CASE("the check names what breaks a rule") {
    const Subject s = inOctants(subjectOf("sphere", test::sphere(8)));
    const Hierarchy good = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
    REQUIRE(checkHierarchy(s.mesh, good).ok());
    uint32_t gone = 0; // a wedge that collapses into a made one
    while (good.wedgeParent[gone] == kNone || good.wedgeParent[gone] < s.mesh.wedgePosition.size()) ++gone;
    const uint32_t p = good.wedgePosition[gone], q = good.wedgePosition[good.wedgeParent[gone]];
    const auto broken = [&](auto&& breakIt) {
        Hierarchy h = good;
        breakIt(h);
        const Status status = checkHierarchy(s.mesh, h);
        CHECK(status.outcome == Outcome::promiseBroken);
        return status.message;
    };
    const auto says = [](const std::string& message, std::string_view what) {
        CAPTURE(message);
        CAPTURE(what);
        CHECK(message.find(what) != std::string::npos);
    };
    says(broken([&](Hierarchy& h) { h.collapseLevel[p] = 0; }), "collapse level out of range, position");
    says(broken([&](Hierarchy& h) { h.collapseLevel[p] = uint8_t(h.levelCount); }), "collapse level out of range");
    says(broken([&](Hierarchy& h) { h.birthLevel[q] = 0; }), "birth level out of range, position");
    says(broken([&](Hierarchy& h) { h.birthLevel[p] = 1; }), "born though the mesh has it, position");
    says(broken([&](Hierarchy& h) { h.wedgeParent[gone] = gone; }), "its own parent, wedge");
    says(broken([&](Hierarchy& h) { h.wedgeParent[gone] = kNone; }), "no parent, wedge");
    says(broken([&](Hierarchy& h) { h.domain[q] = uint32_t(h.domainPatches.size()); }), "no domain, position");
    says(broken([&](Hierarchy& h) {
             const uint32_t own = h.domainPatches[h.domain[q]].front();
             h.domain[q] = 0;
             while (std::ranges::count(h.domainPatches[h.domain[q]], own) > 0) ++h.domain[q];
         }),
         "the parent's domain is not wider, wedge");
    says(broken([&](Hierarchy& h) { h.positions[p].x += 1; }), "not where the mesh has it, position");
    says(broken([&](Hierarchy& h) { h.facePatch[5] = 99; }), "no patch, face 5");
    says(broken([&](Hierarchy& h) { h.facePatch[5] ^= 7; }), "face 5");
    says(broken([&](Hierarchy& h) { h.wedgePosition.back() = 1u << 30; }), "no position, wedge");
    says(broken([&](Hierarchy& h) { h.levelThreshold.pop_back(); }), "levels and their thresholds");
    says(broken([&](Hierarchy& h) { h.patches[0].material = 4; }), "of another material, face");
    says(broken([&](Hierarchy& h) {
             std::ranges::reverse(h.domainPatches.back());
             h.domainPatches.back().push_back(0);
         }),
         "domain");
    says(broken([&](Hierarchy& h) {
             // A second wedge at a boundary vertex, and one collapse into it alone.
             uint32_t wing = 0;
             while (h.wedgeParent[wing] == kNone || h.wedgeParent[wing] >= s.mesh.wedgePosition.size()) ++wing;
             h.wedgePosition.push_back(h.wedgePosition[h.wedgeParent[wing]]);
             h.wedgeParent.push_back(kNone);
             h.wedgeParent[wing] = uint32_t(h.wedgeParent.size()) - 1;
         }),
         "two wedges of one position meet in face");
    says(broken([&](Hierarchy& h) { // q and p lead to each other
             h.collapseLevel[q] = h.collapseLevel[p];
             h.birthLevel[q] = h.collapseLevel[p];
             for (uint32_t w = 0; w < h.wedgePosition.size(); ++w) {
                 if (h.wedgePosition[w] == q) h.wedgeParent[w] = gone;
             }
         }),
         "loop");
}
