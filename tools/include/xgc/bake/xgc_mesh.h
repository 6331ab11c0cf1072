#pragma once

#include <xgc/bake/mesh.h>

#include <array>
#include <span>
#include <vector>

namespace xgc::bake {

/// How the thesis's curvature K of a vertex comes from the covariance matrix of its face normals.
enum class CurvatureNorm {
    trace,     ///< sqrt of the trace: does not depend on rotation
    sum,       ///< sqrt of the sum of all entries: reproduces the thesis's figures, depends on rotation
    frobenius, ///< sqrt of the sum of squared entries, as printed in Eq. 4.4
};

/// The order in which a pass tries the edges of a segment.
enum class EdgeOrder {
    flattestFirst, ///< by the angle between the faces at the start of the pass, ties by index
    byIndex,
};

/// What keeps an edge from collapsing, beside the boundaries of segments, and which of them go first.
struct XgcOptions {
    CurvatureNorm curvature = CurvatureNorm::trace;
    /// Vertices with K at or above it are locked with their edges.
    float lockCurvature = 0.5f;
    /// Edges whose face normals have a smaller dot product are locked: the criterion of figure 4.5 for plain
    /// meshes. -1 locks none.
    float lockDihedralCosine = -1;
    /// The thesis iterates over an array of edges without saying in which order: by angle it comes to its figures.
    EdgeOrder order = EdgeOrder::flattestFirst;
};

enum class CollapseType : uint8_t {
    interior = 1, ///< into the midpoint, a new vertex
    wing = 2,     ///< of a vertex into its neighbour on a boundary, which stays where it is
};

/// Node of a vertex's genealogy: the collapse that made the vertex of it (interior), or that the vertex took in
/// (wing). The bintree of the thesis: its one branch is the genealogy of ancestors[0], the other that of
/// ancestors[1] (interior) or `older` (wing).
struct Genealogy {
    glm::vec3 hoppe{0};                  ///< v_i = v_k + hoppe; v_j = v_k - hoppe (interior), v_k (wing)
    std::array<uint32_t, 2> ancestors{}; ///< v_i, v_j
    uint32_t edge = kNone;               ///< between them
    uint32_t wedge = kNone;              ///< of v_k, which the wedge of v_i becomes
    uint32_t older = kNone;              ///< wing: what v_j had taken in before
    CollapseType type = CollapseType::interior;
    uint8_t level = 0; ///< level of the segment that it led to
};

/// Counts of one simplification pass.
struct XgcPass {
    uint32_t collapses = 0;
    uint32_t linkRefused = 0;  ///< would break the surface's topology
    uint32_t flipRefused = 0;  ///< would turn a face over
    uint32_t wedgeRefused = 0; ///< an attribute seam leaves no one wedge to become

    XgcPass& operator+=(const XgcPass& other);
};

/// The thesis's multiresolution mesh (chapter 4, figure 4.3): an AIF mesh (vertices know their edges, edges their
/// ends and faces, faces their edges), with what its simplification hid (ghosts) and with segments, each of
/// which stands at a level of its own. Indices take the place of pointers.
///
/// One level of a segment is one pass over its edges. An edge collapses unless
/// - it shares an end with an edge that collapsed in this pass (primary rule),
/// - both its ends lie on a boundary (secondary rule; chords included), or it lies on one,
/// - one of its ends has high curvature, at this level or at a finer one,
/// - the link test, the flip test or a seam of attributes forbids it.
/// The link test also keeps two segments from making the same edge between boundary vertices, each on its side: the
/// first segment that both vertices lie on may make it, the others not. So each edge of a closed manifold has two
/// faces at any levels. A flip is a face that turns by 90 degrees or more against itself before, or comes to lie 90
/// degrees or more away from itself at level 0; faces without area have no normal to compare with.
///
/// On a boundary lie the vertices of edges that have not two faces of one segment running along them opposite
/// ways, those around which the faces form more than one fan, and those with more than one wedge. They never move.
/// A pass reads its own segment's faces alone (and what is fixed at level 0: boundaries, their vertices' curvature,
/// edges between them), so the levels of a segment are the same whatever its neighbours do.
class XgcMesh {
public:
    static constexpr uint8_t kNeverSharp = 255;

