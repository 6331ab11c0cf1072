#include "piece.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace xgc::bake {

namespace {

/// `marks` has an entry per face of the mesh. Many faces are marked and looked through, few are sorted.
std::vector<uint32_t> inRisingOrder(std::span<const uint32_t> faces, std::vector<uint32_t>& marks) {
    std::vector<uint32_t> rising;
    if (faces.size() < marks.size() / 16) {
        rising.assign(faces.begin(), faces.end());
        std::sort(rising.begin(), rising.end());
        return rising;
    }
    for (const uint32_t f : faces) marks[f] = 0;
    rising.reserve(faces.size());
    for (uint32_t f = 0; f < marks.size(); ++f) {
        if (marks[f] == 0) rising.push_back(f);
    }
    return rising;
}

} // namespace

Piece extractPiece(const Mesh& mesh, const LinkedFaces& linked, std::span<const uint32_t> faces,
                   std::span<const double> faceAreas, double area, PieceScratch& scratch) {
    Piece piece;
    piece.face = inRisingOrder(faces, scratch.ofFace);
    for (uint32_t t = 0; t < piece.face.size(); ++t) scratch.ofFace[piece.face[t]] = t;
    piece.pose = poseOf(mesh, linked, piece.face, faceAreas, area);
    std::vector<uint32_t> used;
    used.reserve(faces.size());
    piece.positions.reserve(faces.size() / 2 + 2);
    piece.triangles.reserve(faces.size());
    piece.neighbours.reserve(faces.size());
    for (const uint32_t f : piece.face) {
        glm::uvec3 corners, neighbours;
        for (int k = 0; k < 3; ++k) {
            const uint32_t p = linked.corners[f][k];
            if (scratch.ofPosition[p] == kNone) {
                scratch.ofPosition[p] = uint32_t(piece.positions.size());
                used.push_back(p);
                piece.positions.push_back(piece.pose.placeOf(glm::dvec3(mesh.positions[p])));
            }
            corners[k] = scratch.ofPosition[p];
            const uint32_t g = linked.neighbours[f][k];
            neighbours[k] = g == kNone ? kNone : scratch.ofFace[g];
        }
        piece.triangles.push_back(corners);
        piece.neighbours.push_back(neighbours);
    }
    for (const uint32_t p : used) scratch.ofPosition[p] = kNone;
    for (const uint32_t f : piece.face) scratch.ofFace[f] = kNone;
    return piece;
}

namespace {

/// A piece by its edges, so that both triangles beside one see it split in the same way.
class EdgeSplitter {
public:
    explicit EdgeSplitter(const Piece& piece) : positions_(piece.positions) {
        for (uint32_t t = 0; t < piece.triangleCount(); ++t)
            triangles_.push_back({piece.triangles[t], {}, piece.face[t]});
        for (uint32_t t = 0; t < piece.triangleCount(); ++t) numberEdges(piece, t);
    }

    uint32_t triangleCount() const { return uint32_t(triangles_.size()); }

    float longest() const {
        float most = 0;
        for (const Edge& e : edges_) most = std::max(most, lengthOf(e));
        return most;
    }

    void splitLongerThan(float limit) {
        children_.assign(edges_.size(), {kNone, kNone, kNone});
        const auto count = uint32_t(edges_.size());
        for (uint32_t e = 0; e < count; ++e) {
            if (lengthOf(edges_[e]) > limit) splitEdge(e);
        }
        std::vector<Triangle> before = std::move(triangles_);
        triangles_.clear();
        for (const Triangle& t : before) splitTriangle(t);
        dropUnusedEdges();
    }

    Piece take() {
        Piece piece;
        piece.positions = std::move(positions_);
        std::vector<std::array<uint32_t, 2>> sides(edges_.size(), {kNone, kNone});
        for (uint32_t t = 0; t < triangleCount(); ++t) {
            for (int k = 0; k < 3; ++k) {
                std::array<uint32_t, 2>& s = sides[triangles_[t].edges[k]];
                (s[0] == kNone ? s[0] : s[1]) = t;
            }
        }
        for (uint32_t t = 0; t < triangleCount(); ++t) {
            glm::uvec3 neighbours;
            for (int k = 0; k < 3; ++k) {
                const std::array<uint32_t, 2>& s = sides[triangles_[t].edges[k]];
                neighbours[k] = s[0] == t ? s[1] : s[0];
            }
            piece.triangles.push_back(triangles_[t].corners);
            piece.neighbours.push_back(neighbours);
            piece.face.push_back(triangles_[t].face);
        }
        return piece;
    }

private:
    struct Edge {
        uint32_t a, b;
    };
    struct Triangle {
        glm::uvec3 corners, edges; ///< edge k from corner k to k + 1
        uint32_t face;
    };
    struct Children {
        uint32_t middle, atA, atB; ///< a new position and two edges; kNone: not split
    };

    void numberEdges(const Piece& piece, uint32_t t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = piece.neighbours[t][k];
            if (g != kNone && g < t) {
                for (int j = 0; j < 3; ++j) {
                    const uint32_t a = piece.triangles[g][j], b = piece.triangles[g][(j + 1) % 3];
                    const uint32_t c = piece.triangles[t][k], d = piece.triangles[t][(k + 1) % 3];
                    if (std::minmax(a, b) == std::minmax(c, d)) triangles_[t].edges[k] = triangles_[g].edges[j];
                }
                continue;
            }
            triangles_[t].edges[k] = uint32_t(edges_.size());
            edges_.push_back({piece.triangles[t][k], piece.triangles[t][(k + 1) % 3]});
        }
    }

