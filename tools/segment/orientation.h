#pragma once

#include <xgc/bake/mesh.h>

namespace xgc::bake {

/// One winding for each component, as far as its surface allows one.
struct Orientation {
    std::vector<uint8_t> turned;       ///< per face: read its corners the other way round
    std::vector<uint8_t> edgeConflict; ///< per edge of two faces: they disagree all the same (a one-sided surface)
};

/// Follows two-faced edges through each component and turns faces to agree with their neighbours. A nearly closed
/// component (border edges under 5 % of its faces) then turns outwards by its signed volume; another keeps the
/// winding of most of its faces.
Orientation orientConsistently(const Mesh& mesh, const Topology& topology);

} // namespace xgc::bake
