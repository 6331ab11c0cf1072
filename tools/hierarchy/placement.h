#pragma once

#include "hierarchy/attribute_quadrics.h"
#include "hierarchy/surface_state.h"

#include <xgc/bake/default_hierarchy.h>

namespace xgc::bake {

/// Where two vertices could meet, and what it costs.
struct Meeting {
    glm::dvec3 point; ///< about the state's origin
    double cost;
};

/// The best point for both by `placement`, which must be one that makes vertices. `wedges`: a pair that would become
/// one.
Meeting meetingOf(const SurfaceState& state, const AttributeQuadrics& attributes, Placement placement, uint32_t v,
                  uint32_t w, std::pair<uint32_t, uint32_t> wedges);

} // namespace xgc::bake
