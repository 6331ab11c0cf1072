#pragma once

#include "pose.h"

namespace xgc::bake {

/// One component of a mesh, to be segmented by itself, in its pose.
struct Piece {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;  ///< outwards by their corners' order
    std::vector<glm::uvec3> neighbours; ///< as LinkedFaces, in triangles of the piece
    std::vector<uint32_t> face;         ///< per triangle: of the mesh
    Pose pose;
    uint32_t triangleCount() const { return uint32_t(triangles.size()); }
};

/// `faceAreas` and `area` (their sum, over 0) in mesh units. `scratch` has an entry per position and per face of the
/// mesh, all kNone, and is left so.
struct PieceScratch {
    std::vector<uint32_t> ofPosition, ofFace;
};
Piece extractPiece(const Mesh& mesh, const LinkedFaces& linked, std::span<const uint32_t> faces,
                   std::span<const double> faceAreas, double area, PieceScratch& scratch);

/// Splits edges, longest first, until none is longer than 1.75 sqrt(1 / leastTriangles) or there are three times
/// `leastTriangles`. No vertex comes to lie on an edge; several triangles share a `face` then.
Piece splitLongEdges(const Piece& piece, uint32_t leastTriangles);

} // namespace xgc::bake
