#include "meshes/builders.h"

#include <xgc/bake/mesh.h>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

using namespace xgc::bake;
using xgc::test::cube;
using xgc::test::grid;
using xgc::test::modelOf;

namespace {

struct Welded {
    Mesh mesh;
    WeldReport report;
};

Welded welded(const Model& model, float tolerance = 0) {
    Welded w;
    WeldOptions options;
    options.tolerance = tolerance;
    const Status s = weld(model, options, w.mesh, w.report);
    INFO(s.message);
    REQUIRE(s.ok());
    return w;
}

std::string refusal(const Model& model) {
    Mesh mesh;
    WeldReport report;
    mesh.inputFaceCount = 77;
    const Status s = weld(model, {}, mesh, report);
    CHECK(s.outcome == Outcome::badInput);
    CHECK(mesh.inputFaceCount == 77);
    return s.message;
}

/// Triangles over few random positions: every kind of non-manifoldness.
Model soup(std::mt19937& random, uint32_t triangles, uint32_t points) {
    const auto point = [&] { return uint32_t(random() % points); };
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (uint32_t i = 0; i < points; ++i) p.emplace_back(float(i % 5), float(i % 7), float(i));
    for (uint32_t i = 0; i < triangles; ++i) t.emplace_back(point(), point(), point());
    return modelOf(p, t);
}

Model modelFrom(const Mesh& mesh) {
    Model model = modelOf({}, mesh.faces);
    for (const uint32_t p : mesh.wedgePosition) model.positions.push_back(mesh.positions[p]);
    model.attributes = mesh.attributes;
    model.triangleFace = mesh.faceInput;
    model.triangleMaterial = mesh.faceMaterial;
    model.triangleNode = mesh.faceNode;
    model.inputFaceCount = mesh.inputFaceCount;
    model.materials = mesh.materials;
    model.nodes = mesh.nodes;
    return model;
}

/// Coordinates of the corners of all faces.
std::vector<glm::vec3> corners(const Mesh& mesh) {
    std::vector<glm::vec3> out;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        for (int k = 0; k < 3; ++k) out.push_back(mesh.positions[mesh.facePositions(f)[k]]);
    }
    return out;
}

std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> edgesByMap(const Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> edges;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 c = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) edges[std::minmax({c[k], c[(k + 1) % 3]})].push_back(f);
    }
    return edges;
}

} // namespace

TEST_CASE("a cube of six loose sides welds into a closed manifold") {
    const Welded w = welded(cube(4));
    CHECK(w.mesh.faceCount() == 192);
    CHECK(w.mesh.positions.size() == 98);
    CHECK(w.mesh.wedgePosition.size() == 98);
    CHECK(w.report.components == 1);
    CHECK(w.report.closed());
    CHECK(w.report.nonManifoldEdges + w.report.nonManifoldVertices + w.report.inconsistentEdges == 0);
    CHECK(w.report.inputVertices == 150);
}

TEST_CASE("welding a welded mesh changes nothing") {
    Model model = cube(3);
    model.attributes.normals.assign(model.positions.size(), {0, 0, 1});
    for (size_t i = 0; i < 16; ++i) model.attributes.normals[i] = {1, 0, 0};
    const Welded once = welded(model), twice = welded(modelFrom(once.mesh));
    CHECK(once.mesh.faces == twice.mesh.faces);
    CHECK(once.mesh.positions == twice.mesh.positions);
    CHECK(once.mesh.wedgePosition == twice.mesh.wedgePosition);
    CHECK(once.mesh.attributes.normals == twice.mesh.attributes.normals);
}

TEST_CASE("the order of the vertex rows does not reach the welded mesh") {
    std::mt19937 random(3);
    const Model model = cube(5);
    std::vector<uint32_t> to(model.positions.size());
    std::iota(to.begin(), to.end(), 0u);
    std::shuffle(to.begin(), to.end(), random);
    Model shuffled = model;
    for (size_t i = 0; i < to.size(); ++i) shuffled.positions[to[i]] = model.positions[i];
    for (glm::uvec3& t : shuffled.triangles) t = {to[t.x], to[t.y], to[t.z]};
    const Welded a = welded(model), b = welded(shuffled);
    CHECK(a.mesh.faces == b.mesh.faces);
    CHECK(a.mesh.positions == b.mesh.positions);
}

TEST_CASE("positions and wedges are numbered by first use in face order") {
    const Welded w = welded(cube(3));
    uint32_t next = 0;
    for (const glm::uvec3& f : w.mesh.faces) {
        for (int k = 0; k < 3; ++k) {
            CHECK(f[k] <= next);
            next = std::max(next, f[k] + 1);
        }
    }
    CHECK(next == w.mesh.wedgePosition.size());
}

