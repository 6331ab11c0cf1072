#pragma once

#include "piece.h"

namespace xgc::bake {

/// The elements that a piece is segmented in, some 500 to 30,000 of them, and where they touch.
struct CellGraph {
    struct Link {
        uint32_t a, b; ///< cells, a < b
        float length;  ///< of the common border
    };
    /// A link as one of its two cells sees it.
    struct Arc {
        uint32_t to, link;
    };
    std::vector<float> areas; ///< 1 in all
    std::vector<glm::vec3> centers, normals;
    std::vector<Link> links; ///< sorted by a, then b
    std::vector<uint32_t> arcOffsets;
    std::vector<Arc> arcs;

    uint32_t size() const { return uint32_t(areas.size()); }
    std::span<const Arc> arcsOf(uint32_t cell) const {
        return std::span(arcs).subspan(arcOffsets[cell], arcOffsets[cell + 1] - arcOffsets[cell]);
    }
};

struct Cells {
    CellGraph graph;
    std::vector<uint32_t> ofTriangle; ///< of the piece
    std::vector<glm::vec3> soup;      ///< three corners a triangle: what rays meet, about the piece's surface
    float skin = 0;                   ///< rays that start on the surface meet nothing nearer than this
};

/// A cell a triangle, or where there are more than 1.5 times `most`, patches of neighbours that lie in the same cube of
/// a grid and face the same way.
Cells makeCells(const Piece& piece, uint32_t most);

} // namespace xgc::bake
