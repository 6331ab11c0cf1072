#pragma once

#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <span>

namespace xgc::bake {

/// A welded triangle mesh. A *position* is a point where faces meet; a *wedge* is a position with one
/// set of attributes, a row of `attributes` (what a renderer calls a vertex). Faces index wedges.
struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> wedgePosition;
    Attributes attributes; ///< a row each wedge
    std::vector<glm::uvec3> faces;
    std::vector<uint32_t> faceInput;    ///< input face, rising
    std::vector<uint32_t> faceMaterial; ///< in materials
    std::vector<uint32_t> faceNode;     ///< in nodes, or kNone
    uint32_t inputFaceCount = 0;
    std::vector<Material> materials;
    std::vector<SceneNode> nodes;
    std::vector<Skin> skins;

    uint32_t faceCount() const { return uint32_t(faces.size()); }
    /// Positions of a face's corners.
    glm::uvec3 facePositions(uint32_t face) const {
        const glm::uvec3 f = faces[face];
        return {wedgePosition[f.x], wedgePosition[f.y], wedgePosition[f.z]};
    }
};

/// What welding dropped and found. Counts of the welded mesh unless said otherwise.
struct WeldReport {
    uint32_t inputFaces = 0;
    uint32_t inputVertices = 0;         ///< rows of the model
    uint32_t repeatedPositionFaces = 0; ///< dropped: a position twice in a face
    uint32_t duplicateFaces = 0;        ///< dropped: same positions, same orientation
    uint32_t zeroAreaFaces = 0;         ///< kept
    uint32_t backToBackPairs = 0;       ///< kept: same positions, opposite orientation
    uint32_t components = 0;
    uint32_t borderEdges = 0;         ///< one face
    uint32_t nonManifoldEdges = 0;    ///< more than two faces
    uint32_t oddEdges = 0;            ///< an odd number of faces: borders, and non-manifold ones of 3, 5, ...
    uint32_t inconsistentEdges = 0;   ///< two faces that run along it the same way
    uint32_t nonManifoldVertices = 0; ///< the faces around it are not one fan (a chain or a ring)
    /// Every edge is used an even number of times.
    bool closed() const { return oddEdges == 0; }
};

struct WeldOptions {
    /// Positions that fall into the same cell of a grid of this spacing become one, mesh units. 0: exact
    /// equality (-0 equals 0).
    float tolerance = 0;
};

/// Most faces of a mesh: three corners each are counted in 32 bits.
inline constexpr uint64_t kMaxFaces = 0xffffffffu / 3;

/// Welds a model by position; wedges with bitwise equal attributes (morph targets included) become one. Faces
/// keep their order; positions and wedges are numbered by first use in it, and rows that no kept face uses are
/// left out. A welded position is that of its first vertex. Refuses NaN and infinite positions and attributes
/// (the vertex row and the first face that uses it are named, both counted from 0), more than kMaxFaces faces, and a
/// model without faces. On failure `out` and `report` are untouched.
Status weld(const Model& model, const WeldOptions& options, Mesh& out, WeldReport& report);

/// Edges and incidence of a mesh over positions, any manifoldness. Offsets have one entry more than what
/// they index.
struct Topology {
    std::vector<glm::uvec2> edges;           ///< positions, lower first; sorted
    std::vector<uint32_t> edgeFaceOffsets;   ///< into edgeFaces
    std::vector<uint32_t> edgeFaces;         ///< rising per edge
    std::vector<glm::uvec3> faceEdges;       ///< edge from corner k to corner k + 1
    std::vector<uint32_t> vertexFaceOffsets; ///< per position, into vertexFaces
    std::vector<uint32_t> vertexFaces;       ///< rising per position
    std::vector<uint32_t> faceComponent;     ///< connected across edges; dense, by lowest face
    uint32_t componentCount = 0;

    std::span<const uint32_t> facesOfEdge(uint32_t e) const {
        return {edgeFaces.data() + edgeFaceOffsets[e], edgeFaceOffsets[e + 1] - edgeFaceOffsets[e]};
    }
    std::span<const uint32_t> facesOfVertex(uint32_t v) const {
        return {vertexFaces.data() + vertexFaceOffsets[v], vertexFaceOffsets[v + 1] - vertexFaceOffsets[v]};
    }
};

Topology buildTopology(const Mesh& mesh);

} // namespace xgc::bake
