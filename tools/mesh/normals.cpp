#include <xgc/bake/normals.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace xgc::bake {
namespace {

constexpr double kCreaseCosine = 0.5; // 60 degrees

glm::dvec3 areaNormal(const Mesh& mesh, uint32_t face) {
    const glm::uvec3 p = mesh.facePositions(face);
    const glm::dvec3 a(mesh.positions[p.x]), b(mesh.positions[p.y]), c(mesh.positions[p.z]);
    return glm::cross(b - a, c - a);
}

bool isCrease(const glm::dvec3& a, const glm::dvec3& b) {
    const double la = glm::dot(a, a), lb = glm::dot(b, b), d = glm::dot(a, b);
    if (la == 0 || lb == 0) return false; // a face without area has no side to take
    return d <= 0 || d * d < kCreaseCosine * kCreaseCosine * la * lb;
}

/// Groups the faces around a position that are joined across smooth edges: `fan[i]` of the i-th face.
void smoothFans(const Topology& topology, const std::vector<glm::dvec3>& normals, uint32_t position,
                std::vector<uint32_t>& fan) {
    const std::span<const uint32_t> faces = topology.facesOfVertex(position);
    fan.resize(faces.size());
    std::iota(fan.begin(), fan.end(), 0u);
    const auto root = [&](uint32_t i) {
        while (fan[i] != i) i = fan[i] = fan[fan[i]];
        return i;
    };
    for (uint32_t i = 0; i < faces.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t e = topology.faceEdges[faces[i]][k];
            if (topology.edges[e].x != position && topology.edges[e].y != position) continue;
            for (const uint32_t other : topology.facesOfEdge(e)) {
                if (isCrease(normals[faces[i]], normals[other])) continue;
                const auto j = uint32_t(std::lower_bound(faces.begin(), faces.end(), other) - faces.begin());
                const uint32_t a = root(i), b = root(j);
                fan[std::max(a, b)] = std::min(a, b);
            }
        }
    }
    for (uint32_t i = 0; i < fan.size(); ++i) fan[i] = root(i);
}

template <typename T>
void copyRow(std::vector<T>& column, uint32_t row) {
    if (!column.empty()) column.push_back(T(column[row]));
}

/// Appends a copy of a row to every column but the normals.
void copyRow(Attributes& a, uint32_t row) {
    copyRow(a.tangents, row);
    for (auto& c : a.uvs) copyRow(c, row);
    for (auto& c : a.colors) copyRow(c, row);
    for (auto& c : a.joints) copyRow(c, row);
    for (auto& c : a.weights) copyRow(c, row);
    for (MorphTarget& m : a.morphTargets) {
        copyRow(m.positions, row);
        copyRow(m.normals, row);
        copyRow(m.tangents, row);
    }
}

/// The wedges around one position, as they are split: a wedge stays with the first fan that uses it.
struct WedgeSplit {
    std::map<uint32_t, uint32_t> owner;                       ///< wedge to fan
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies; ///< (wedge, fan) to wedge

    uint32_t wedgeFor(Mesh& mesh, uint32_t wedge, uint32_t fan) {
        if (owner.emplace(wedge, fan).first->second == fan) return wedge;
        const auto [copy, fresh] = copies.emplace(std::pair(wedge, fan), uint32_t(mesh.wedgePosition.size()));
        if (fresh) {
            mesh.wedgePosition.push_back(mesh.wedgePosition[wedge]);
            mesh.attributes.normals.emplace_back(0);
            copyRow(mesh.attributes, wedge);
        }
        return copy->second;
    }
};

} // namespace

void addMissingNormals(Mesh& mesh, const Topology& topology) {
    if (!mesh.attributes.normals.empty()) return;
    std::vector<glm::dvec3> normals(mesh.faceCount());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) normals[f] = areaNormal(mesh, f);

    mesh.attributes.normals.assign(mesh.wedgePosition.size(), glm::vec3(0));
    std::vector<uint32_t> fan;
    std::vector<glm::dvec3> sums;
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
        const std::span<const uint32_t> faces = topology.facesOfVertex(p);
        smoothFans(topology, normals, p, fan);
        sums.assign(faces.size(), glm::dvec3(0));
        for (uint32_t i = 0; i < faces.size(); ++i) sums[fan[i]] += normals[faces[i]];
        WedgeSplit split;
        for (uint32_t i = 0; i < faces.size(); ++i) {
            glm::uvec3& face = mesh.faces[faces[i]];
            const int k = mesh.wedgePosition[face.x] == p ? 0 : mesh.wedgePosition[face.y] == p ? 1 : 2;
            face[k] = split.wedgeFor(mesh, face[k], fan[i]);
            const double length = glm::length(sums[fan[i]]);
            mesh.attributes.normals[face[k]] = length > 0 ? glm::vec3(sums[fan[i]] / length) : glm::vec3(0);
        }
    }
}

} // namespace xgc::bake
