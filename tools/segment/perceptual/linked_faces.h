#pragma once

#include <xgc/bake/mesh.h>

namespace xgc::bake {

/// The faces of a mesh linked across edges two by two and wound alike: a surface to walk on, whatever the mesh is like.
/// - Of faces over the same three positions the lowest stands for all.
/// - An edge of more faces links, pair by pair, those that continue each other best; the rest ends there.
/// - A nearly closed component (open edges under 5 % of its faces) faces outwards; another keeps most faces' winding.
struct LinkedFaces {
    std::vector<glm::uvec3> corners;    ///< per face: positions, as wound here
    std::vector<glm::uvec3> neighbours; ///< per face: across its edge from corner k to k + 1; kNone: closed
    std::vector<uint32_t> standsFor;    ///< per face: itself, or the lowest face over the same positions
    /// Components over links, by lowest face; faces in the order of a walk. A face that another stands for is in none.
    std::vector<uint32_t> componentOffsets;
    std::vector<uint32_t> componentFaces;
    uint32_t componentCount() const { return uint32_t(componentOffsets.size()) - 1; }
};

LinkedFaces linkFaces(const Mesh& mesh, const Topology& topology);

} // namespace xgc::bake
