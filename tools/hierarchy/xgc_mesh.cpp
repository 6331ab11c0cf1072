#include <xgc/bake/xgc_mesh.h>

#include <algorithm>
#include <cassert>
#include <cmath>

// Construction and the small operations on the structure. Each edge has two uses, one at each end; the uses at a vertex
// form a ring, so that an edge leaves a vertex and joins another in constant time:
//
//            e1.0
//           /    \            use = 2 * edge + end
//   v : e0.1      e2.1        v.firstUse is one of them
//           \    /
//            e3.0

namespace xgc::bake {

namespace {

/// In faces[1] of an edge with more than two faces; faces[0] is then its crowd.
constexpr uint32_t kCrowd = 0xfffffffeu;

/// Whether a face runs along its edge from the edge's first end to its second.
bool runsForward(const Mesh& mesh, const Topology& topology, uint32_t face, uint32_t edge) {
    const glm::uvec3 edges = topology.faceEdges[face];
    const int k = edges.x == edge ? 0 : edges.y == edge ? 1 : 2;
    return mesh.facePositions(face)[k] == topology.edges[edge].x;
}

uint32_t cornerOf(glm::uvec3 corners, uint32_t vertex) {
    return corners.x == vertex ? 0 : corners.y == vertex ? 1 : 2;
}

} // namespace

XgcPass& XgcPass::operator+=(const XgcPass& other) {
    collapses += other.collapses;
    linkRefused += other.linkRefused;
    flipRefused += other.flipRefused;
    wedgeRefused += other.wedgeRefused;
    return *this;
}

XgcMesh::XgcMesh(const Mesh& mesh, const Topology& topology, std::span<const uint32_t> faceSegment,
                 uint32_t segmentCount, const XgcOptions& options)
    : options_(options), baseVertexCount_(uint32_t(mesh.positions.size())),
      baseWedgeCount_(uint32_t(mesh.wedgePosition.size())), baseWedgeVertex_(mesh.wedgePosition) {
    assert(faceSegment.size() == mesh.faces.size());
    vertices_.resize(baseVertexCount_);
    for (uint32_t v = 0; v < baseVertexCount_; ++v) vertices_[v].position = mesh.positions[v];
    std::vector<uint32_t> wedgeCount(baseVertexCount_, 0);
    for (uint32_t w = 0; w < baseWedgeCount_; ++w) {
        vertices_[mesh.wedgePosition[w]].wedge = w;
        ++wedgeCount[mesh.wedgePosition[w]];
    }
    for (uint32_t v = 0; v < baseVertexCount_; ++v) {
        if (wedgeCount[v] == 1) continue;
        vertices_[v].wedge = kNone;
        vertices_[v].boundary = true;
    }
    buildEdges(topology);
    buildFaces(mesh, topology, faceSegment);
    findBoundaries(mesh, topology);
    findVertexSegments(topology);
    buildSegments(segmentCount);
    seen_.resize(baseVertexCount_, 0);
    touched_.resize(baseVertexCount_, 0);
    for (uint32_t v = 0; v < baseVertexCount_; ++v) {
        if (vertices_[v].boundary && curvatureOf(v) >= double(options.lockCurvature)) vertices_[v].sharpSince = 0;
    }
}

void XgcMesh::buildEdges(const Topology& topology) {
    edges_.resize(topology.edges.size());
    for (uint32_t e = 0; e < edges_.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        edges_[e].ends = {topology.edges[e].x, topology.edges[e].y};
        if (faces.size() > 2) {
            edges_[e].faces = {uint32_t(crowds_.size()), kCrowd};
            crowds_.emplace_back(faces.begin(), faces.end());
        } else {
            std::copy(faces.begin(), faces.end(), edges_[e].faces.begin());
        }
        linkUse(2 * e);
        linkUse(2 * e + 1);
    }
}

void XgcMesh::buildFaces(const Mesh& mesh, const Topology& topology, std::span<const uint32_t> faceSegment) {
    faces_.resize(mesh.faces.size());
    for (uint32_t f = 0; f < faces_.size(); ++f) {
        const glm::uvec3 wedges = mesh.faces[f], edges = topology.faceEdges[f];
        faces_[f].wedges = {wedges.x, wedges.y, wedges.z};
        faces_[f].edges = {edges.x, edges.y, edges.z};
        faces_[f].segment = faceSegment[f];
        updateNormal(f);
        faces_[f].baseNormal = faces_[f].normal;
    }
}

void XgcMesh::findBoundaries(const Mesh& mesh, const Topology& topology) {
    for (uint32_t e = 0; e < edges_.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        const bool inside = faces.size() == 2 && faces_[faces[0]].segment == faces_[faces[1]].segment &&
                            runsForward(mesh, topology, faces[0], e) != runsForward(mesh, topology, faces[1], e);
        if (inside) continue;
        for (const uint32_t v : edges_[e].ends) vertices_[v].boundary = true;
    }
    std::vector<uint32_t> pinched;
    for (uint32_t v = 0; v < baseVertexCount_; ++v) {
        if (!vertices_[v].boundary && !isOneFan(mesh, topology, v)) pinched.push_back(v);
    }
    for (const uint32_t v : pinched) vertices_[v].boundary = true;
}

/// Walks around a vertex whose edges all have two faces that agree in winding.
bool XgcMesh::isOneFan(const Mesh& mesh, const Topology& topology, uint32_t vertex) const {
    const std::span<const uint32_t> faces = topology.facesOfVertex(vertex);
    if (faces.empty()) return true;
    uint32_t face = faces[0], steps = 0;
    do {
        const uint32_t out = topology.faceEdges[face][int(cornerOf(mesh.facePositions(face), vertex))];
        face = otherFace(out, face);
        ++steps;
    } while (face != faces[0] && steps <= faces.size());
    return steps == faces.size();
}

void XgcMesh::buildSegments(uint32_t segmentCount) {
    segments_.resize(segmentCount);
    for (uint32_t f = 0; f < faces_.size(); ++f) segments_[faces_[f].segment].faces.push_back(f);
    for (Segment& segment : segments_) segment.faceCount = uint32_t(segment.faces.size());
    for (uint32_t e = 0; e < edges_.size(); ++e) {
        const std::array<uint32_t, 2> faces = edges_[e].faces;
        if (faces[1] >= kCrowd || faces_[faces[0]].segment != faces_[faces[1]].segment) continue;
        if (vertices_[edges_[e].ends[0]].boundary && vertices_[edges_[e].ends[1]].boundary) continue;
        segments_[faces_[faces[0]].segment].edges.push_back(e);
    }
}

void XgcMesh::findVertexSegments(const Topology& topology) {
    vertexSegmentOffsets_.assign(baseVertexCount_ + 1, 0);
    std::vector<uint32_t> around;
    for (uint32_t v = 0; v < baseVertexCount_; ++v) {
        if (vertices_[v].boundary) {
            around.clear();
            for (const uint32_t f : topology.facesOfVertex(v)) around.push_back(faces_[f].segment);
            std::sort(around.begin(), around.end());
            vertexSegments_.insert(vertexSegments_.end(), around.begin(), std::unique(around.begin(), around.end()));
        }
        vertexSegmentOffsets_[v + 1] = uint32_t(vertexSegments_.size());
    }
}

uint32_t XgcMesh::faceCount() const {
    uint32_t count = 0;
    for (const Segment& segment : segments_) count += segment.faceCount;
    return count;
}

std::span<const uint32_t> XgcMesh::facesOf(uint32_t edge) const {
    const std::array<uint32_t, 2>& faces = edges_[edge].faces;
    if (faces[1] == kCrowd) return crowds_[faces[0]];
    return {faces.data(), size_t(faces[0] != kNone) + size_t(faces[1] != kNone)};
}

std::span<uint32_t> XgcMesh::mutableFacesOf(uint32_t edge) {
    const std::span<const uint32_t> faces = facesOf(edge);
    return {const_cast<uint32_t*>(faces.data()), faces.size()};
}

uint32_t XgcMesh::otherFace(uint32_t edge, uint32_t face) const {
    return edges_[edge].faces[0] == face ? edges_[edge].faces[1] : edges_[edge].faces[0];
}

void XgcMesh::linkUse(uint32_t use) {
    uint32_t& first = vertices_[end(use)].firstUse;
    if (first == kNone) {
        first = use;
        nextUse(use) = use;
        previousUse(use) = use;
        return;
    }
    const uint32_t last = previousUse(first);
    nextUse(last) = use;
    previousUse(use) = last;
    nextUse(use) = first;
    previousUse(first) = use;
}

void XgcMesh::unlinkUse(uint32_t use) {
    uint32_t& first = vertices_[end(use)].firstUse;
    const uint32_t next = nextUse(use), previous = previousUse(use);
    if (first == use) first = next == use ? kNone : next;
    nextUse(previous) = next;
    previousUse(next) = previous;
}

void XgcMesh::pushEnds(uint32_t edge, std::array<uint32_t, 2> ends, uint8_t level) {
    Edge& e = edges_[edge];
    uint32_t state = freeEdgeState_;
    if (state == kNone) {
        state = uint32_t(edgeStates_.size());
        edgeStates_.emplace_back();
    } else {
        freeEdgeState_ = edgeStates_[state].older;
    }
    edgeStates_[state] = {e.ends, e.stack, e.level};
    e.stack = state;
    e.ends = ends;
    e.level = level;
}

void XgcMesh::popEnds(uint32_t edge) {
    Edge& e = edges_[edge];
    const uint32_t state = e.stack;
    e.ends = edgeStates_[state].ends;
    e.level = edgeStates_[state].level;
    e.stack = edgeStates_[state].older;
    edgeStates_[state].older = freeEdgeState_;
    freeEdgeState_ = state;
}

void XgcMesh::updateNormal(uint32_t face) {
    const glm::uvec3 c = cornersOf(face);
    const glm::dvec3 a(vertices_[c.x].position), b(vertices_[c.y].position), d(vertices_[c.z].position);
    const glm::dvec3 normal = glm::cross(b - a, d - a);
    const double length = std::sqrt(glm::dot(normal, normal));
    faces_[face].normal = length > 0 ? glm::vec3(normal / length) : glm::vec3(0);
}

/// Gives the corners at `from` of the faces around a vertex another wedge.
void XgcMesh::replaceCorners(uint32_t vertex, uint32_t from, uint32_t wedge) {
    forUses(vertex, [&](uint32_t use) {
        for (const uint32_t f : facesOf(use / 2)) {
            for (uint32_t& corner : faces_[f].wedges) {
                if (vertexOf(corner) != from) continue;
                corner = wedge;
                updateNormal(f);
            }
        }
    });
}

uint32_t XgcMesh::makeVertex(glm::vec3 position, uint8_t level) {
    uint32_t v = uint32_t(vertices_.size());
    if (freeVertices_.empty()) {
        vertices_.emplace_back();
        seen_.push_back(0);
        touched_.push_back(0);
    } else {
        v = freeVertices_.back();
        freeVertices_.pop_back();
        vertices_[v] = {};
    }
    vertices_[v].position = position;
    vertices_[v].wedge = baseWedgeCount_ + v - baseVertexCount_;
    vertices_[v].level = level;
    return v;
}

uint32_t XgcMesh::makeGenealogy(const Genealogy& genealogy) {
    if (freeGenealogies_.empty()) {
        genealogies_.push_back(genealogy);
        return uint32_t(genealogies_.size()) - 1;
    }
    const uint32_t index = freeGenealogies_.back();
    freeGenealogies_.pop_back();
    genealogies_[index] = genealogy;
    return index;
}

size_t XgcMesh::memoryBytes() const {
    const auto bytes = [](const auto& column) { return column.size() * sizeof(column[0]); };
    size_t total = bytes(vertices_) + bytes(edges_) + bytes(faces_) + bytes(genealogies_) + bytes(edgeStates_) +
                   bytes(baseWedgeVertex_) + bytes(freeVertices_) + bytes(freeGenealogies_) + bytes(seen_) +
                   bytes(touched_) + bytes(segments_) + bytes(crowds_) + bytes(vertexSegmentOffsets_) +
                   bytes(vertexSegments_);
    for (const Segment& s : segments_)
        total += bytes(s.faces) + bytes(s.edges) + bytes(s.collapses) + bytes(s.levelStarts);
    for (const std::vector<uint32_t>& crowd : crowds_) total += bytes(crowd);
    return total;
}

} // namespace xgc::bake
