#include "meshes/builders.h"

#include <xgc/bake/xgc_mesh.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
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

namespace {

uint32_t liveVertices(const XgcMesh& x) {
    return uint32_t(std::ranges::count_if(x.vertices(), [](const auto& v) { return v.firstUse != kNone; }));
}

/// Live edges keep two faces each, one edge joins two vertices, and the Euler characteristic stays.
void checkTopology(const XgcMesh& x, int euler) {
    std::set<std::pair<uint32_t, uint32_t>> pairs;
    int edges = 0;
    for (uint32_t e = 0; e < x.edges().size(); ++e) {
        const XgcMesh::Edge& edge = x.edges()[e];
        if (edge.ghost) continue;
        ++edges;
        CHECK(pairs.emplace(std::minmax(edge.ends[0], edge.ends[1])).second);
        for (const uint32_t f : x.facesOf(e)) {
            CHECK(!x.faces()[f].ghost);
            CHECK(std::ranges::count(x.faces()[f].edges, e) == 1);
        }
    }
    CHECK(int(liveVertices(x)) - edges + int(x.faceCount()) == euler);
}

Model rotated(Model model, uint32_t seed) {
    std::mt19937 random(seed);
    const auto next = [&] { return float(random() % 2001) / 1000.0f - 1; };
    glm::vec4 q(next(), next(), next(), next());
    q /= std::sqrt(glm::dot(q, q) + 1e-9f);
    const float w = q.w, a = q.x, b = q.y, c = q.z;
    const glm::mat3 m(1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b), 2 * (a * b - w * c),
                      1 - 2 * (a * a + c * c), 2 * (b * c + w * a), 2 * (a * c + w * b), 2 * (b * c - w * a),
                      1 - 2 * (a * a + b * b));
    for (glm::vec3& p : model.positions) p = m * p;
    return model;
}

/// Whether a position of the unit cube lies on an edge of it.
bool onCubeEdge(glm::vec3 p) {
    return int(std::abs(p.x) == 0.5f) + int(std::abs(p.y) == 0.5f) + int(std::abs(p.z) == 0.5f) >= 2;
}

} // namespace

TEST_CASE("no collapse breaks the surface") {
    for (const Subject& s : {subjectOf(test::sphere(12)), inOctants(subjectOf(test::sphere(12)))}) {
        XgcMesh x = s.build();
        checkTopology(x, 2);
        while (x.simplifyAll().collapses > 0) checkTopology(x, 2);
        while (x.refineAll()) checkTopology(x, 2);
    }
    XgcMesh open = subjectOf(test::grid(12)).build();
    checkTopology(open, 1);
    while (open.simplifyAll().collapses > 0) checkTopology(open, 1);
    CHECK(open.faceCount() < 288 / 4);
}

TEST_CASE("no face lies 90 degrees or more away from itself at level 0") {
    for (const Subject& s : {subjectOf(test::sphere(12)), inOctants(subjectOf(test::sphere(12))),
                             inOctants(subjectOf(test::cube(9))), subjectOf(test::grid(15))}) {
        XgcMesh x = s.build();
        while (x.simplifyAll().collapses > 0) {
            for (const XgcMesh::Face& f : x.faces()) {
                if (!f.ghost) CHECK(glm::dot(f.normal, f.baseNormal) > 0);
            }
        }
    }
}

TEST_CASE("boundaries, creases and apices stay where they are") {
    for (const Subject& s : {inOctants(subjectOf(test::sphere(16))), inOctants(subjectOf(test::cube(9))),
                             subjectOf(test::cube(9)), subjectOf(test::grid(9))}) {
        XgcMesh x = s.build();
        std::vector<std::pair<uint32_t, glm::vec3>> locked;
        for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
            if (x.vertices()[v].boundary || x.curvatureOf(v) >= 0.5) locked.emplace_back(v, x.vertices()[v].position);
        }
        CHECK(locked.size() > 30);
        while (x.simplifyAll().collapses > 0) {
            for (const auto& was : locked) {
                const XgcMesh::Vertex& is = x.vertices()[was.first];
                CHECK(!is.ghost);
                CHECK(is.firstUse != kNone);
                CHECK(is.position == was.second);
            }
        }
        CHECK(x.faceCount() < s.mesh.faceCount());
    }
}

