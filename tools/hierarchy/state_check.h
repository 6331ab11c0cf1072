#pragma once

#include "hierarchy/surface_state.h"

#include <array>

namespace xgc::bake {

/// Tries one triangle of a patch mesh in every state of levels that a collapse at the current level concerns.
///
/// Its patch s stands at the level being built. A corner that other patches see stands at one of the *stops* of its
/// chain, as they choose; a pick of one stop a corner is possible iff some levels bring it about. At a stop that is
/// not the chain's end, some patch q != s of the step's domain must stand below the step's level; but q stands at least
/// at the levels of the last steps taken, by any corner, in whose domains it is. (Domains widen along a chain and
/// levels rise, so the last step speaks for those before it.)
class StateCheck {
public:
    enum class Verdict { good, badInMixed, badInUniform };

    explicit StateCheck(const SurfaceState& state) : state_(state) {}

    /// A collapse that is tried: wedges of `from` become those of `to`.
    struct Move {
        uint32_t from, to;
        uint32_t level;
        uint32_t domain; ///< of the step, where `from` is a boundary vertex
        bool fromIsBoundary;
    };
    /// `movedWedge(wedge of from)` gives the wedge of `to`. Faces that have both ends in the patch mesh, or
    /// in the uniform state if `from` is a boundary vertex, must not be given.
    /// On badInMixed, `failingDomains` are those that keep corners of the failing triangle back.
    template <typename MovedWedge>
    Verdict check(uint32_t patch, uint32_t face, const Move& move, const MovedWedge& movedWedge) {
        const PatchMesh& mesh = state_.patches[patch];
        patch_ = patch;
        normal_ = mesh.normal[face];
        before_ = move.from;
        if (!move.fromIsBoundary && isInside(mesh, face, move)) return checkInside(mesh, face, move);
        uint32_t picks = 1;
        for (int k = 0; k < 3; ++k) {
            const uint32_t wedge = mesh.wedge[3 * size_t(face) + uint32_t(k)];
            const uint32_t position = state_.positionAt(mesh, 3 * face + uint32_t(k));
            Corner& corner = corners_[size_t(k)];
            corner.moves = state_.representative[position] == move.from;
            corner.stops.clear();
            if (corner.moves && move.fromIsBoundary) {
                corner.stops.push_back({movedWedge(state_.wedgeRepresentative[wedge]), move.to, kNeverCollapses, 0,
                                        uint8_t(move.level), move.domain});
            } else if (corner.moves) {
                addStops(movedWedge(wedge), move.to, corner);
            } else {
                addStops(wedge, position, corner);
            }
            picks *= uint32_t(corner.stops.size());
        }
        return picks == 1 ? checkPick({0, 0, 0}, false) : checkPicks(picks);
    }

    std::vector<uint32_t> failingDomains;

private:
    struct Stop {
        uint32_t wedge, position;
        uint8_t level; ///< of the step that leaves the stop; kNeverCollapses at the end
        uint32_t domain;
        uint8_t lastLevel; ///< of the step that led here; 0: none
        uint32_t lastDomain;
    };
    struct Corner {
        std::vector<Stop> stops;
        bool moves = false;
    };
    using Pick = std::array<uint32_t, 3>;

    /// Whether no other patch sees a corner, before or after the move.
    bool isInside(const PatchMesh& mesh, uint32_t face, const Move& move) const {
        bool inside = !state_.isBoundary[move.to];
        for (uint32_t k = 0; k < 3; ++k) inside = inside && !state_.isBoundary[state_.positionAt(mesh, 3 * face + k)];
        return inside;
    }
    Verdict checkInside(const PatchMesh& mesh, uint32_t face, const Move& move) const;
    bool isTurned(const std::array<glm::dvec3, 3>& before, const std::array<glm::dvec3, 3>& after) const;
    void addStops(uint32_t wedge, uint32_t position, Corner& corner);
    Verdict checkPicks(uint32_t picks);
    bool isPossible(const Pick& pick) const;
    bool canHold(const Stop& stop, const Pick& pick) const;
    Verdict checkPick(const Pick& pick, bool mixed);
    bool isGood(const Pick& pick) const;

    const SurfaceState& state_;
    std::array<Corner, 3> corners_;
    uint32_t patch_ = 0;
    uint32_t before_ = 0;
    glm::vec3 normal_{0};
};

} // namespace xgc::bake
