#include <xgc/bake/segmentation_metrics.h>

namespace xgc::bake {

namespace {

/// Areas of the input's faces and how far the surface spreads around its centroid.
void measureFaces(const Mesh& mesh, MetricSurface& surface) {
    surface.faceArea.assign(mesh.inputFaceCount, 0.0);
    std::vector<glm::dvec3> centers(mesh.faces.size());
    std::vector<double> areas(mesh.faces.size());
    glm::dvec3 moment(0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 c = mesh.facePositions(f);
        const glm::dvec3 p(mesh.positions[c.x]), q(mesh.positions[c.y]), r(mesh.positions[c.z]);
        areas[f] = 0.5 * glm::length(glm::cross(q - p, r - p));
        centers[f] = (p + q + r) / 3.0;
        moment += areas[f] * centers[f];
        surface.faceArea[mesh.faceInput[f]] += areas[f];
        surface.area += areas[f];
    }
    if (!(surface.area > 0)) return;
    const glm::dvec3 centroid = moment / surface.area;
    double sum = 0;
    for (size_t f = 0; f < areas.size(); ++f) sum += areas[f] * glm::length(centers[f] - centroid);
    surface.averageRadius = sum / surface.area;
}

void findJoints(const Mesh& mesh, const Topology& topology, MetricSurface& surface) {
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        if (faces.size() < 2) continue;
        const glm::uvec2 sides(mesh.faceInput[faces[0]], mesh.faceInput[faces[1]]);
        if (sides.x != sides.y) surface.joints.push_back({topology.edges[e], sides});
    }
}

void findNeighbors(const Mesh& mesh, const Topology& topology, MetricSurface& surface) {
    std::vector<uint32_t>& offsets = surface.neighborOffsets;
    offsets.assign(mesh.positions.size() + 1, 0);
    for (const glm::uvec2 e : topology.edges) {
        ++offsets[e.x + 1];
        ++offsets[e.y + 1];
    }
    for (size_t v = 1; v < offsets.size(); ++v) offsets[v] += offsets[v - 1];
    std::vector<uint32_t> next(offsets.begin(), offsets.end() - 1);
    surface.neighbors.resize(topology.edges.size() * 2);
    for (const glm::uvec2 e : topology.edges) {
        const double length = glm::length(glm::dvec3(mesh.positions[e.y]) - glm::dvec3(mesh.positions[e.x]));
        surface.neighbors[next[e.x]++] = {e.y, length};
        surface.neighbors[next[e.y]++] = {e.x, length};
    }
    surface.positions = mesh.positions;
}

} // namespace

MetricSurface prepareSurface(const Mesh& mesh, const Topology& topology) {
    MetricSurface surface;
    measureFaces(mesh, surface);
    findJoints(mesh, topology, surface);
    findNeighbors(mesh, topology, surface);
    return surface;
}

} // namespace xgc::bake