TEST_CASE("a cube keeps its edges and corners however it is turned") {
    const Subject straight = subjectOf(test::cube(6));
    for (uint32_t seed = 1; seed <= 60; ++seed) {
        Subject s = straight; // the same welded cube, turned
        Model positions;
        positions.positions = s.mesh.positions;
        s.mesh.positions = rotated(positions, seed).positions;
        XgcMesh x = s.build();
        while (x.simplifyAll().collapses > 0) {
        }
        CHECK(x.faceCount() < s.mesh.faceCount());
        for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
            if (!onCubeEdge(straight.mesh.positions[v])) continue;
            CHECK(!x.vertices()[v].ghost);
            CHECK(x.vertices()[v].sharpSince == 0);
        }
    }
}

TEST_CASE("curvature norms at the edges and corners of a cube") {
    const Subject s = subjectOf(test::cube(6));
    XgcOptions options;
    const auto curvatures = [&](CurvatureNorm norm) {
        options.curvature = norm;
        const XgcMesh x = s.build(options);
        std::array<double, 2> found{}; // corner; least on an edge
        found[1] = 9;
        for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
            const glm::vec3 p = glm::abs(x.vertices()[v].position);
            if (p == glm::vec3(0.5f))
                found[0] = std::max(found[0], x.curvatureOf(v));
            else if (onCubeEdge(p))
                found[1] = std::min(found[1], x.curvatureOf(v));
        }
        return found;
    };
    const std::array<double, 2> trace = curvatures(CurvatureNorm::trace);
    CHECK(trace[0] == doctest::Approx(0.8165).epsilon(1e-3)); // sqrt(2/3): as many faces on each side
    CHECK(trace[1] == doctest::Approx(0.7071).epsilon(1e-3));
    CHECK(curvatures(CurvatureNorm::frobenius)[0] == doctest::Approx(0.4714).epsilon(1e-3)); // under the lock
}

TEST_CASE("Hoppe vectors lead back to the ancestors") {
    const Subject s = inOctants(subjectOf(test::sphere(16)));
    XgcMesh x = s.build();
    while (x.simplifyAll().collapses > 0) {
    }
    uint32_t wings = 0;
    for (const Genealogy& g : x.genealogies()) {
        const glm::vec3 k = x.vertices()[x.vertexOf(g.wedge)].position;
        const bool wing = g.type == CollapseType::wing;
        wings += wing;
        if (wing) CHECK(x.vertexOf(g.wedge) == g.ancestors[1]);
        CHECK(glm::distance(k + g.hoppe, x.vertices()[g.ancestors[0]].position) < 1e-6f);
        CHECK(glm::distance(wing ? k : k - g.hoppe, x.vertices()[g.ancestors[1]].position) < 1e-6f);
        const std::array<uint32_t, 2> was = x.edgeStates()[x.edges()[g.edge].stack].ends;
        CHECK(std::minmax(was[0], was[1]) == std::minmax(g.ancestors[0], g.ancestors[1]));
    }
    CHECK(wings > 20);
    CHECK(wings + 20 < x.genealogies().size());
}

TEST_CASE("attribute seams stay, and every face keeps the wedges of its side") {
    // A grid whose left and right half have charts of their own: the middle column has two wedges a position.
    Model model = test::grid(16);
    auto& uvs = model.attributes.uvs[0];
    for (const glm::vec3& p : model.positions) uvs.emplace_back(p.x, p.y);
    const auto middle = uint32_t(model.positions.size());
    for (uint32_t j = 0; j <= 16; ++j) {
        model.positions.push_back(model.positions[j * 17 + 8]);
        uvs.emplace_back(10.5f, float(j) / 16);
    }
    for (uint32_t v = 0; v < middle; ++v) {
        if (v % 17 > 8) uvs[v].x += 10;
    }
    for (glm::uvec3& t : model.triangles) {
        const bool right = (t.x % 17) > 8 || (t.y % 17) > 8 || (t.z % 17) > 8;
        for (int k = 0; k < 3; ++k) {
            if (right && t[k] % 17 == 8) t[k] = middle + t[k] / 17;
        }
    }
    const Subject s = subjectOf(model);
    REQUIRE(s.mesh.wedgePosition.size() == s.mesh.positions.size() + 17);
    XgcMesh x = s.build();
    while (x.simplifyAll().collapses > 0) {
    }
    CHECK(x.faceCount() < 300);
    uint32_t seamCorners = 0;
    for (const XgcMesh::Face& f : x.faces()) {
        if (f.ghost) continue;
        float center = 0;
        for (const uint32_t w : f.wedges) center += x.vertices()[x.vertexOf(w)].position.x / 3;
        for (const uint32_t w : f.wedges) {
            const glm::vec3 p = x.vertices()[x.vertexOf(w)].position;
            if (w >= x.baseWedgeCount()) continue;
            CHECK(s.mesh.attributes.uvs[0][w].x == p.x + (center > 0.5f ? 10 : 0));
            seamCorners += p.x == 0.5f;
        }
    }
    CHECK(seamCorners >= 2 * 3 * 16);
    for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
        if (x.vertices()[v].position.x == 0.5f) CHECK(!x.vertices()[v].ghost);
    }
}

