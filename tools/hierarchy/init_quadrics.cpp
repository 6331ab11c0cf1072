#include "hierarchy/surface_state.h"

// The quadric of a vertex: the planes of its faces, weighted by area, and planes that stand on edges which must keep
// their place: open borders, seams, boundaries of materials, sharp folds. Where patches of one material meet the edge
// need be no feature (the surface shows those of parts that are): a whisper of a plane keeps its vertices from
// drifting.

namespace xgc::bake {

namespace {

constexpr double kFeatureWeight = 1;
constexpr double kCutWeight = 0.01;
constexpr double kFoldCosine = -0.3;

struct Plane {
    glm::dvec3 normal{0};
    double area = 0;
};

Plane planeOf(const SurfaceState& state, uint32_t face) {
    const glm::uvec3 p = state.mesh.facePositions(face);
    const glm::dvec3 a = state.point(p.x);
    const glm::dvec3 n = glm::cross(state.point(p.y) - a, state.point(p.z) - a);
    const double length = glm::length(n);
    return length > 0 ? Plane{n / length, length / 2} : Plane{};
}

/// Wedges of a face at the ends of an edge.
glm::uvec2 wedgesAt(const Mesh& mesh, uint32_t face, glm::uvec2 edge) {
    glm::uvec2 wedges(kNone);
    for (int k = 0; k < 3; ++k) {
        const uint32_t w = mesh.faces[face][k];
        if (mesh.wedgePosition[w] == edge.x) wedges.x = w;
        if (mesh.wedgePosition[w] == edge.y) wedges.y = w;
    }
    return wedges;
}

class EdgePlanes {
public:
    EdgePlanes(const Topology& topology, const PatchAssignment& assignment, SurfaceState& state)
        : topology_(topology), assignment_(assignment), state_(state) {}

    void add(uint32_t edge) {
        const double weight = weightOf(edge);
        if (weight == 0) return;
        const glm::uvec2 ends = topology_.edges[edge];
        const glm::dvec3 a = state_.point(ends.x), along = state_.point(ends.y) - a;
        const double squared = glm::dot(along, along);
        if (squared == 0) return;
        const std::span<const uint32_t> faces = topology_.facesOfEdge(edge);
        for (const uint32_t f : faces) {
            const glm::dvec3 across = glm::cross(along, planeOf(state_, f).normal);
            const double length = glm::length(across);
            if (length == 0) continue;
            const double w = weight * 0.5 * squared / double(faces.size());
            state_.quadrics[ends.x].addPlane(across / length, a, w);
            state_.quadrics[ends.y].addPlane(across / length, a, w);
        }
    }

private:
    double weightOf(uint32_t edge) const {
        const std::span<const uint32_t> faces = topology_.facesOfEdge(edge);
        if (faces.size() != 2) return kFeatureWeight;
        const uint32_t f = faces[0], g = faces[1];
        const glm::uvec2 ends = topology_.edges[edge];
        if (wedgesAt(state_.mesh, f, ends) != wedgesAt(state_.mesh, g, ends)) return kFeatureWeight;
        if (glm::dot(planeOf(state_, f).normal, planeOf(state_, g).normal) < kFoldCosine) return kFeatureWeight;
        const uint32_t p = assignment_.facePatch[f], q = assignment_.facePatch[g];
        if (p == q) return 0;
        const bool sameMaterial = assignment_.patches[p].material == assignment_.patches[q].material;
        return sameMaterial ? kCutWeight : kFeatureWeight;
    }

    const Topology& topology_;
    const PatchAssignment& assignment_;
    SurfaceState& state_;
};

} // namespace

void initQuadrics(const Topology& topology, const PatchAssignment& assignment, SurfaceState& state) {
    state.quadrics.assign(state.mesh.positions.size(), {});
    for (uint32_t f = 0; f < state.mesh.faceCount(); ++f) {
        const Plane plane = planeOf(state, f);
        if (plane.area == 0) continue;
        const glm::uvec3 corners = state.mesh.facePositions(f);
        Quadric q;
        q.addPlane(plane.normal, state.point(corners.x), plane.area);
        for (int k = 0; k < 3; ++k) state.quadrics[corners[k]].add(q);
    }
    EdgePlanes planes(topology, assignment, state);
    for (uint32_t e = 0; e < topology.edges.size(); ++e) planes.add(e);
}

} // namespace xgc::bake
