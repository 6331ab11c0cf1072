#pragma once

#include <xgc/bake/default_hierarchy.h>

#include <array>
#include <string>

namespace xgc::bake {

/// What keeps a vertex of the coarsest state from going into a neighbour, from the hardest reason to the softest.
enum class Hold : uint8_t {
    locked,      ///< the artist locked it
    nonManifold, ///< sheets that meet at an edge of three faces or more
    piece,       ///< it is of a piece of 4 faces or fewer that is too large, or too far from others, to vanish
    handle,      ///< a handle or hole would close
    seam,        ///< normals, UVs or colours that differ have nowhere to go
    boundary,    ///< parts, or patches, meet here, and it may only move along where they do
    fold,        ///< a face would turn over
    error,       ///< nothing in this state: only the error, or states in which patches stand at mixed levels
};
inline constexpr uint32_t kHoldCount = 8;

/// The name in the JSON of a report, e.g. "nonManifold".
const char* holdName(Hold hold);

/// What one part keeps in the coarsest uniform state. A face counts for the hardest reason among its corners.
struct PartFloor {
    uint32_t part = 0;
    uint32_t baseFaces = 0; ///< at level 0
    uint32_t faces = 0;
    std::array<uint32_t, kHoldCount> held{}; ///< faces by reason
    Hold hold = Hold::error;                 ///< of most of them
    glm::vec3 place{0};                      ///< mean of the faces that it holds, mesh units

    uint32_t heldBy(Hold h) const { return held[size_t(h)]; }
};

struct FloorReport {
    uint32_t faces = 0;
    uint32_t components = 0; ///< pieces that are left, connected at vertices
    std::array<uint32_t, kHoldCount> held{};
    std::vector<PartFloor> parts; ///< those that keep faces, most first; ties by part
};

/// Says what holds an asset up: looks at the coarsest uniform state of a hierarchy and tries, for each vertex that
/// stands, what keeps it from going into each neighbour. `options` are those that it was built with. Linear in the
/// faces that are left, but for drawing them. The same for any number of threads.
FloorReport findFloor(const Mesh& mesh, const Hierarchy& hierarchy, const HierarchyOptions& options);

} // namespace xgc::bake