TEST_CASE("what has nothing to collapse stays as it is") {
    const Subject triangle = subjectOf(test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
    const Subject tetrahedron = subjectOf(
        test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}));
    const Subject backToBack = subjectOf(test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}));
    XgcOptions unlocked;
    unlocked.lockCurvature = 9;
    for (const Subject& s : {triangle, tetrahedron, backToBack}) {
        XgcMesh x = s.build(unlocked);
        CHECK(x.simplifyAll().collapses == 0);
        CHECK(x.level(0) == 0);
        CHECK(!x.refineAll());
        CHECK(x.faceCount() == s.mesh.faceCount());
    }
}

TEST_CASE("edges of three faces and pinched vertices are locked") {
    // Three square pages along x = 0, and two of them again, point to point with the last corner.
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    const auto page = [&](glm::vec3 origin, glm::vec3 u, glm::vec3 v) {
        const auto base = uint32_t(p.size());
        for (int j = 0; j <= 8; ++j) {
            for (int i = 0; i <= 8; ++i) p.push_back(origin + u * (float(i) / 8) + v * (float(j) / 8));
        }
        for (uint32_t j = 0; j < 8; ++j) {
            for (uint32_t i = 0; i < 8; ++i) {
                const uint32_t a = base + j * 9 + i;
                t.emplace_back(a, a + 1, a + 10);
                t.emplace_back(a, a + 10, a + 9);
            }
        }
    };
    page({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    page({0, 0, 0}, {-1, 0, 0}, {0, 1, 0});
    page({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
    page({1, 1, 0}, {1, 0, 0}, {0, 1, 0});
    const Subject s = subjectOf(test::modelOf(p, t));
    XgcMesh x = s.build();
    const std::vector<uint32_t> before = visible(x);
    uint32_t crowded = 0;
    for (uint32_t e = 0; e < x.edges().size(); ++e) crowded += x.facesOf(e).size() == 3;
    CHECK(crowded == 8);
    while (x.simplifyAll().collapses > 0) {
    }
    CHECK(x.faceCount() < 300);
    for (uint32_t v = 0; v < x.baseVertexCount(); ++v) {
        const glm::vec3 at = x.vertices()[v].position;
        if ((at.x == 0 && at.z == 0) || at == glm::vec3(1, 1, 0))
            CHECK((x.vertices()[v].boundary && !x.vertices()[v].ghost));
    }
    while (x.refineAll()) {
    }
    CHECK(visible(x) == before);
}

TEST_CASE("a crease by dihedral angle is not shortened") {
    const Subject s = subjectOf(test::cube(8));
    XgcOptions options;
    options.lockCurvature = 9;
    const auto sharpEdges = [](const XgcMesh& x) {
        uint32_t count = 0;
        for (uint32_t e = 0; e < x.edges().size(); ++e) {
            if (x.edges()[e].ghost) continue;
            const auto faces = x.facesOf(e);
            count += glm::dot(x.faces()[faces[0]].normal, x.faces()[faces[1]].normal) < 0.5f;
        }
        return count;
    };
    XgcMesh unlocked = s.build(options);
    options.lockDihedralCosine = 0.5f;
    XgcMesh locked = s.build(options);
    CHECK(sharpEdges(locked) == 96);
    unlocked.simplifyAll();
    const XgcPass pass = locked.simplifyAll();
    CHECK(pass.collapses > 0);
    CHECK(locked.faceCount() >= unlocked.faceCount());
    for (const Genealogy& g : locked.genealogies()) {
        const std::array<uint32_t, 2> faces = locked.edges()[g.edge].faces;
        CHECK(glm::dot(locked.faces()[faces[0]].baseNormal, locked.faces()[faces[1]].baseNormal) >= 0.5f);
    }
}

TEST_CASE("the same mesh gives the same levels in either order of edges") {
    const Subject s = inOctants(subjectOf(test::sphere(10)));
    for (const EdgeOrder order : {EdgeOrder::flattestFirst, EdgeOrder::byIndex}) {
        XgcOptions options;
        options.order = order;
        XgcMesh x = s.build(options), y = s.build(options);
        while (x.simplifyAll().collapses > 0) {
        }
        for (uint32_t segment = s.segmentCount; segment-- > 0;) {
            while (y.simplify(segment).collapses > 0) {
            }
        }
        CHECK(soup(x) == soup(y));
    }
}