    struct Vertex {
        glm::vec3 position{0};
        uint32_t firstUse = kNone; ///< of the ring of its incident edges; kNone for ghosts
        uint32_t genealogy = kNone;
        uint32_t wedge = kNone; ///< its only one, or kNone
        uint8_t level = 0;      ///< of its segment when it was made
        bool boundary = false;
        /// First level of its segment at which it was found to have high curvature; it stays locked from there on.
        uint8_t sharpSince = kNeverSharp;
        bool ghost = false;
    };
    struct Edge {
        std::array<uint32_t, 2> ends{};
        std::array<uint32_t, 2> next{}; ///< ring of the uses (2 * edge + end) at each end
        std::array<uint32_t, 2> previous{};
        std::array<uint32_t, 2> faces{kNone, kNone}; ///< see facesOf
        uint32_t stack = kNone;                      ///< its earlier ends, newest first
        uint8_t level = 0;                           ///< since when it has its ends
        bool ghost = false;
    };
    struct EdgeState {
        std::array<uint32_t, 2> ends{};
        uint32_t older = kNone;
        uint8_t level = 0;
    };
    struct Face {
        std::array<uint32_t, 3> edges{};  ///< edge k runs from corner k to corner k + 1
        std::array<uint32_t, 3> wedges{}; ///< corners
        glm::vec3 normal{0};              ///< unit, or zero where it has no area
        glm::vec3 baseNormal{0};          ///< of level 0
        uint32_t segment = 0;
        bool ghost = false;
    };
    struct Segment {
        std::vector<uint32_t> faces;       ///< of level 0, rising
        std::vector<uint32_t> edges;       ///< that may collapse: both faces in it; rising
        std::vector<uint32_t> collapses;   ///< genealogies in order
        std::vector<uint32_t> levelStarts; ///< in collapses, one a level above 0
        uint32_t faceCount = 0;            ///< at its level
        bool stalled = false;              ///< nothing can collapse at its level

        uint32_t level() const { return uint32_t(levelStarts.size()); }
    };

    /// `faceSegment`: a segment below `segmentCount` for each face. The mesh is not referred to afterwards.
    XgcMesh(const Mesh& mesh, const Topology& topology, std::span<const uint32_t> faceSegment, uint32_t segmentCount,
            const XgcOptions& options = {});

    /// Takes a segment one level coarser. Where nothing can collapse it stays at its level: it has stalled.
    XgcPass simplify(uint32_t segment);
    /// Takes all segments one level coarser; the pass has no collapses where all have stalled.
    XgcPass simplifyAll();
    /// Takes a segment one level finer, exactly to what it was. False at level 0.
    bool refine(uint32_t segment);
    /// Takes all segments that are not at level 0 one level finer; false where all are.
    bool refineAll();

    uint32_t segmentCount() const { return uint32_t(segments_.size()); }
    uint32_t level(uint32_t segment) const { return segments_[segment].level(); }

    std::span<const Vertex> vertices() const { return vertices_; }
    std::span<const Edge> edges() const { return edges_; }
    std::span<const Face> faces() const { return faces_; }
    std::span<const Segment> segments() const { return segments_; }
    std::span<const Genealogy> genealogies() const { return genealogies_; }
    std::span<const EdgeState> edgeStates() const { return edgeStates_; }
    uint32_t baseVertexCount() const { return baseVertexCount_; }
    uint32_t baseWedgeCount() const { return baseWedgeCount_; }
    uint32_t faceCount() const;
    /// K of a vertex as the mesh stands.
    double curvatureOf(uint32_t vertex) const;

    std::span<const uint32_t> facesOf(uint32_t edge) const;
    /// Wedges from the mesh's, then one for each made vertex, in order.
    uint32_t vertexOf(uint32_t wedge) const {
        return wedge < baseWedgeCount_ ? baseWedgeVertex_[wedge] : wedge - baseWedgeCount_ + baseVertexCount_;
    }
    glm::uvec3 cornersOf(uint32_t face) const {
        const Face& f = faces_[face];
        return {vertexOf(f.wedges[0]), vertexOf(f.wedges[1]), vertexOf(f.wedges[2])};
    }
    /// Bytes of the structure as it stands, ghosts and genealogies included.
    size_t memoryBytes() const;

private:
    struct Collapse; ///< of one edge: what is around it
    struct CurvatureScratch {
        std::vector<uint32_t> faces;
        std::vector<glm::dvec3> normals;
    };

