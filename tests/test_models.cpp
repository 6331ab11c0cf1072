#include <xgc/bake/mesh.h>
#include <xgc/bake/models.h>

#include <doctest/doctest.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

using namespace xgc::bake;

namespace {

constexpr BundledModel kAll[] = {BundledModel::creature, BundledModel::shaft, BundledModel::terrain,
                                 BundledModel::temple, BundledModel::tree};

struct Welded {
    Mesh mesh;
    WeldReport report;
    Topology topology;
};

Welded welded(const Model& model) {
    Welded w;
    REQUIRE(weld(model, {}, w.mesh, w.report).ok());
    w.topology = buildTopology(w.mesh);
    return w;
}

uint32_t oddEdges(const Welded& w) {
    uint32_t odd = 0;
    for (uint32_t e = 0; e < w.topology.edges.size(); ++e) odd += uint32_t(w.topology.facesOfEdge(e).size() % 2);
    return odd;
}

bool isManifold(const Welded& w) {
    return w.report.nonManifoldEdges == 0 && w.report.nonManifoldVertices == 0 && w.report.inconsistentEdges == 0;
}

int64_t eulerCharacteristic(const Welded& w) {
    return int64_t(w.mesh.positions.size()) - int64_t(w.topology.edges.size()) + int64_t(w.mesh.faces.size());
}

glm::vec3 cross(const Model& model, glm::uvec3 t) {
    const glm::vec3 a = model.positions[t.x];
    return glm::cross(model.positions[t.y] - a, model.positions[t.z] - a);
}

double signedVolume(const Model& model) {
    double volume = 0;
    for (const glm::uvec3 t : model.triangles) volume += double(glm::dot(model.positions[t.x], cross(model, t))) / 6;
    return volume;
}

/// Area of faces that a corner's normal points away from, over the whole area.
double areaAgainstNormals(const Model& model) {
    double all = 0, against = 0;
    for (const glm::uvec3 t : model.triangles) {
        const glm::vec3 n = cross(model, t);
        const double area = std::sqrt(double(glm::dot(n, n)));
        all += area;
        for (int k = 0; k < 3; ++k) {
            if (glm::dot(n, model.attributes.normals[t[k]]) > 0) continue;
            against += area;
            break;
        }
    }
    return against / all;
}

template <typename T>
void update(XXH64_state_t* state, const std::vector<T>& values) {
    XXH64_update(state, values.data(), values.size() * sizeof(T));
}

uint64_t hashOf(const Model& model) {
    XXH64_state_t* state = XXH64_createState();
    XXH64_reset(state, 0);
    update(state, model.positions);
    update(state, model.attributes.normals);
    update(state, model.attributes.uvs[0]);
    update(state, model.attributes.colors[0]);
    update(state, model.triangles);
    update(state, model.triangleMaterial);
    update(state, model.triangleNode);
    const uint64_t hash = XXH64_digest(state);
    XXH64_freeState(state);
    return hash;
}

} // namespace

TEST_CASE("every model has about the faces that were asked for") {
    for (const BundledModel which : kAll) {
        for (const uint32_t faces : {200u, 300u, 450u, 1000u, 4499u, 4500u, 8000u, 20000u, 41000u, 200000u}) {
            const Model model = makeModel(which, faces);
            CAPTURE(int(which));
            CAPTURE(faces);
            CHECK(double(model.triangles.size()) >= 0.9 * faces);
            CHECK(double(model.triangles.size()) <= 1.1 * faces);
        }
    }
}

TEST_CASE("every model is well formed: columns fit, indices are in range, numbers finite, normals unit") {
    for (const BundledModel which : kAll) {
        const Model model = makeModel(which, 45000);
        CAPTURE(int(which));
        const size_t rows = model.positions.size(), faces = model.triangles.size();
        CHECK(model.attributes.normals.size() == rows);
        CHECK((model.attributes.uvs[0].empty() || model.attributes.uvs[0].size() == rows));
        CHECK((model.attributes.colors[0].empty() || model.attributes.colors[0].size() == rows));
        CHECK(model.triangleFace.size() == faces);
        CHECK(model.triangleMaterial.size() == faces);
        CHECK(model.triangleNode.size() == faces);
        CHECK(model.inputFaceCount == faces);
        std::vector<char> used(rows, 0);
        bool inRange = true;
        for (size_t f = 0; f < faces; ++f) {
            for (int k = 0; k < 3; ++k) {
                inRange = inRange && model.triangles[f][k] < rows;
                if (inRange) used[model.triangles[f][k]] = 1;
            }
            inRange = inRange && model.triangleMaterial[f] < model.materials.size() &&
                      model.triangleNode[f] < model.nodes.size();
        }
        CHECK(inRange);
        CHECK(std::count(used.begin(), used.end(), 0) == 0);
        bool finite = true, unit = true;
        for (size_t row = 0; row < rows; ++row) {
            const glm::vec3 p = model.positions[row], n = model.attributes.normals[row];
            finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
            unit = unit && std::abs(glm::dot(n, n) - 1) < 1e-5f;
        }
        CHECK(finite);
        CHECK(unit);
        std::set<std::string> names;
        for (const Material& material : model.materials) names.insert(material.name);
        CHECK(names.size() == model.materials.size());
        CHECK(names.count("") == 0);
    }
}

