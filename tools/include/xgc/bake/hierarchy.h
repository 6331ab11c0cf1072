#pragma once

#include <xgc/bake/mesh.h>
#include <xgc/bake/segment.h>

namespace xgc::bake {

/// A collapse level that no state reaches.
inline constexpr uint8_t kNeverCollapses = 255;

/// The unit that has a level: a piece of one part, of one material.
struct Patch {
    uint32_t part = 0;
    uint32_t material = 0;
};

/// A multiresolution hierarchy in runtime form (design: vertices have a collapse level and a parent, and
/// `rep(v)` follows parents while the collapse level is at or below the level of the vertex's domain).
/// It refers to the mesh that it was built from; rows past the mesh's were made by the builder (midpoints).
///
/// Rules, checked by `checkHierarchy`:
/// - a parent wedge's position has a domain that includes the child's and, where it is the same, a collapse level at or
///   above the child's;
/// - all wedges of a position have parents of one position;
/// - a face that has a position twice in some state has a wedge twice: it can be told to be degenerate by either;
/// - the mesh's positions and wedges come first, as they are, with birth level 0;
/// - a made position has 0 < birthLevel <= its collapse level, and only children that collapse at or after
///   it is born.
struct Hierarchy {
    uint32_t levelCount = 1; ///< K + 1

    // Positions: the mesh's, then made ones.
    std::vector<glm::vec3> positions;
    std::vector<uint8_t> collapseLevel; ///< 1..K, or kNeverCollapses
    std::vector<uint8_t> birthLevel;    ///< 0 for the mesh's
    std::vector<uint32_t> domain;       ///< in domainPatches

    // Wedges: the mesh's, then made ones.
    std::vector<uint32_t> wedgePosition;
    std::vector<uint32_t> wedgeParent; ///< kNone where the position never collapses
    Attributes attributes;             ///< a row each wedge

    std::vector<std::vector<uint32_t>> domainPatches; ///< distinct sets, each rising
    std::vector<Patch> patches;                       ///< ordered by part, then material
    std::vector<uint32_t> facePatch;                  ///< per mesh face
    std::vector<float> levelThreshold;                ///< per level, mesh units; 0 where the builder has none

    uint32_t patchCount() const { return uint32_t(patches.size()); }
    uint32_t domainLevel(uint32_t d, std::span<const uint8_t> levels) const;
};

/// Counts of a build, per level 1..K (entry 0 is level 0).
struct HierarchyLevelReport {
    uint32_t faces = 0;
    uint32_t collapses = 0;
    uint32_t linkRefused = 0;
    uint32_t flipRefused = 0;
    uint32_t wedgeRefused = 0;
    double seconds = 0;
    double area = 0;      ///< of the uniform state, mesh units squared; 0 where the builder does not say
    double sheetArea = 0; ///< of it, that of small open pieces: leaves, feathers, stickers
};

/// The drawn surface of a state by definition, slow and simple: the reference for the runtime. Faces of wedges,
/// degenerate ones left out, `face` naming the mesh face that each came from.
struct DrawnSurface {
    std::vector<glm::uvec3> triangles; ///< wedges of the hierarchy
    std::vector<uint32_t> face;
};
DrawnSurface drawSurface(const Mesh& mesh, const Hierarchy& hierarchy, std::span<const uint8_t> levels);

/// Checks the rules above, in time linear in the hierarchy; the message names the first element that breaks one.
/// The rule on faces is tried where all shared domains are at one level and the face's patch at another.
Status checkHierarchy(const Mesh& mesh, const Hierarchy& hierarchy);

} // namespace xgc::bake