    uint32_t end(uint32_t use) const { return edges_[use / 2].ends[use & 1]; }
    uint32_t otherEnd(uint32_t use) const { return edges_[use / 2].ends[~use & 1]; }
    uint32_t& nextUse(uint32_t use) { return edges_[use / 2].next[use & 1]; }
    uint32_t& previousUse(uint32_t use) { return edges_[use / 2].previous[use & 1]; }
    template <typename Visit>
    void forUses(uint32_t vertex, Visit visit) const {
        const uint32_t first = vertices_[vertex].firstUse;
        for (uint32_t use = first; use != kNone;) {
            visit(use);
            use = edges_[use / 2].next[use & 1];
            if (use == first) break;
        }
    }

    void buildEdges(const Topology& topology);
    void buildFaces(const Mesh& mesh, const Topology& topology, std::span<const uint32_t> faceSegment);
    void findBoundaries(const Mesh& mesh, const Topology& topology);
    bool isOneFan(const Mesh& mesh, const Topology& topology, uint32_t vertex) const;
    void buildSegments(uint32_t segmentCount);
    void findVertexSegments(const Topology& topology);

    void linkUse(uint32_t use);
    void unlinkUse(uint32_t use);
    void moveUses(uint32_t from, uint32_t to, uint8_t level);
    void returnUses(uint32_t k, uint32_t i, uint32_t j);
    void hideEdge(uint32_t edge);
    void showEdge(uint32_t edge);
    void pushEnds(uint32_t edge, std::array<uint32_t, 2> ends, uint8_t level);
    void popEnds(uint32_t edge);
    std::span<uint32_t> mutableFacesOf(uint32_t edge);
    uint32_t otherFace(uint32_t edge, uint32_t face) const;
    void updateNormal(uint32_t face);
    void replaceCorners(uint32_t vertex, uint32_t from, uint32_t wedge);
    void restoreCorners(uint32_t vertex, uint32_t k, const Genealogy& g);
    uint32_t makeVertex(glm::vec3 position, uint8_t level);
    uint32_t makeGenealogy(const Genealogy& genealogy);
    void forget(uint32_t node, uint32_t k);
    uint32_t nextStamp();

    void measureCurvature(uint32_t segment);
    double curvatureOf(uint32_t vertex, CurvatureScratch& scratch) const;
    std::vector<uint32_t> edgesInOrder(uint32_t segment) const;
    bool isEligible(uint32_t edge, uint32_t stamp) const;
    Collapse describe(uint32_t edge) const;
    bool isKnownTo(uint32_t segment, uint32_t edge) const;
    bool keepsTopology(const Collapse& c);
    bool mayJoin(uint32_t segment, uint32_t v, uint32_t w) const;
    bool joinsBoundaries(const Collapse& c);
    std::span<const uint32_t> segmentsOf(uint32_t boundaryVertex) const {
        return {vertexSegments_.data() + vertexSegmentOffsets_[boundaryVertex],
                vertexSegmentOffsets_[boundaryVertex + 1] - vertexSegmentOffsets_[boundaryVertex]};
    }
    bool findWedge(const Collapse& c, uint32_t& wedge) const;
    bool keepsFaces(const Collapse& c, uint32_t vertex) const;
    static bool turns(glm::vec3 before, glm::dvec3 after);
    uint32_t collapse(const Collapse& c, uint32_t wedge, uint8_t level);
    void undo(uint32_t node);

    XgcOptions options_;
    uint32_t baseVertexCount_ = 0;
    uint32_t baseWedgeCount_ = 0;
    std::vector<uint32_t> baseWedgeVertex_;
    std::vector<Vertex> vertices_;
    std::vector<Edge> edges_;
    std::vector<Face> faces_;
    std::vector<Segment> segments_;
    std::vector<Genealogy> genealogies_;
    std::vector<EdgeState> edgeStates_;
    std::vector<std::vector<uint32_t>> crowds_;  ///< faces of edges with more than two
    std::vector<uint32_t> vertexSegmentOffsets_; ///< per vertex of level 0, into vertexSegments_
    std::vector<uint32_t> vertexSegments_;       ///< of boundary vertices, rising
    // Freed by refinement, for the next simplification.
    std::vector<uint32_t> freeVertices_;
    std::vector<uint32_t> freeGenealogies_;
    uint32_t freeEdgeState_ = kNone;
    std::vector<uint32_t> seen_;    ///< per vertex, the stamp of the last walk that met it
    std::vector<uint32_t> touched_; ///< per vertex, the pass that last collapsed an edge into it
    uint32_t counter_ = 0;
    uint32_t passCounter_ = 0;
};

} // namespace xgc::bake
