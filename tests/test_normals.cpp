#include "meshes/builders.h"

#include <xgc/bake/normals.h>

#include <doctest/doctest.h>

using namespace xgc;
using namespace xgc::bake;

namespace {

Mesh withNormals(const Model& model) {
    Mesh mesh = test::welded(model);
    addMissingNormals(mesh, buildTopology(mesh));
    REQUIRE(mesh.attributes.normals.size() == mesh.wedgePosition.size());
    return mesh;
}

} // namespace

TEST_CASE("a cube gets a wedge for each side along its edges and flat normals") {
    const Mesh mesh = withNormals(test::cube(2));
    CHECK(mesh.positions.size() == 26);
    CHECK(mesh.wedgePosition.size() == 6 * 9);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        const glm::vec3 n = glm::normalize(
            glm::cross(mesh.positions[p.y] - mesh.positions[p.x], mesh.positions[p.z] - mesh.positions[p.x]));
        for (int k = 0; k < 3; ++k) CHECK(glm::dot(mesh.attributes.normals[mesh.faces[f][k]], n) > 0.9999f);
    }
}

TEST_CASE("a sphere gets one smooth normal for each position") {
    const Mesh mesh = withNormals(test::sphere(16));
    CHECK(mesh.wedgePosition.size() == mesh.positions.size());
    for (uint32_t w = 0; w < mesh.wedgePosition.size(); ++w) {
        CHECK(glm::dot(mesh.attributes.normals[w], mesh.positions[mesh.wedgePosition[w]]) > 0.99f);
    }
}

TEST_CASE("normals that the mesh has are kept") {
    Model model = test::grid(2);
    model.attributes.normals.assign(model.positions.size(), glm::vec3(1, 0, 0));
    const Mesh mesh = withNormals(model);
    for (const glm::vec3& n : mesh.attributes.normals) CHECK(n == glm::vec3(1, 0, 0));
}

TEST_CASE("faces without area neither crease nor break the normals of others") {
    Model model = test::modelOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}, {0, 2, 1}});
    const Mesh mesh = withNormals(model);
    for (uint32_t w = 0; w < mesh.wedgePosition.size(); ++w) CHECK(mesh.attributes.normals[w] == glm::vec3(0, 0, 1));
}
