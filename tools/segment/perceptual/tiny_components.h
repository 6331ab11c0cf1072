#pragma once

#include "face_labels.h"

namespace xgc::bake {

/// Tiny components take the label that they touch, a few rounds of it, then that of the nearest position; faces that
/// others stand for take theirs. `labels` has kNone for all of these before and for none after.
void placeTinyComponents(const AnalysedMesh& at, Labels& labels);

} // namespace xgc::bake
