#include <xgc/bake/xgc_mesh.h>

#include <algorithm>
#include <cassert>

// One collapse of the edge between v_i and v_j into v_k, and back. v_i is always inside its segment, so all that is
// around it belongs to the segment; v_j may lie on a boundary, then v_k = v_j.
//
//          a                     a
//        / | \                   |         The faces (i, j, a) and (j, i, b) die, and with them the edge ij and the
//   --- i--+--j ---    ->    --- k ---     edges ia and ib, whose other faces now lie at ja and jb. What dies keeps
//        \ | /                   |         all it knew: undoing needs no more than that and the stacks of the edges.
//          b                     b

namespace xgc::bake {

namespace {

constexpr uint32_t kLastLevel = 254; ///< levels fit a byte beside "never"

glm::vec3 midpoint(glm::vec3 a, glm::vec3 b) {
    return a * 0.5f + b * 0.5f; // a + b might overflow
}

} // namespace

struct XgcMesh::Collapse {
    uint32_t edge, i, j;
    CollapseType type;
    std::array<uint32_t, 2> faces;     ///< that die
    std::array<uint32_t, 2> opposite;  ///< a, b
    std::array<uint32_t, 2> lostEdges; ///< ia, ib
    std::array<uint32_t, 2> keptEdges; ///< ja, jb
    glm::vec3 target;
};

XgcMesh::Collapse XgcMesh::describe(uint32_t edge) const {
    Collapse c;
    c.edge = edge;
    c.i = edges_[edge].ends[0];
    c.j = edges_[edge].ends[1];
    if (vertices_[c.i].boundary) std::swap(c.i, c.j);
    c.type = vertices_[c.j].boundary ? CollapseType::wing : CollapseType::interior;
    c.faces = edges_[edge].faces;
    for (int side = 0; side < 2; ++side) {
        const glm::uvec3 corners = cornersOf(c.faces[side]);
        c.opposite[side] = corners.x ^ corners.y ^ corners.z ^ c.i ^ c.j;
        for (const uint32_t e : faces_[c.faces[side]].edges) {
            if (e == edge) continue;
            const bool atI = edges_[e].ends[0] == c.i || edges_[e].ends[1] == c.i;
            (atI ? c.lostEdges : c.keptEdges)[side] = e;
        }
    }
    c.target = c.type == CollapseType::wing ? vertices_[c.j].position
                                            : midpoint(vertices_[c.i].position, vertices_[c.j].position);
    return c;
}

/// Whether a pass over a segment may know of an edge at a boundary: it is the segment's, or was there at level 0
/// between boundary vertices, where it stays.
bool XgcMesh::isKnownTo(uint32_t segment, uint32_t edge) const {
    for (const uint32_t f : facesOf(edge)) {
        if (faces_[f].segment == segment) return true;
    }
    const Edge& e = edges_[edge];
    return e.stack == kNone && vertices_[e.ends[0]].boundary && vertices_[e.ends[1]].boundary;
}

/// The links of the ends meet in a and b alone, and in no edge between them.
bool XgcMesh::keepsTopology(const Collapse& c) {
    const auto [a, b] = c.opposite;
    if (a == b) return false;
    const uint32_t segment = faces_[c.faces[0]].segment, stamp = nextStamp();
    forUses(c.i, [&](uint32_t use) { seen_[otherEnd(use)] = stamp; });
    uint32_t common = 0;
    forUses(c.j, [&](uint32_t use) {
        if (seen_[otherEnd(use)] == stamp && isKnownTo(segment, use / 2)) ++common;
    });
    if (common != 2) return false;
    const auto reaches = [&](uint32_t edge, uint32_t but, uint32_t vertex) {
        for (const uint32_t f : facesOf(edge)) {
            if (f == but || faces_[f].segment != segment) continue;
            const glm::uvec3 corners = cornersOf(f);
            if (corners.x == vertex || corners.y == vertex || corners.z == vertex) return true;
        }
        return false;
    };
    return !(reaches(c.lostEdges[0], c.faces[0], b) && reaches(c.keptEdges[0], c.faces[0], b));
}

/// Whether a segment may make an edge between two boundary vertices. Another segment that both lie on might make the
/// same edge, and four faces would meet in it: so of all that they lie on, the first one alone may.
bool XgcMesh::mayJoin(uint32_t segment, uint32_t v, uint32_t w) const {
    for (const uint32_t s : segmentsOf(v)) {
        if (std::ranges::binary_search(segmentsOf(w), s)) return s == segment;
    }
    return true;
}

/// A wing brings boundary vertices together that must stay apart.
bool XgcMesh::joinsBoundaries(const Collapse& c) {
    if (c.type != CollapseType::wing) return false;
    const uint32_t segment = faces_[c.faces[0]].segment;
    bool joins = false;
    forUses(c.i, [&](uint32_t use) {
        const uint32_t w = otherEnd(use);
        if (w == c.j || w == c.opposite[0] || w == c.opposite[1] || !vertices_[w].boundary) return;
        joins = joins || !mayJoin(segment, c.j, w);
    });
    return joins;
}

/// v_j has one wedge in the dying faces.
bool XgcMesh::findWedge(const Collapse& c, uint32_t& wedge) const {
    std::array<uint32_t, 2> found{};
    for (int side = 0; side < 2; ++side) {
        for (const uint32_t w : faces_[c.faces[side]].wedges) {
            if (vertexOf(w) == c.j) found[side] = w;
        }
    }
    wedge = found[0];
    return found[0] == found[1];
}

/// No face of the star of a vertex that moves to the target turns over.
bool XgcMesh::keepsFaces(const Collapse& c, uint32_t vertex) const {
    bool keeps = true;
    forUses(vertex, [&](uint32_t use) {
        // Inside a segment each face of the star has one edge whose first corner in it is the vertex.
        for (const uint32_t f : facesOf(use / 2)) {
            const Face& face = faces_[f];
            if (!keeps || f == c.faces[0] || f == c.faces[1]) continue;
            const int k = face.edges[0] == use / 2 ? 0 : face.edges[1] == use / 2 ? 1 : 2;
            if (vertexOf(face.wedges[k]) != vertex) continue;
            const glm::dvec3 p(c.target), q(vertices_[vertexOf(face.wedges[(k + 1) % 3])].position),
                r(vertices_[vertexOf(face.wedges[(k + 2) % 3])].position);
            const glm::dvec3 after = glm::cross(q - p, r - p);
            keeps = !turns(face.normal, after) && !turns(face.baseNormal, after);
        }
    });
    return keeps;
}

bool XgcMesh::turns(glm::vec3 before, glm::dvec3 after) {
    return before != glm::vec3(0) && !(glm::dot(glm::dvec3(before), after) > 0);
}

XgcPass XgcMesh::simplify(uint32_t segment) {
    XgcPass pass;
    Segment& s = segments_[segment];
    if (s.stalled || s.level() >= kLastLevel) return pass;
    measureCurvature(segment);
    const auto start = uint32_t(s.collapses.size());
    const uint32_t stamp = ++passCounter_;
    const auto level = uint8_t(s.level() + 1);
    for (const uint32_t e : edgesInOrder(segment)) {
        if (!isEligible(e, stamp)) continue;
        const Collapse c = describe(e);
        uint32_t wedge = kNone;
        if (!keepsTopology(c) || joinsBoundaries(c)) {
            ++pass.linkRefused;
        } else if (c.type == CollapseType::wing && !findWedge(c, wedge)) {
            ++pass.wedgeRefused;
        } else if (!keepsFaces(c, c.i) || (c.type == CollapseType::interior && !keepsFaces(c, c.j))) {
            ++pass.flipRefused;
        } else {
            const uint32_t k = collapse(c, wedge, level);
            touched_[k] = stamp;
            ++pass.collapses;
        }
    }
    s.stalled = pass.collapses == 0;
    if (!s.stalled) s.levelStarts.push_back(start);
    return pass;
}

std::vector<uint32_t> XgcMesh::edgesInOrder(uint32_t segment) const {
    std::vector<uint32_t> order;
    if (options_.order == EdgeOrder::byIndex) {
        for (const uint32_t e : segments_[segment].edges) {
            if (!edges_[e].ghost) order.push_back(e);
        }
        return order;
    }
    std::vector<std::pair<float, uint32_t>> keyed;
    for (const uint32_t e : segments_[segment].edges) {
        if (edges_[e].ghost) continue;
        const std::array<uint32_t, 2> faces = edges_[e].faces;
        keyed.emplace_back(-glm::dot(faces_[faces[0]].normal, faces_[faces[1]].normal), e);
    }
    std::sort(keyed.begin(), keyed.end());
    order.reserve(keyed.size());
    for (const auto& [angle, e] : keyed) order.push_back(e);
    return order;
}

bool XgcMesh::isEligible(uint32_t edge, uint32_t stamp) const {
    const Edge& e = edges_[edge];
    if (e.ghost || touched_[e.ends[0]] == stamp || touched_[e.ends[1]] == stamp) return false;
    const Vertex &v = vertices_[e.ends[0]], &w = vertices_[e.ends[1]];
    if ((v.boundary && w.boundary) || v.sharpSince != kNeverSharp || w.sharpSince != kNeverSharp) return false;
    if (options_.lockDihedralCosine <= -1) return true;
    return glm::dot(faces_[e.faces[0]].normal, faces_[e.faces[1]].normal) >= options_.lockDihedralCosine;
}

XgcPass XgcMesh::simplifyAll() {
    XgcPass pass;
    for (uint32_t s = 0; s < segmentCount(); ++s) pass += simplify(s);
    return pass;
}

/// Returns v_k. `wedge`: of v_j, for a wing.
uint32_t XgcMesh::collapse(const Collapse& c, uint32_t wedge, uint8_t level) {
    const bool wing = c.type == CollapseType::wing;
    const uint32_t k = wing ? c.j : makeVertex(c.target, level);
    if (!wing) wedge = vertices_[k].wedge;
    const uint32_t node = makeGenealogy({vertices_[c.i].position - c.target,
                                         {c.i, c.j},
                                         c.edge,
                                         wedge,
                                         wing ? vertices_[k].genealogy : kNone,
                                         c.type,
                                         level});
    vertices_[k].genealogy = node;
    hideEdge(c.edge);
    pushEnds(c.edge, {k, k}, level);
    for (int side = 0; side < 2; ++side) {
        const uint32_t face = c.faces[side], lost = c.lostEdges[side], kept = c.keptEdges[side];
        const uint32_t beyond = otherFace(lost, face);
        std::ranges::replace(faces_[beyond].edges, lost, kept);
        std::ranges::replace(mutableFacesOf(kept), face, beyond);
        faces_[face].ghost = true;
        hideEdge(lost);
    }
    moveUses(c.i, k, level);
    if (!wing) moveUses(c.j, k, level);
    replaceCorners(k, c.i, wedge);
    if (!wing) replaceCorners(k, c.j, wedge);
    vertices_[c.i].ghost = true;
    if (!wing) vertices_[c.j].ghost = true;
    Segment& s = segments_[faces_[c.faces[0]].segment];
    s.faceCount -= 2;
    s.collapses.push_back(node);
    return k;
}

void XgcMesh::hideEdge(uint32_t edge) {
    unlinkUse(2 * edge);
    unlinkUse(2 * edge + 1);
    edges_[edge].ghost = true;
}

void XgcMesh::showEdge(uint32_t edge) {
    edges_[edge].ghost = false;
    linkUse(2 * edge);
    linkUse(2 * edge + 1);
}

/// Moves all edges of a vertex to another one.
void XgcMesh::moveUses(uint32_t from, uint32_t to, uint8_t level) {
    while (vertices_[from].firstUse != kNone) {
        const uint32_t use = vertices_[from].firstUse;
        unlinkUse(use);
        std::array<uint32_t, 2> ends = edges_[use / 2].ends;
        ends[use & 1] = to;
        pushEnds(use / 2, ends, level);
        linkUse(use);
    }
}

bool XgcMesh::refine(uint32_t segment) {
    Segment& s = segments_[segment];
    if (s.levelStarts.empty()) return false;
    while (s.collapses.size() > s.levelStarts.back()) {
        undo(s.collapses.back());
        s.collapses.pop_back();
        s.faceCount += 2;
    }
    s.levelStarts.pop_back();
    s.stalled = false;
    return true;
}

bool XgcMesh::refineAll() {
    bool any = false;
    for (uint32_t s = 0; s < segmentCount(); ++s) any = refine(s) || any;
    return any;
}

void XgcMesh::undo(uint32_t node) {
    const Genealogy g = genealogies_[node];
    const auto [i, j] = g.ancestors;
    const bool wing = g.type == CollapseType::wing;
    const uint32_t k = vertexOf(g.wedge);
    returnUses(k, i, j);
    popEnds(g.edge);
    showEdge(g.edge);
    for (const uint32_t face : edges_[g.edge].faces) {
        faces_[face].ghost = false;
        uint32_t lost = kNone, kept = kNone;
        for (const uint32_t e : faces_[face].edges) {
            if (e == g.edge) continue;
            (edges_[e].ghost ? lost : kept) = e;
        }
        const uint32_t beyond = otherFace(lost, face);
        std::ranges::replace(faces_[beyond].edges, kept, lost);
        std::ranges::replace(mutableFacesOf(kept), beyond, face);
        showEdge(lost);
    }
    vertices_[i].ghost = false;
    vertices_[j].ghost = false;
    restoreCorners(i, k, g);
    if (!wing) restoreCorners(j, k, g);
    forget(node, k);
}

/// Gives edges back to the vertices that they came from when v_i (and v_j) became v_k: the newest of their earlier ends
/// tell which.
void XgcMesh::returnUses(uint32_t k, uint32_t i, uint32_t j) {
    std::vector<uint32_t> uses;
    forUses(k, [&](uint32_t use) {
        const uint32_t stack = edges_[use / 2].stack;
        if (stack == kNone) return;
        const uint32_t was = edgeStates_[stack].ends[use & 1];
        if (was == i || (was == j && k != j)) uses.push_back(use);
    });
    for (const uint32_t use : uses) {
        unlinkUse(use);
        popEnds(use / 2);
        linkUse(use);
    }
}

/// Gives the faces around v_i or v_j their corners there back. The faces that came back have never lost theirs.
void XgcMesh::restoreCorners(uint32_t vertex, uint32_t k, const Genealogy& g) {
    const std::array<uint32_t, 2> revived = edges_[g.edge].faces;
    forUses(vertex, [&](uint32_t use) {
        for (const uint32_t f : facesOf(use / 2)) {
            if (f == revived[0] || f == revived[1]) continue;
            for (uint32_t& corner : faces_[f].wedges) {
                if (vertexOf(corner) != k) continue;
                corner = vertices_[vertex].wedge;
                updateNormal(f);
            }
        }
    });
}

/// Frees a genealogy. A boundary vertex may have taken in others since, for other segments.
void XgcMesh::forget(uint32_t node, uint32_t k) {
    if (genealogies_[node].type == CollapseType::wing) {
        uint32_t* link = &vertices_[k].genealogy;
        while (*link != node) link = &genealogies_[*link].older;
        *link = genealogies_[node].older;
    } else {
        assert(vertices_[k].firstUse == kNone);
        vertices_[k].ghost = true;
        freeVertices_.push_back(k);
    }
    freeGenealogies_.push_back(node);
}

uint32_t XgcMesh::nextStamp() {
    if (++counter_ == 0) {
        std::ranges::fill(seen_, 0);
        counter_ = 1;
    }
    return counter_;
}

} // namespace xgc::bake
