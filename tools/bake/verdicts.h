#pragma once

#include <xgc/bake/bake.h>

namespace xgc::bake {

/// Writes the verdicts of a finished bake from what its stages reported.
void judge(const BakeOptions& options, BakeReport& report);

} // namespace xgc::bake