TEST_CASE("a UV seam gives two wedges over one position") {
    Model model = modelOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
    model.attributes.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {0.5f, 1}, {0, 1}};
    const Welded w = welded(model);
    CHECK(w.mesh.positions.size() == 4);
    CHECK(w.mesh.wedgePosition.size() == 5); // (1, 1, 0) twice
    CHECK(w.mesh.wedgePosition[w.mesh.faces[0].z] == w.mesh.wedgePosition[w.mesh.faces[1].y]);
    CHECK(w.mesh.faces[0].z != w.mesh.faces[1].y);
    CHECK(w.mesh.faces[0].x == w.mesh.faces[1].x);
}

TEST_CASE("morph displacements and joints part wedges") {
    Model model = modelOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
    model.attributes.morphTargets.push_back({"m", std::vector<glm::vec3>(6, glm::vec3(1)), {}, {}});
    model.attributes.joints[0].assign(6, {0, 0, 0, 0});
    CHECK(welded(model).mesh.wedgePosition.size() == 4);
    model.attributes.morphTargets[0].positions[3] = {2, 0, 0};
    CHECK(welded(model).mesh.wedgePosition.size() == 5);
    model.attributes.joints[0][4].x = 1;
    CHECK(welded(model).mesh.wedgePosition.size() == 6);
}

TEST_CASE("minus zero is zero, and one ulp apart is apart unless a tolerance joins it") {
    const float above = std::nextafter(1.0f, 2.0f);
    const Model model =
        modelOf({{-0.0f, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, -0.0f}, {above, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
    CHECK(welded(model).mesh.positions.size() == 5);
    CHECK(welded(model, 0.25f).mesh.positions.size() == 4);
    CHECK(!std::signbit(welded(model).mesh.positions[0].x));
}

TEST_CASE("repeated positions and duplicates go; thin, flipped and zero-area faces stay and are counted") {
    const Model model =
        modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 0, 0}}, {{0, 1, 2},   // kept
                                                                          {1, 2, 0},   // duplicate, turned
                                                                          {0, 2, 1},   // back to back
                                                                          {0, 1, 4},   // two rows of one position
                                                                          {0, 1, 3},   // zero area
                                                                          {0, 4, 2}}); // duplicate through another row
    const Welded w = welded(model);
    CHECK(w.mesh.faceInput == std::vector<uint32_t>{0, 2, 4});
    CHECK(w.report.repeatedPositionFaces == 1);
    CHECK(w.report.duplicateFaces == 2);
    CHECK(w.report.backToBackPairs == 1);
    CHECK(w.report.zeroAreaFaces == 1);
    CHECK(w.report.inputFaces == 6);
}

TEST_CASE("rows that only dropped faces use leave no trace") {
    const Model model = modelOf({{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 2, 3}});
    const Welded w = welded(model);
    CHECK(w.mesh.positions.size() == 3);
    CHECK(w.mesh.faces[0] == glm::uvec3(0, 1, 2));
}

TEST_CASE("values that are not finite are refused with vertex and face named") {
    Model model = grid(4);
    model.positions[7].y = std::numeric_limits<float>::quiet_NaN();
    CHECK(refusal(model) ==
          "test: the position of vertex 7 (first used by face 2) is not finite (0.5, nan, 0); repair the file in a "
          "modelling tool, or drop that face");
    model = grid(4);
    model.positions.emplace_back(std::numeric_limits<float>::infinity(), 0, 0);
    CHECK(refusal(model).find("vertex 25 (used by no face)") != std::string::npos);
    model = grid(4);
    model.attributes.uvs[1].assign(model.positions.size(), {0, 0});
    model.attributes.uvs[1][3].x = -std::numeric_limits<float>::infinity();
    CHECK(refusal(model).find("vertex 3 (first used by face 4): the UV 1 is not finite") != std::string::npos);
}

TEST_CASE("models that contradict themselves are refused") {
    Model model = grid(2);
    model.triangles[3].y = 100;
    CHECK(refusal(model).find("face 3 uses a vertex past the last one") != std::string::npos);
    model = grid(2);
    model.attributes.normals.resize(2);
    CHECK(refusal(model).find("\"normal\" has 2 rows for 9") != std::string::npos);
    model = grid(2);
    model.triangleMaterial[1] = 1;
    CHECK(refusal(model).find("material 1 of 1") != std::string::npos);
    CHECK(refusal(modelOf({}, {})).find("no triangle") != std::string::npos);
    CHECK(refusal(modelOf({{0, 0, 0}}, {{0, 0, 0}})).find("repeats a position") != std::string::npos);
}

TEST_CASE("an open grid has its rim as border and one component") {
    const Welded w = welded(grid(6));
    CHECK(w.report.borderEdges == 24);
    CHECK(w.report.nonManifoldVertices == 0);
    CHECK(w.report.components == 1);
    CHECK(!w.report.closed());
}

