#pragma once

#include "flags.h"

namespace xgc::bench {

/// Sections of `sweep_segment`: the perceptual segmentation. Return 0 or an exit code.
/// Parts of changed meshes beside those of the original.
int sweepStability(const Flags& flags);
/// Counts of parts on meshes of every kind.
int sweepGenerality(const Flags& flags);
/// Hashes of labels, and whether any number of threads gives them; 1 where it does not.
int sweepDeterminism(const Flags& flags);

} // namespace xgc::bench
