#include <xgc/bake/mesh.h>

#include <algorithm>

namespace xgc::bake {

namespace {

/// Half-edges bucketed by their lower position; a key holds the upper position, then the half-edge (3 face + corner),
/// so that sorting a bucket groups its edges and leaves the faces of an edge rising.
struct HalfEdgeBuckets {
    std::vector<uint32_t> offsets;
    std::vector<uint64_t> keys;
};

glm::uvec2 halfEdge(const glm::uvec3& corners, int k) {
    const uint32_t a = corners[k], b = corners[(k + 1) % 3];
    return a < b ? glm::uvec2(a, b) : glm::uvec2(b, a);
}

HalfEdgeBuckets bucketHalfEdges(const Mesh& mesh) {
    HalfEdgeBuckets buckets;
    const uint32_t faceCount = mesh.faceCount();
    buckets.offsets.assign(mesh.positions.size() + 1, 0);
    for (uint32_t f = 0; f < faceCount; ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) ++buckets.offsets[halfEdge(corners, k).x + 1];
    }
    for (size_t i = 1; i < buckets.offsets.size(); ++i) buckets.offsets[i] += buckets.offsets[i - 1];
    buckets.keys.resize(size_t(faceCount) * 3);
    std::vector<uint32_t> next(buckets.offsets.begin(), buckets.offsets.end() - 1);
    for (uint32_t f = 0; f < faceCount; ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (uint32_t k = 0; k < 3; ++k) {
            const glm::uvec2 e = halfEdge(corners, int(k));
            buckets.keys[next[e.x]++] = uint64_t(e.y) << 32 | (f * 3 + k);
        }
    }
    return buckets;
}

/// Buckets are of three keys in the mean: too few for std::sort to pay.
void sortKeys(std::span<uint64_t> keys) {
    constexpr size_t kFew = 16;
    if (keys.size() > kFew) return std::sort(keys.begin(), keys.end());
    for (size_t i = 1; i < keys.size(); ++i) {
        const uint64_t key = keys[i];
        size_t at = i;
        for (; at > 0 && keys[at - 1] > key; --at) keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

void buildEdges(const Mesh& mesh, Topology& topology) {
    HalfEdgeBuckets buckets = bucketHalfEdges(mesh);
    topology.faceEdges.resize(mesh.faces.size());
    topology.edges.reserve(buckets.keys.size() / 2);
    topology.edgeFaces.reserve(buckets.keys.size());
    topology.edgeFaceOffsets.reserve(buckets.keys.size() / 2 + 1);
    for (uint32_t low = 0; low + 1 < buckets.offsets.size(); ++low) {
        const std::span keys =
            std::span(buckets.keys).subspan(buckets.offsets[low], buckets.offsets[low + 1] - buckets.offsets[low]);
        sortKeys(keys);
        for (size_t i = 0; i < keys.size(); ++i) {
            const auto high = uint32_t(keys[i] >> 32), half = uint32_t(keys[i]);
            if (i == 0 || uint32_t(keys[i - 1] >> 32) != high) {
                topology.edgeFaceOffsets.push_back(uint32_t(topology.edgeFaces.size()));
                topology.edges.emplace_back(low, high);
            }
            topology.edgeFaces.push_back(half / 3);
            topology.faceEdges[half / 3][int(half % 3)] = uint32_t(topology.edges.size() - 1);
        }
    }
    topology.edgeFaceOffsets.push_back(uint32_t(topology.edgeFaces.size()));
}

void buildVertexFaces(const Mesh& mesh, Topology& topology) {
    std::vector<uint32_t>& offsets = topology.vertexFaceOffsets;
    const uint32_t faceCount = mesh.faceCount();
    offsets.assign(mesh.positions.size() + 1, 0);
    for (uint32_t f = 0; f < faceCount; ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) ++offsets[corners[k] + 1];
    }
    for (size_t i = 1; i < offsets.size(); ++i) offsets[i] += offsets[i - 1];
    topology.vertexFaces.resize(size_t(faceCount) * 3);
    std::vector<uint32_t> next(offsets.begin(), offsets.end() - 1);
    for (uint32_t f = 0; f < faceCount; ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) topology.vertexFaces[next[corners[k]]++] = f;
    }
}

uint32_t findRoot(std::vector<uint32_t>& parent, uint32_t f) {
    while (parent[f] != f) {
        parent[f] = parent[parent[f]];
        f = parent[f];
    }
    return f;
}

void buildComponents(Topology& topology) {
    const auto faceCount = uint32_t(topology.faceEdges.size());
    std::vector<uint32_t> parent(faceCount);
    for (uint32_t f = 0; f < faceCount; ++f) parent[f] = f;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        for (size_t i = 1; i < faces.size(); ++i) {
            const uint32_t a = findRoot(parent, faces[0]), b = findRoot(parent, faces[i]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    topology.faceComponent.resize(faceCount);
    for (uint32_t f = 0; f < faceCount; ++f) { // a root is the lowest face of its component: it is numbered first
        const uint32_t root = findRoot(parent, f);
        topology.faceComponent[f] = root == f ? topology.componentCount++ : topology.faceComponent[root];
    }
}

} // namespace

Topology buildTopology(const Mesh& mesh) {
    Topology topology;
    buildEdges(mesh, topology);
    buildVertexFaces(mesh, topology);
    buildComponents(topology);
    return topology;
}

} // namespace xgc::bake
