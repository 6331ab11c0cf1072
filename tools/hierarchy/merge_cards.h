#pragma once

#include "bake/surface_distance.h"
#include "hierarchy/card_fit.h"
#include "hierarchy/pieces.h"
#include "hierarchy/surface_state.h"

#include <optional>

namespace xgc::bake {

/// Keeps foliage from thinning out. A small open piece that is down to one or two triangles, a *card*, loses neither of
/// them alone, which would halve it, nor does it vanish while it has neighbours: two cards become one that is about as
/// large as both (card_fit.h), and so on, two by two. What a step misses of the area the next ones nearby make good.
/// Only what is small for the error and has no such neighbour gives up its area: it goes into one that stays as it is,
/// or where other surface is near it.
///
/// A step takes the patches of both cards into its domain. So domains widen along every chain, and any state of levels
/// shows each card as it was before a step or after it: nothing in between need be tried.
///
/// Until then the rim of such a piece is guarded (piece_guard.h). Takes part: pieces within one patch, with one wedge a
/// position, none of it locked. The vertices of cards are locked for all others (an infinite cost).
class CardMerger {
public:
    CardMerger(const Pieces& pieces, const PatchAssignment& assignment, SurfaceState& state);

    /// Begins a level: the vertices of pieces that may waste away from now on, to be looked at again.
    std::vector<uint32_t> release(double squaredError);
    /// Returns how many cards went. `squaredError`: that a step may make.
    uint32_t run(uint32_t level, double squaredError);
    bool isCard(uint32_t piece) const { return isCard_[piece] != 0; }

private:
    struct Member : Card {
        std::array<uint32_t, 4> position{};
        uint32_t domain = 0;
        uint32_t patch = 0;
        double scale = 1; ///< importance squared
        bool stands = true;
        double debt() const { return wantedArea - area(); }
    };
    using Pair = std::pair<uint32_t, uint32_t>;

    bool mayBecomeCard(uint32_t piece) const;
    void guardPieces();
    void adopt();
    bool adopt(uint32_t piece);
    bool readCorners(uint32_t piece, Member& card) const;
    bool readFaces(uint32_t piece, Member& card) const;

    /// What a round of steps may do.
    struct Round {
        uint32_t level;
        double squaredError;
        bool acrossPatches;
        bool anyArea; ///< among cards that are small for the error
    };
    uint32_t joinAll(const Round& round);
    uint32_t joinNeighbours(const Round& round, bool& crowded);
    std::vector<Pair> pairsWithin(const Round& round, bool& crowded) const;
    bool isSmall(const Member& card, const Round& round) const;
    bool mayMeet(const Member& a, const Member& b, bool acrossPatches) const;
    CardFitLimits limitsOf(const Member& a, const Member& b, const Round& round) const;
    bool join(Pair pair, const Round& round);
    void forgetRefused(const std::vector<uint8_t>& changed);
    void take(Member& survivor, Member& other, const CardFit& fit, uint32_t level);
    uint32_t dropLonely(const Round& round);
    bool standsBeside(Member& card, double squaredError);
    void listOthers();

    const Pieces& pieces_;
    const PatchAssignment& assignment_;
    SurfaceState& state_;
    std::vector<uint32_t> waiting_; ///< pieces that may become cards
    std::vector<uint8_t> isCard_;   ///< a piece
    std::vector<Member> cards_;
    std::vector<double> debt_;              ///< a patch: area that its cards lack
    std::vector<Pair> refused_;             ///< at this level, rising
    std::optional<SurfaceDistance> others_; ///< of the input's pieces that become no cards; made when first needed
    std::vector<uint32_t> otherPatch_;      ///< per triangle of it
};

} // namespace xgc::bake