    float lengthOf(const Edge& e) const { return glm::length(positions_[e.b] - positions_[e.a]); }

    void splitEdge(uint32_t e) {
        const Edge edge = edges_[e];
        const auto middle = uint32_t(positions_.size());
        positions_.push_back((positions_[edge.a] + positions_[edge.b]) * 0.5f);
        children_[e] = {middle, uint32_t(edges_.size()), uint32_t(edges_.size()) + 1};
        edges_.push_back({edge.a, middle});
        edges_.push_back({middle, edge.b});
    }

    uint32_t newEdge(uint32_t a, uint32_t b) {
        edges_.push_back({a, b});
        return uint32_t(edges_.size()) - 1;
    }
    uint32_t childAt(uint32_t e, uint32_t corner) const {
        return edges_[e].a == corner ? children_[e].atA : children_[e].atB;
    }
    uint32_t middleOf(const Triangle& t, int k) const { return children_[t.edges[k % 3]].middle; }

    void splitTriangle(const Triangle& t) {
        int count = 0, first = 0, whole = 0;
        for (int k = 0; k < 3; ++k) {
            if (middleOf(t, k) != kNone) {
                ++count;
                first = k;
            } else {
                whole = k;
            }
        }
        if (count == 0) triangles_.push_back(t);
        if (count == 1) halve(t, first);
        if (count == 2) splitTwo(t, whole);
        if (count == 3) splitThree(t);
    }

    /// Edge k has a middle m: (a, m, c) and (m, b, c).
    void halve(const Triangle& t, int k) {
        const uint32_t a = t.corners[k], b = t.corners[(k + 1) % 3], c = t.corners[(k + 2) % 3], m = middleOf(t, k);
        const uint32_t inner = newEdge(m, c);
        triangles_.push_back({{a, m, c}, {childAt(t.edges[k], a), inner, t.edges[(k + 2) % 3]}, t.face});
        triangles_.push_back({{m, b, c}, {childAt(t.edges[k], b), t.edges[(k + 1) % 3], inner}, t.face});
    }

    /// Edge `whole` from a to b has no middle; m lies on (b, c), n on (c, a): a tip (c, n, m) and the quad (a, b, m, n)
    /// across its shorter diagonal.
    void splitTwo(const Triangle& t, int whole) {
        const uint32_t a = t.corners[whole], b = t.corners[(whole + 1) % 3], c = t.corners[(whole + 2) % 3];
        const uint32_t bc = t.edges[(whole + 1) % 3], ca = t.edges[(whole + 2) % 3];
        const uint32_t m = children_[bc].middle, n = children_[ca].middle;
        const uint32_t tip = newEdge(n, m);
        triangles_.push_back({{c, n, m}, {childAt(ca, c), tip, childAt(bc, c)}, t.face});
        if (lengthOf({a, m}) <= lengthOf({b, n})) {
            const uint32_t inner = newEdge(a, m);
            triangles_.push_back({{a, b, m}, {t.edges[whole], childAt(bc, b), inner}, t.face});
            triangles_.push_back({{a, m, n}, {inner, tip, childAt(ca, a)}, t.face});
        } else {
            const uint32_t inner = newEdge(b, n);
            triangles_.push_back({{a, b, n}, {t.edges[whole], inner, childAt(ca, a)}, t.face});
            triangles_.push_back({{b, m, n}, {childAt(bc, b), tip, inner}, t.face});
        }
    }

    void splitThree(const Triangle& t) {
        const uint32_t m0 = middleOf(t, 0), m1 = middleOf(t, 1), m2 = middleOf(t, 2);
        const glm::uvec3 c = t.corners, e = t.edges;
        const uint32_t e0 = newEdge(m2, m0), e1 = newEdge(m0, m1), e2 = newEdge(m1, m2);
        triangles_.push_back({{c.x, m0, m2}, {childAt(e.x, c.x), e0, childAt(e.z, c.x)}, t.face});
        triangles_.push_back({{c.y, m1, m0}, {childAt(e.y, c.y), e1, childAt(e.x, c.y)}, t.face});
        triangles_.push_back({{c.z, m2, m1}, {childAt(e.z, c.z), e2, childAt(e.y, c.z)}, t.face});
        triangles_.push_back({{m0, m1, m2}, {e1, e2, e0}, t.face});
    }

    void dropUnusedEdges() {
        std::vector<uint32_t> number(edges_.size(), kNone);
        std::vector<Edge> kept;
        for (Triangle& t : triangles_) {
            for (int k = 0; k < 3; ++k) {
                uint32_t& e = number[t.edges[k]];
                if (e == kNone) {
                    e = uint32_t(kept.size());
                    kept.push_back(edges_[t.edges[k]]);
                }
                t.edges[k] = e;
            }
        }
        edges_ = std::move(kept);
    }

    std::vector<glm::vec3> positions_;
    std::vector<Triangle> triangles_;
    std::vector<Edge> edges_;
    std::vector<Children> children_; ///< per edge before a pass
};

} // namespace

Piece splitLongEdges(const Piece& piece, uint32_t leastTriangles) {
    const float enough = 1.75f * std::sqrt(1.0f / float(leastTriangles));
    EdgeSplitter splitter(piece);
    while (splitter.triangleCount() < 3 * leastTriangles) {
        const float longest = splitter.longest();
        if (longest <= enough) break;
        splitter.splitLongerThan(std::max(enough, longest / 2));
    }
    Piece fine = splitter.take();
    fine.pose = piece.pose;
    return fine;
}

} // namespace xgc::bake
