#include "convexity.h"

#include <cmath>

namespace xgc::bake {

namespace {

/// A face lower than this times its longest edge has no plane of its own.
constexpr double kNeedle = 1e-6;
/// Needles lean on each other at most so many deep.
constexpr int kNeedleChain = 8;

struct Plane {
    glm::dvec3 normal{0}; ///< unit, or zero where the face has none
    uint32_t longestEdge = 0;
    bool needle = false;
};

Plane planeOf(const glm::uvec3& corners, const glm::uvec3& edges, bool turned, std::span<const glm::dvec3> positions) {
    const glm::dvec3 a = positions[corners.x], b = positions[corners.y], c = positions[corners.z];
    const glm::dvec3 side[3] = {b - a, c - b, a - c};
    int longest = 0;
    for (int k = 1; k < 3; ++k) {
        if (glm::dot(side[k], side[k]) > glm::dot(side[longest], side[longest])) longest = k;
    }
    const glm::dvec3 cross = glm::cross(side[0], side[1]);
    const double area = glm::length(cross);
    Plane plane;
    plane.longestEdge = edges[longest];
    plane.needle = !(area > kNeedle * glm::dot(side[longest], side[longest]));
    if (!plane.needle) plane.normal = cross / (turned ? -area : area);
    return plane;
}

bool hasNormal(const Plane& plane) {
    return plane.normal != glm::dvec3(0);
}

std::vector<Plane> facePlanes(const Mesh& mesh, const Topology& topology, const Orientation& orientation,
                              std::span<const glm::dvec3> positions) {
    std::vector<Plane> planes(mesh.faces.size());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        planes[f] = planeOf(mesh.facePositions(f), topology.faceEdges[f], orientation.turned[f] != 0, positions);
    }
    // A needle lies in the plane of the face across its longest edge: so a crack's filling neither opens a way
    // across a concave edge nor cuts a flat side in two.
    std::vector<std::pair<uint32_t, glm::dvec3>> needles;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        uint32_t g = f;
        for (int step = 0; step < kNeedleChain && !hasNormal(planes[g]); ++step) {
            const std::span<const uint32_t> faces = topology.facesOfEdge(planes[g].longestEdge);
            if (faces.size() != 2) break;
            g = faces[0] == g ? faces[1] : faces[0];
        }
        if (g != f && hasNormal(planes[g])) needles.emplace_back(f, planes[g].normal);
    }
    for (const auto& [f, normal] : needles) planes[f].normal = normal;
    return planes;
}

/// Which of an edge's faces gives N1: the first, but rather a needle, since its far corner lies in the plane of any
/// neighbour and says nothing.
int testedFace(const Plane& a, const Plane& b) {
    if (!hasNormal(a)) return 1;
    return b.needle && !a.needle && hasNormal(b) ? 1 : 0;
}

uint32_t oppositeCorner(const Mesh& mesh, const glm::uvec2& edge, uint32_t face) {
    const glm::uvec3 c = mesh.facePositions(face);
    for (int k = 0; k < 2; ++k) {
        if (c[k] != edge.x && c[k] != edge.y) return c[k];
    }
    return c.z;
}

} // namespace

std::vector<EdgeKind> classifyEdges(const Mesh& mesh, const Topology& topology, const Orientation& orientation,
                                    std::span<const glm::dvec3> positions, double flatTolerance) {
    const std::vector<Plane> planes = facePlanes(mesh, topology, orientation, positions);
    std::vector<EdgeKind> kinds(topology.edges.size(), EdgeKind::closed);
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        if (faces.size() != 2 || orientation.edgeConflict[e]) continue;
        const int first = testedFace(planes[faces[0]], planes[faces[1]]);
        if (!hasNormal(planes[faces[first]])) {
            kinds[e] = EdgeKind::flat;
            continue;
        }
        const glm::dvec3 p1 = positions[oppositeCorner(mesh, topology.edges[e], faces[first])];
        const glm::dvec3 p2 = positions[oppositeCorner(mesh, topology.edges[e], faces[1 - first])];
        const double d = glm::dot(planes[faces[first]].normal, p2 - p1);
        if (std::abs(d) <= flatTolerance * glm::length(p2 - p1)) {
            kinds[e] = EdgeKind::flat;
        } else {
            kinds[e] = d > 0 ? EdgeKind::concave : EdgeKind::convex;
        }
    }
    return kinds;
}

FaceEdgeCounts countEdges(const Topology& topology, std::span<const EdgeKind> kinds, uint32_t face) {
    FaceEdgeCounts counts;
    for (int k = 0; k < 3; ++k) {
        const EdgeKind kind = kinds[topology.faceEdges[face][k]];
        counts.convex = uint8_t(counts.convex + (kind == EdgeKind::convex));
        counts.concave = uint8_t(counts.concave + (kind == EdgeKind::concave));
    }
    return counts;
}

uint32_t triangleType(FaceEdgeCounts counts) {
    if (counts.undefined()) return counts.convex == 2 ? 7 : counts.concave == 2 ? 8 : 9;
    if (counts.convex > 0) return 3u - counts.convex;
    if (counts.concave > 0) return 7u - counts.concave;
    return 3;
}

} // namespace xgc::bake
