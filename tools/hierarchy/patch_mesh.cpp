#include "hierarchy/patch_mesh.h"

#include <glm/geometric.hpp>

namespace xgc::bake {

namespace {

glm::vec3 unitNormal(const Mesh& mesh, uint32_t face) {
    const glm::uvec3 p = mesh.facePositions(face);
    const glm::dvec3 a(mesh.positions[p.x]);
    const glm::dvec3 n = glm::cross(glm::dvec3(mesh.positions[p.y]) - a, glm::dvec3(mesh.positions[p.z]) - a);
    const double length = glm::length(n);
    return length > 0 ? glm::vec3(n / length) : glm::vec3(0);
}

} // namespace

PatchMesh::PatchMesh(const Mesh& mesh, std::span<const uint32_t> faces, std::vector<uint32_t>& localOf)
    : face(faces.begin(), faces.end()) {
    corner.resize(3 * faces.size());
    wedge.resize(corner.size());
    link.resize(corner.size());
    normal.reserve(faces.size());
    position.reserve(faces.size() / 2 + 16);
    for (size_t f = 0; f < faces.size(); ++f) {
        normal.push_back(unitNormal(mesh, faces[f]));
        for (uint32_t k = 0; k < 3; ++k) {
            const auto c = uint32_t(3 * f + k);
            wedge[c] = mesh.faces[faces[f]][int(k)];
            const uint32_t p = mesh.wedgePosition[wedge[c]];
            if (localOf[p] == kNone) {
                localOf[p] = uint32_t(position.size());
                position.push_back(p);
                head.push_back(kNone);
            }
            corner[c] = localOf[p];
            link[c] = head[corner[c]];
            head[corner[c]] = c;
        }
    }
    for (const uint32_t p : position) localOf[p] = kNone;
}

} // namespace xgc::bake
