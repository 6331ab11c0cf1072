#pragma once

#include "bake/surface_distance.h"
#include "hierarchy/surface_state.h"

namespace xgc::bake {

/// Lets whole components (bolts, leaves, debris) vanish once the error allows it: all vertices of a component go
/// into one of them, in one step whose domain holds all its patches, so it is there whole or not at all.
///
/// The price is the distance from the component to those larger than it, which stay longer, and at least
/// its radius: what is larger than the error is seen, however near something else lies. The largest one stays.
///
/// What lies near a component that is gone stands for it. The patches of that are in the step's domain too: they are
/// adjacent to the component's patches then, and none of them is finer than the level while the component is gone.
class ComponentVanisher {
public:
    /// `limit`: the largest squared error that will be asked for.
    ComponentVanisher(const Topology& topology, std::span<const uint32_t> facePatch, SurfaceState& state, double limit);

    /// Returns how many went. `limit`: squared error.
    uint32_t run(uint32_t level, double limit);

private:
    struct Component {
        double price; ///< squared length
        uint32_t number;
        uint32_t carriers; ///< domain: its patches, and those of what stands for it
    };

    void group(const Topology& topology);
    void price(double limit);
    uint32_t carriersOf(uint32_t component, double price, const SurfaceDistance& surface,
                        const std::function<bool(uint32_t)>& counts);
    void vanish(const Component& component, uint32_t level);
    std::span<const uint32_t> positionsOf(uint32_t component) const {
        return std::span(positions_).subspan(first_[component], first_[component + 1] - first_[component]);
    }

    SurfaceState& state_;
    std::span<const uint32_t> facePatch_;
    std::vector<uint32_t> componentOf_; ///< a position
    std::vector<uint32_t> first_, positions_;
    std::vector<Component> waiting_; ///< those that may go, cheapest last
};

} // namespace xgc::bake