TEST_CASE("normals agree with the faces") {
    CHECK(areaAgainstNormals(makeModel(BundledModel::creature, 60000)) < 0.002);
    CHECK(areaAgainstNormals(makeModel(BundledModel::creature, 4000)) < 0.02);
    CHECK(areaAgainstNormals(makeModel(BundledModel::shaft, 60000)) == 0);
    CHECK(areaAgainstNormals(makeModel(BundledModel::terrain, 60000)) < 0.003);
    CHECK(areaAgainstNormals(makeModel(BundledModel::temple, 100000)) < 0.01);
    CHECK(areaAgainstNormals(makeModel(BundledModel::tree, 50000)) < 0.03);
}

TEST_CASE("the creature is one closed manifold at any size") {
    for (const uint32_t faces : {200u, 333u, 1000u, 2500u, 6000u, 15000u, 60000u, 150000u}) {
        const Welded w = welded(makeModel(BundledModel::creature, faces));
        CAPTURE(faces);
        CHECK(w.report.closed());
        CHECK(isManifold(w));
        CHECK(w.report.components == 1);
        CHECK(w.report.repeatedPositionFaces == 0);
        CHECK(eulerCharacteristic(w) % 2 == 0);
        CHECK(eulerCharacteristic(w) <= 2);
        CHECK(eulerCharacteristic(w) >= -6); // coarse limbs may touch
        if (faces >= 60000) CHECK(eulerCharacteristic(w) == 2);
    }
}

TEST_CASE("the creature faces outward and keeps its volume over its sizes") {
    const double fine = signedVolume(makeModel(BundledModel::creature, 60000));
    CHECK(fine > 0.05);
    CHECK(signedVolume(makeModel(BundledModel::creature, 15000)) == doctest::Approx(fine).epsilon(0.05));
}

TEST_CASE("the shaft is one closed manifold at any size") {
    for (const uint32_t faces : {200u, 1000u, 2000u, 5000u, 12000u, 60000u}) {
        const Model model = makeModel(BundledModel::shaft, faces);
        const Welded w = welded(model);
        CAPTURE(faces);
        CHECK(w.report.closed());
        CHECK(isManifold(w));
        CHECK(w.report.components == 1);
        CHECK(eulerCharacteristic(w) == 2);
        CHECK(signedVolume(model) > 0.1);
    }
}

TEST_CASE("the shaft has hard creases where faces meet at an angle and none where it is round") {
    const Model model = makeModel(BundledModel::shaft, 30000);
    const Welded w = welded(model);
    uint32_t sharp = 0, sharpSplit = 0, split = 0;
    for (uint32_t e = 0; e < w.topology.edges.size(); ++e) {
        const auto faces = w.topology.facesOfEdge(e);
        REQUIRE(faces.size() == 2);
        glm::vec3 normal[2];
        std::set<uint32_t> wedges;
        for (int k = 0; k < 2; ++k) {
            const glm::uvec3 f = w.mesh.faces[faces[k]], p = w.mesh.facePositions(faces[k]);
            normal[k] = glm::normalize(glm::cross(w.mesh.positions[p.y] - w.mesh.positions[p.x],
                                                  w.mesh.positions[p.z] - w.mesh.positions[p.x]));
            for (int c = 0; c < 3; ++c) {
                if (p[c] == w.topology.edges[e].x || p[c] == w.topology.edges[e].y) wedges.insert(f[c]);
            }
        }
        const bool isSharp = glm::dot(normal[0], normal[1]) < 0.5f;
        sharp += isSharp;
        split += wedges.size() == 4;
        sharpSplit += isSharp && wedges.size() == 4;
    }
    CHECK(sharp > 1000);
    CHECK(sharpSplit == sharp);
    CHECK(split < w.topology.edges.size() / 5);
}

