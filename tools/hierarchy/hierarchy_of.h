#pragma once

#include "hierarchy/surface_state.h"

namespace xgc::bake {

/// The positions, wedges and domains of a finished build in runtime form; made vertices are numbered behind the
/// mesh's, and those that no state draws are left out. Takes the domains from the state.
Hierarchy hierarchyOf(SurfaceState& state);

} // namespace xgc::bake
