#include "meshes/builders.h"

#include <xgc/bake/thesis_hierarchy.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <fstream>
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

Model readOff(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string magic;
    uint32_t vertices = 0, faces = 0, edges = 0, corners = 0;
    in >> magic >> vertices >> faces >> edges;
    std::vector<glm::vec3> p(vertices);
    for (glm::vec3& v : p) in >> v.x >> v.y >> v.z;
    std::vector<glm::uvec3> t(faces);
    for (glm::uvec3& f : t) in >> corners >> f.x >> f.y >> f.z;
    return test::modelOf(std::move(p), std::move(t));
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
    for (const char* file : {"psb/off/61.off", "psb/off/281.off"}) {
        const Model model = readOff(data / file);
        all.push_back(inOctants(subjectOf(file, model)));
        ThesisSegmentOptions options;
        Subject byParts = subjectOf(file, model);
        byParts.parts = segmentThesis(byParts.mesh, byParts.topology, options);
        all.push_back(std::move(byParts));
    }
    return all;
}

} // namespace

TEST_CASE("any levels of the patches draw a watertight surface") {
    for (const Subject& s : subjects()) {
        CAPTURE(s.name);
        std::vector<HierarchyLevelReport> report;
        const Hierarchy h = buildThesisHierarchy(s.mesh, s.topology, s.parts, {}, &report);
        CHECK(checkHierarchy(s.mesh, h).message == "");
        REQUIRE(h.levelCount == report.size());
        std::mt19937 random(7);
        uint32_t more = 0;
        for (int i = 0; i < 60; ++i) {
            const DrawnSurface surface = drawSurface(s.mesh, h, randomState(h, random));
            const EdgeUse use = edgeUse(h, surface);
            if (s.report.closed() && s.report.nonManifoldEdges == 0) CHECK(use.odd == 0);
            more += use.more;
        }
        MESSAGE(s.name << " closed " << s.report.closed() << " patches " << h.patchCount() << " faces "
                       << report.front().faces << " -> " << report.back().faces << " levels " << h.levelCount
                       << " more than two: " << more);
    }
}
