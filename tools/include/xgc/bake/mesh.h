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
    uint32_t inconsistentEdges = 0;   ///< two faces that run along it the same way
    uint32_t nonManifoldVertices = 0; ///< faces around it form more than one fan
    bool closed() const { return borderEdges == 0; }
};

struct WeldOptions {
    /// Positions that fall into the same cell of a grid of this spacing become one, mesh units. 0: exact
    /// equality (-0 equals 0).
    float tolerance = 0;
};

/// Welds a model by position; wedges with equal attributes become one. Refuses NaN and infinite positions
/// (the vertex is named), more than 2^31 faces, and a model without faces. On failure `out` is untouched.
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