TEST_CASE("a flipped face, a bow tie and a fin are classified") {
    Model flipped = grid(1);
    std::swap(flipped.triangles[1].x, flipped.triangles[1].y);
    CHECK(welded(flipped).report.inconsistentEdges == 1);

    const Welded bow =
        welded(modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
    CHECK(bow.report.nonManifoldVertices == 1);
    CHECK(bow.report.components == 2);

    const Welded fin =
        welded(modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    CHECK(fin.report.nonManifoldEdges == 1);
    CHECK(fin.report.nonManifoldVertices == 2);
    CHECK(fin.report.oddEdges == fin.report.borderEdges + 1);
}

TEST_CASE("the topology of random soups is what brute force finds") {
    std::mt19937 random(11);
    for (int round = 0; round < 60; ++round) {
        const Welded w = welded(soup(random, 5 + uint32_t(random() % 120), 4 + uint32_t(random() % 30)));
        const Topology t = buildTopology(w.mesh);
        const auto expected = edgesByMap(w.mesh);
        REQUIRE(t.edges.size() == expected.size());
        uint32_t e = 0, borders = 0, nonManifold = 0;
        for (const auto& [ends, faces] : expected) { // a map is sorted, and so are the edges
            REQUIRE(t.edges[e] == glm::uvec2(ends.first, ends.second));
            const auto found = t.facesOfEdge(e);
            REQUIRE(std::vector<uint32_t>(found.begin(), found.end()) == faces);
            borders += faces.size() == 1;
            nonManifold += faces.size() > 2;
            ++e;
        }
        CHECK(borders == w.report.borderEdges);
        CHECK(nonManifold == w.report.nonManifoldEdges);
        for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
            const glm::uvec3 c = w.mesh.facePositions(f);
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax({c[k], c[(k + 1) % 3]});
                REQUIRE(t.edges[t.faceEdges[f][k]] == glm::uvec2(low, high));
            }
        }
        for (uint32_t v = 0; v < w.mesh.positions.size(); ++v) {
            std::vector<uint32_t> around;
            for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
                const glm::uvec3 c = w.mesh.facePositions(f);
                if (c.x == v || c.y == v || c.z == v) around.push_back(f);
            }
            const auto found = t.facesOfVertex(v);
            REQUIRE(std::vector<uint32_t>(found.begin(), found.end()) == around);
        }
    }
}

TEST_CASE("components are numbered by lowest face and agree with flooding") {
    std::mt19937 random(5);
    for (int round = 0; round < 40; ++round) {
        const Welded w = welded(soup(random, 40, 60));
        const Topology t = buildTopology(w.mesh);
        std::vector<uint32_t> flooded(w.mesh.faceCount(), kNone);
        uint32_t count = 0;
        for (uint32_t start = 0; start < w.mesh.faceCount(); ++start) {
            if (flooded[start] != kNone) continue;
            std::vector<uint32_t> stack{start};
            flooded[start] = count;
            while (!stack.empty()) {
                const uint32_t f = stack.back();
                stack.pop_back();
                for (int k = 0; k < 3; ++k) {
                    for (const uint32_t g : t.facesOfEdge(t.faceEdges[f][k])) {
                        if (flooded[g] != kNone) continue;
                        flooded[g] = count;
                        stack.push_back(g);
                    }
                }
            }
            ++count;
        }
        CHECK(t.componentCount == count);
        CHECK(t.faceComponent == flooded);
    }
}

TEST_CASE("non-manifold vertices of random soups are what the definition says") {
    std::mt19937 random(8);
    for (int round = 0; round < 60; ++round) {
        const Welded w = welded(soup(random, 3 + uint32_t(random() % 40), 5 + uint32_t(random() % 20)));
        const auto edges = edgesByMap(w.mesh);
        uint32_t expected = 0;
        for (uint32_t v = 0; v < w.mesh.positions.size(); ++v) {
            std::map<uint32_t, std::set<uint32_t>> fans; // face: its fan, merged across edges of at most two faces
            bool wild = false;
            for (const auto& [ends, faces] : edges) {
                if (ends.first != v && ends.second != v) continue;
                wild = wild || faces.size() > 2;
                std::set<uint32_t> fan;
                for (const uint32_t f : faces) {
                    fan.insert(f);
                    fan.insert(fans[f].begin(), fans[f].end());
                }
                for (const uint32_t f : std::set<uint32_t>(fan)) fans[f] = fan;
            }
            expected += wild || (!fans.empty() && fans.begin()->second.size() != fans.size());
        }
        CHECK(w.report.nonManifoldVertices == expected);
    }
}

TEST_CASE("welding keeps the faces where they were") {
    std::mt19937 random(2);
    const Model model = soup(random, 200, 40);
    const Welded w = welded(model);
    const std::vector<glm::vec3> after = corners(w.mesh);
    for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
        for (int k = 0; k < 3; ++k) CHECK(after[f * 3 + k] == model.positions[model.triangles[w.mesh.faceInput[f]][k]]);
    }
}
