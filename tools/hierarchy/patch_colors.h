#pragma once

#include "hierarchy/surface_state.h"

namespace xgc::bake {

/// Groups patches so that no two of a group have a vertex of the uniform state in common: those of a group may
/// be worked on at the same time. Depends on the patches and the state alone.
std::vector<std::vector<uint32_t>> colorPatches(const SurfaceState& state, std::span<const uint32_t> patches);

} // namespace xgc::bake
