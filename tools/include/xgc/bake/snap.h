#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake {

/// The finest power of two at which `bits` bits (1..24) count the cells along the longest side of the model's bounds;
/// 0 where it has no extent. A power of two, so that multiples of it are exact floats on any machine, and models
/// snapped to the same one fit together.
float snapStep(const Model& model, uint32_t bits);

/// Moves every position to the nearest multiples of `step`, before anything is built on it: so no crack opens. Returns
/// the largest distance that one moved, rounded up. Positions that are so far from the origin that their floats are
/// coarser than the step stay.
float snapPositions(Model& model, float step);

} // namespace xgc::bake
