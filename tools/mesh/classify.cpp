#include <mesh/classify.h>

#include <algorithm>

namespace xgc::bake {

namespace {

bool hasZeroArea(const Mesh& mesh, uint32_t face) {
    const glm::uvec3 corners = mesh.facePositions(face);
    const glm::dvec3 a(mesh.positions[corners.x]);
    // In double, products of float differences hardly ever round: zero means collinear.
    const glm::dvec3 n =
        glm::cross(glm::dvec3(mesh.positions[corners.y]) - a, glm::dvec3(mesh.positions[corners.z]) - a);
    return n == glm::dvec3(0);
}

/// True where the face runs from the edge's lower position to its upper one.
bool runsUpwards(const Mesh& mesh, const Topology& topology, uint32_t face, uint32_t edge) {
    const glm::uvec3 edges = topology.faceEdges[face];
    const int k = edges.x == edge ? 0 : edges.y == edge ? 1 : 2;
    return mesh.facePositions(face)[k] == topology.edges[edge].x;
}

void classifyEdges(const Mesh& mesh, const Topology& topology, WeldReport& report) {
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        report.borderEdges += faces.size() == 1;
        report.nonManifoldEdges += faces.size() > 2;
        report.oddEdges += faces.size() % 2 == 1;
        report.inconsistentEdges +=
            faces.size() == 2 && runsUpwards(mesh, topology, faces[0], e) == runsUpwards(mesh, topology, faces[1], e);
    }
}

/// Walks from face to face around a position, out of `face` over its edge `edge`, until a border, a non-manifold edge
/// or `face` again. Returns the number of further faces met.
struct FanWalk {
    const Topology& topology;
    uint32_t position;
    bool closed = false;
    bool manifold = true;

    /// The other edge of the face at the position.
    uint32_t otherEdge(uint32_t face, uint32_t edge) const {
        for (int k = 0; k < 3; ++k) {
            const uint32_t e = topology.faceEdges[face][k];
            if (e != edge && (topology.edges[e].x == position || topology.edges[e].y == position)) return e;
        }
        return edge;
    }

    size_t walk(uint32_t first, uint32_t edge) {
        uint32_t face = first;
        for (size_t met = 0;; ++met) {
            const std::span<const uint32_t> faces = topology.facesOfEdge(edge);
            manifold = manifold && faces.size() <= 2;
            if (faces.size() != 2) return met;
            face = faces[0] == face ? faces[1] : faces[0];
            closed = face == first;
            if (closed) return met;
            edge = otherEdge(face, edge);
        }
    }
};

bool isOneFan(const Topology& topology, uint32_t position) {
    const std::span<const uint32_t> faces = topology.facesOfVertex(position);
    if (faces.empty()) return true;
    FanWalk fan{topology, position};
    const uint32_t first = fan.otherEdge(faces[0], kNone), second = fan.otherEdge(faces[0], first);
    size_t met = 1 + fan.walk(faces[0], first);
    if (!fan.closed) met += fan.walk(faces[0], second);
    return fan.manifold && met == faces.size();
}

uint32_t countBackToBack(const Mesh& mesh, const Topology& topology) {
    const auto opposite = [&](uint32_t f, uint32_t g) {
        const glm::uvec3 a = mesh.facePositions(f), b = mesh.facePositions(g);
        return b == glm::uvec3(a.x, a.z, a.y) || b == glm::uvec3(a.y, a.x, a.z) || b == glm::uvec3(a.z, a.y, a.x);
    };
    uint32_t pairs = 0;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        uint32_t shortest = topology.faceEdges[f].x; // the edge with the fewest faces to look through
        for (int k = 1; k < 3; ++k) {
            const uint32_t e = topology.faceEdges[f][k];
            if (topology.facesOfEdge(e).size() < topology.facesOfEdge(shortest).size()) shortest = e;
        }
        for (const uint32_t g : topology.facesOfEdge(shortest)) pairs += g > f && opposite(f, g);
    }
    return pairs;
}

} // namespace

void classify(const Mesh& mesh, const Topology& topology, WeldReport& report) {
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) report.zeroAreaFaces += hasZeroArea(mesh, f);
    report.components = topology.componentCount;
    classifyEdges(mesh, topology, report);
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) report.nonManifoldVertices += !isOneFan(topology, p);
    report.backToBackPairs = countBackToBack(mesh, topology);
}

} // namespace xgc::bake
