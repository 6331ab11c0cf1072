#pragma once

#include "hierarchy/surface_state.h"

#include <xgc/bake/default_hierarchy.h>

namespace xgc::bake {

/// Where two vertices could meet, and what it costs.
struct Meeting {
    glm::dvec3 point; ///< about the state's origin
    double cost;
};

/// The best point for both by `placement`, which must be one that makes vertices.
Meeting meetingOf(const SurfaceState& state, Placement placement, uint32_t v, uint32_t w);

} // namespace xgc::bake
