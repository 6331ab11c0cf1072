#pragma once

#include "flags.h"

namespace xgc::bench {

/// Flights through crowds, drawn by both paths: triangles, bytes, draws, pixels that differ, time of the host.
int benchGpu(const Flags& flags);

} // namespace xgc::bench
