#pragma once

#include "hierarchy/domain_sets.h"
#include "hierarchy/patch_mesh.h"
#include "hierarchy/piece_guard.h"
#include "hierarchy/quadric.h"

#include <xgc/bake/patches.h>

#include <algorithm>
#include <utility>

namespace xgc::bake {

/// A surface half-way through a build.
///
/// Two triangulations matter. In the *patch meshes* vertices that several patches see (boundary vertices) stand where
/// the input has them, and a patch's own are collapsed: from them any state of levels can be drawn. In the *uniform
/// state* the boundary vertices are collapsed too. It is not stored: it is the patch meshes seen through
/// `representative`.
///
///   boundary vertices     a   b   c   d   e        chain of b:  b -(level 2, {s,q})-> c -(level 5, {s,q,r})-> e
///   representatives       a   e   e   d   e        group of e:  e, b, c
struct SurfaceState {
    /// Where a position lies in a patch mesh.
    struct Occurrence {
        uint32_t patch, vertex;
    };

    /// A corner of a patch mesh.
    struct PatchCorner {
        uint32_t patch, corner;
    };

    SurfaceState(const Mesh& mesh, const Topology& topology, const PatchAssignment& assignment);

    const Mesh& mesh;
    std::vector<PatchMesh> patches;

    // A position each: the mesh's, then room for those that the build makes.
    std::vector<glm::vec3> positions;
    std::vector<uint8_t> birthLevel;
    std::vector<uint8_t> isBoundary;
    std::vector<uint8_t> collapseLevel;   ///< kNeverCollapses while it stands
    std::vector<uint32_t> parent;         ///< kNone while it stands
    std::vector<uint32_t> domain;         ///< in domains; frozen when it collapses
    std::vector<uint32_t> representative; ///< of boundary vertices, in the uniform state; others: themselves
    std::vector<uint32_t> groupNext;      ///< ring of the boundary vertices with the same representative
    std::vector<Quadric> quadrics;        ///< about `origin`
    std::vector<double> costScale;        ///< importance squared; infinite: locked

    DomainSets domains;
    PieceGuard guard;

    // A wedge each.
    std::vector<uint32_t> wedgePosition;
    std::vector<uint32_t> wedgeParent;
    std::vector<uint32_t> wedgeRepresentative;

    /// What a wedge that was made lies between, and the second one's share.
    struct MadeWedge {
        uint32_t first, second;
        float share;
    };
    std::vector<MadeWedge> madeWedges; ///< from mesh.wedgePosition.size() on
    const MadeWedge& madeWedge(uint32_t wedge) const { return madeWedges[wedge - mesh.wedgePosition.size()]; }

    /// The next numbers for vertices that one worker makes; what lies between its start and these is in use.
    struct Room {
        uint32_t firstPosition, firstWedge;
        uint32_t position, wedge;
    };
    std::vector<Room> rooms; ///< a patch each, and the boundary's; empty where no vertices are made
    bool makesVertices() const { return !rooms.empty(); }
    /// For placements that make vertices: before anything collapses.
    void makeRooms();
    /// How far a point lies from one vertex to another, 0..1.
    double shareAt(uint32_t v, uint32_t w, const glm::dvec3& at) const;
    /// Writes a vertex between two others at the next numbers of a room, which are taken only by `keep`. Its wedges,
    /// one a pair of theirs, are numbered on in order.
    uint32_t draft(uint32_t room, const glm::dvec3& point, uint32_t v, uint32_t w,
                   std::span<const std::pair<uint32_t, uint32_t>> wedgePairs);
    void keep(uint32_t room, uint32_t level, const Occurrence& home);

    glm::dvec3 origin{0};
    double diagonal = 1;

    glm::dvec3 point(uint32_t position) const { return glm::dvec3(positions[position]) - origin; }
    std::span<const Occurrence> occurrencesOf(uint32_t position) const {
        return std::span(occurrences).subspan(occurrenceRanges[position].first, occurrenceRanges[position].count);
    }
    std::span<const uint32_t> wedgesOf(uint32_t position) const {
        return std::span(positionWedges).subspan(wedgeRanges[position].first, wedgeRanges[position].count);
    }

