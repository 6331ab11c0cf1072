#pragma once

#include "bake/surface_distance.h"
#include "hierarchy/pieces.h"
#include "hierarchy/surface_state.h"

#include <functional>

namespace xgc::bake {

/// Lets whole pieces (bolts, debris) vanish once the error allows it: all vertices of a piece go
/// into one of them, in one step whose domain holds all its patches, so it is there whole or not at all.
///
/// The price is the distance from the piece to those larger than it, which stay longer, and at least
/// its radius: what is larger than the error is seen, however near something else lies. The largest one stays.
///
/// What lies near a piece that is gone stands for it. The patches of that are in the step's domain too: they are
/// adjacent to the piece's patches then, and none of them is finer than the level while the piece is gone.
class ComponentVanisher {
public:
    /// `limit`: the largest squared error that will be asked for; `stays`: pieces that another rule looks after, from
    /// the start or later.
    ComponentVanisher(const Pieces& pieces, std::span<const uint32_t> facePatch, SurfaceState& state, double limit,
                      std::function<bool(uint32_t)> stays);

    /// Returns how many went. `limit`: squared error.
    uint32_t run(uint32_t level, double limit);

private:
    struct Piece {
        double price; ///< squared length
        uint32_t number;
        uint32_t carriers; ///< domain: its patches, and those of what stands for it
    };

    void price(double limit);
    uint32_t carriersOf(uint32_t piece, double price, const SurfaceDistance& surface,
                        const std::function<bool(uint32_t)>& counts);
    void vanish(const Piece& piece, uint32_t level);

    const Pieces& pieces_;
    const std::span<const uint32_t> facePatch_;
    SurfaceState& state_;
    const std::function<bool(uint32_t)> stays_;
    std::vector<Piece> waiting_; ///< those that may go, cheapest last
};

} // namespace xgc::bake
