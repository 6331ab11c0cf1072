#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake {

/// Appends a row that lies halfway between two: directions are averaged and renormalised, influences are averaged
/// by joint and the strongest kept (ties to the lower joint), everything else is averaged.
void appendAverage(Attributes& attributes, uint32_t a, uint32_t b);

} // namespace xgc::bake