    /// A boundary vertex goes into another in a step that is there whole or not at all: nothing between the two is
    /// drawn on, so all its wedges go to the other's first.
    void collapseWhole(uint32_t from, uint32_t to, uint32_t stepDomain, uint32_t level);
    /// Makes a boundary vertex of one inside a patch.
    void makeBoundary(uint32_t position);
    /// The corners of the triangles that the uniform state draws around a representative on the boundary; also, until
    /// `pruneStar`, some that it no longer draws.
    std::vector<PatchCorner>& starOf(uint32_t r) { return stars[starNumber[r]]; }
    const std::vector<PatchCorner>& starOf(uint32_t r) const { return stars[starNumber[r]]; }
    void pruneStar(uint32_t r);

    /// Whether `test(patch mesh, corner)` holds for any corner at a representative; among them may be some that the
    /// uniform state does not draw.
    template <typename Test>
    bool anyOfStar(uint32_t r, const Test& test) const {
        if (isBoundary[r]) {
            return std::any_of(starOf(r).begin(), starOf(r).end(), [&](const PatchCorner& c) {
                return patches[c.patch].isLive(c.corner / 3) && test(patches[c.patch], c.corner);
            });
        }
        const Occurrence o = occurrencesOf(r).front();
        const PatchMesh& patch = patches[o.patch];
        for (uint32_t c = patch.head[o.vertex]; c != kNone; c = patch.link[c]) {
            if (test(patch, c)) return true;
        }
        return false;
    }
    /// Whether the uniform state draws the triangle of a corner.
    bool isDrawn(const PatchMesh& patch, uint32_t c) const {
        if (!patch.isLive(c / 3)) return false;
        const uint32_t a = uniformAt(patch, c), b = uniformAt(patch, PatchMesh::next(c));
        const uint32_t d = uniformAt(patch, PatchMesh::previous(c));
        return a != b && b != d && d != a;
    }

    /// Visits the positions whose representative is `r`.
    template <typename Visit>
    void forGroup(uint32_t r, const Visit& visit) const {
        uint32_t m = r;
        do {
            visit(m);
            m = groupNext[m];
        } while (m != r);
    }

    /// Visits (patch, corner) of all live corners at positions whose representative is `r`.
    template <typename Visit>
    void forGroupCorners(uint32_t r, const Visit& visit) const {
        forGroup(r, [&](uint32_t m) {
            for (const Occurrence& o : occurrencesOf(m)) {
                patches[o.patch].forCorners(o.vertex, [&](uint32_t c) { visit(o.patch, c); });
            }
        });
    }

    uint32_t positionAt(const PatchMesh& patch, uint32_t corner) const { return patch.position[patch.corner[corner]]; }
    uint32_t uniformAt(const PatchMesh& patch, uint32_t corner) const {
        return representative[positionAt(patch, corner)];
    }
    uint32_t uniformWedgeAt(const PatchMesh& patch, uint32_t corner) const {
        return wedgeRepresentative[patch.wedge[corner]];
    }

private:
    void buildPatches(const PatchAssignment& assignment);
    void classify(const Topology& topology);
    void listWedges();
    void grow(size_t positionCount, size_t wedgeCount);

    struct Range {
        uint32_t first = 0, count = 0;
    };
    std::vector<Range> occurrenceRanges, wedgeRanges; ///< a position each
    std::vector<Occurrence> occurrences;
    std::vector<uint32_t> positionWedges;
    size_t firstMadeOccurrence = 0;
    std::vector<uint32_t> starNumber; ///< a position: in stars, kNone inside patches
    std::vector<std::vector<PatchCorner>> stars;
};

/// Sets the quadrics from faces, and from perpendicular planes at borders, seams, cuts and sharp folds.
void initQuadrics(const Topology& topology, const PatchAssignment& assignment, SurfaceState& state);

} // namespace xgc::bake
