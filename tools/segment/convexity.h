#pragma once

#include "orientation.h"

#include <xgc/bake/segment.h>

namespace xgc::bake {

/// Kind of each edge by the point membership test (thesis 3.3.1): D = N1 . (P2 - P1), N1 the unit normal of the
/// edge's first face, P1 and P2 the opposite corners; concave where D > 0, convex where D < 0, flat near 0.
/// `positions`: one each mesh position.
std::vector<EdgeKind> classifyEdges(const Mesh& mesh, const Topology& topology, const Orientation& orientation,
                                    std::span<const glm::dvec3> positions, double flatTolerance);

/// Convex, concave and flat edges of a face; a closed one counts as flat.
struct FaceEdgeCounts {
    uint8_t convex = 0;
    uint8_t concave = 0;
    bool undefined() const { return convex > 0 && concave > 0; } ///< a boundary triangle
};
FaceEdgeCounts countEdges(const Topology& topology, std::span<const EdgeKind> kinds, uint32_t face);

/// Index of the triangle's type in the order of definition 1: +3, +2, +1 convex; flat; -3, -2, -1 concave; +2-1,
/// +1-2, +1-1 undefined.
uint32_t triangleType(FaceEdgeCounts counts);

} // namespace xgc::bake
