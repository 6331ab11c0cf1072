#include "meshes/builders.h"

#include <xgc/bake/xgc_mesh.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <random>
#include <set>

using namespace xgc;
using namespace xgc::bake;

namespace {

struct Subject {
    Mesh mesh;
    Topology topology;
    std::vector<uint32_t> segments;
    uint32_t segmentCount = 1;

    XgcMesh build(const XgcOptions& options = {}) const {
        return XgcMesh(mesh, topology, segments, segmentCount, options);
    }
};

Subject subjectOf(const Model& model) {
    Subject s;
    WeldReport report;
    REQUIRE(weld(model, {}, s.mesh, report).ok());
    s.topology = buildTopology(s.mesh);
    s.segments.assign(s.mesh.faces.size(), 0);
    return s;
}

/// Segments by the octant of the face's middle, counted from the mesh's own.
Subject inOctants(Subject s) {
    glm::vec3 middle(0);
    for (const glm::vec3& p : s.mesh.positions) middle += p / float(s.mesh.positions.size());
    for (uint32_t f = 0; f < s.mesh.faceCount(); ++f) {
        const glm::uvec3 c = s.mesh.facePositions(f);
        const glm::vec3 at = (s.mesh.positions[c.x] + s.mesh.positions[c.y] + s.mesh.positions[c.z]) / 3.0f - middle;
        s.segments[f] = uint32_t(at.x > 0) + 2 * uint32_t(at.y > 0) + 4 * uint32_t(at.z > 0);
    }
    s.segmentCount = 8;
    return s;
}

/// All that can be seen of a mesh: live faces with their corners, edges and normals, live edges with theirs.
std::vector<uint32_t> visible(const XgcMesh& x) {
    std::vector<uint32_t> out;
    const auto add = [&](const auto& value) {
        std::array<uint32_t, sizeof(value) / 4> words{};
        std::memcpy(words.data(), &value, sizeof(value));
        out.insert(out.end(), words.begin(), words.end());
    };
    for (const XgcMesh::Face& f : x.faces()) {
        add(uint32_t(f.ghost));
        add(f.edges);
        add(f.wedges);
        add(f.normal);
    }
    for (uint32_t e = 0; e < x.edges().size(); ++e) {
        add(uint32_t(x.edges()[e].ghost));
        add(x.edges()[e].ends);
        const std::span<const uint32_t> faces = x.facesOf(e);
        std::set<uint32_t> sorted(faces.begin(), faces.end());
        out.insert(out.end(), sorted.begin(), sorted.end());
    }
    for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
        add(x.vertices()[v].position);
        add(uint32_t(x.vertices()[v].ghost));
        add(x.vertices()[v].genealogy);
    }
    return out;
}

using Corner = std::array<float, 3>;
/// The live triangles as sorted corner positions that start at the least.
std::multiset<std::array<Corner, 3>> soup(const XgcMesh& x, uint32_t segment = kNone) {
    std::multiset<std::array<Corner, 3>> out;
    for (uint32_t f = 0; f < x.faces().size(); ++f) {
        if (x.faces()[f].ghost || (segment != kNone && x.faces()[f].segment != segment)) continue;
        const glm::uvec3 c = x.cornersOf(f);
        std::array<Corner, 3> t;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 p = x.vertices()[c[k]].position;
            t[k] = {p.x, p.y, p.z};
        }
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        out.insert(t);
    }
    return out;
}

} // namespace

TEST_CASE("refining restores every level to the bit") {
    for (const Subject& s : {subjectOf(test::sphere(16)), inOctants(subjectOf(test::sphere(16))),
                             inOctants(subjectOf(test::cube(12))), subjectOf(test::grid(20))}) {
        XgcMesh x = s.build();
        std::vector<std::vector<uint32_t>> levels;
        do {
            levels.push_back(visible(x));
        } while (x.simplifyAll().collapses > 0);
        CHECK(levels.size() > 3);
        // Segments stall at different levels: refine those that stand highest.
        for (uint32_t level = uint32_t(levels.size()) - 1; level-- > 0;) {
            for (uint32_t segment = 0; segment < x.segmentCount(); ++segment) {
                if (x.level(segment) > level) CHECK(x.refine(segment));
            }
            CHECK(visible(x) == levels[level]);
        }
        CHECK(!x.refineAll());
    }
}

TEST_CASE("a segment's levels do not depend on its neighbours'") {
    const Subject s = inOctants(subjectOf(test::sphere(16)));
    XgcMesh x = s.build();
    using Soup = std::multiset<std::array<Corner, 3>>;
    std::vector<std::vector<Soup>> expected(s.segmentCount);
    for (uint32_t segment = 0; segment < s.segmentCount; ++segment) {
        do {
            expected[segment].push_back(soup(x, segment));
        } while (x.simplify(segment).collapses > 0);
    }
    std::mt19937 random(3);
    for (int step = 0; step < 400; ++step) {
        const uint32_t segment = uint32_t(random() % s.segmentCount);
        if (random() % 2) {
            x.simplify(segment);
        } else {
            x.refine(segment);
        }
        for (uint32_t other = 0; other < s.segmentCount; ++other) {
            REQUIRE(soup(x, other) == expected[other][x.level(other)]);
        }
    }
}
