#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake {

/// Appends a row that lies between two, `share` of the way from `a` to `b`: directions are mixed and renormalised,
/// influences are mixed by joint and the strongest kept (ties to the lower joint), everything else is mixed.
void appendAverage(Attributes& attributes, uint32_t a, uint32_t b, float share = 0.5f);

} // namespace xgc::bake