TEST_CASE("the terrain is an open sheet with one border loop") {
    for (const uint32_t faces : {200u, 3000u, 50000u}) {
        const Model model = makeModel(BundledModel::terrain, faces);
        const Welded w = welded(model);
        CAPTURE(faces);
        CHECK(isManifold(w));
        CHECK(w.report.components == 1);
        CHECK(eulerCharacteristic(w) == 1); // a disc: one loop
        CHECK(w.report.borderEdges >= 40);
        CHECK(!model.attributes.uvs[0].empty());
        CHECK(!model.attributes.colors[0].empty());
        for (const glm::uvec3 t : model.triangles) REQUIRE(cross(model, t).y > 0);
    }
}

TEST_CASE("the temple has pieces, materials, uv seams, closed and open components") {
    for (const uint32_t faces : {200u, 5000u, 60000u}) {
        const Model model = makeModel(BundledModel::temple, faces);
        const Welded w = welded(model);
        CAPTURE(faces);
        CHECK(std::set(model.triangleMaterial.begin(), model.triangleMaterial.end()).size() >= 4);
        CHECK(std::set(model.triangleNode.begin(), model.triangleNode.end()).size() == model.nodes.size());
        CHECK(model.nodes.size() >= 14);

        std::vector<uint32_t> borders(w.topology.componentCount, 0);
        for (uint32_t e = 0; e < w.topology.edges.size(); ++e) {
            const auto around = w.topology.facesOfEdge(e);
            borders[w.topology.faceComponent[around[0]]] += uint32_t(around.size() % 2);
        }
        const auto closed = std::count(borders.begin(), borders.end(), 0u);
        CHECK(closed >= 5);
        CHECK(closed + 3 <= std::ptrdiff_t(borders.size()));
        CHECK(oddEdges(w) > 0);

        // A seam: wedges of a position that differ in uv.
        std::vector<std::set<std::pair<float, float>>> uvs(w.mesh.positions.size());
        for (uint32_t wedge = 0; wedge < w.mesh.wedgePosition.size(); ++wedge) {
            const glm::vec2 uv = w.mesh.attributes.uvs[0][wedge];
            uvs[w.mesh.wedgePosition[wedge]].emplace(uv.x, uv.y);
        }
        CHECK(std::count_if(uvs.begin(), uvs.end(), [](const auto& set) { return set.size() > 1; }) > 50);
    }
}

TEST_CASE("the tree is one closed skin of bark, and leaf cards that are each an open piece of two triangles") {
    for (const uint32_t faces : {200u, 5000u, 50000u}) {
        const Model model = makeModel(BundledModel::tree, faces);
        const Welded w = welded(model);
        CAPTURE(faces);
        CHECK(isManifold(w));
        std::vector<uint32_t> borders(w.topology.componentCount, 0), sizes(w.topology.componentCount, 0);
        for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
            ++sizes[w.topology.faceComponent[f]];
            for (int k = 0; k < 3; ++k) {
                borders[w.topology.faceComponent[f]] +=
                    uint32_t(w.topology.facesOfEdge(w.topology.faceEdges[f][k]).size() == 1);
            }
        }
        const auto closed = std::count(borders.begin(), borders.end(), 0u);
        const auto cards = std::count(sizes.begin(), sizes.end(), 2u);
        CHECK(closed == 1);
        CHECK(cards + 1 == std::ptrdiff_t(borders.size()));
        CHECK(std::count(borders.begin(), borders.end(), 4u) == cards);
        if (faces == 50000) CHECK(std::abs(double(cards) - 20000) < 500);
    }
}

TEST_CASE("limits of faces are clamped") {
    CHECK(makeModel(BundledModel::terrain, 0).triangles.size() >= 180);
}

// Regenerate by running with XGC_PRINT_GOLDEN=1 and after a look at the models.
TEST_CASE("models are the same bits on any machine and compiler") {
    const std::map<BundledModel, std::array<uint64_t, 2>> golden = {
        {BundledModel::creature, {0x397634e2ac47da7c, 0x7702d54f45170103}},
        {BundledModel::shaft, {0x31eefdce2ddc6ac6, 0x851892bc17643abe}},
        {BundledModel::terrain, {0xcacdfca1e0e52bf0, 0xf78f912301b0810f}},
        {BundledModel::temple, {0xa2c61b5d1ebbf10d, 0xd30c7cf28299de9a}},
        {BundledModel::tree, {0x1e16f1511d01da03, 0xf44409a47f462600}},
    };
    for (const auto& entry : golden) {
        const BundledModel which = entry.first;
        const uint64_t coarse = hashOf(makeModel(which, 1000)), fine = hashOf(makeModel(which, 45000));
        CAPTURE(int(which));
        if (std::getenv("XGC_PRINT_GOLDEN")) {
            std::printf("{0x%016llx, 0x%016llx}\n", static_cast<unsigned long long>(coarse),
                        static_cast<unsigned long long>(fine));
        }
        CHECK(coarse == entry.second[0]);
        CHECK(fine == entry.second[1]);
    }
}
