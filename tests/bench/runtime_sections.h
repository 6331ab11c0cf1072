#pragma once

#include "flags.h"

/// The sections of bench_runtime, a file each. They print a table and write rows of CSV where asked to; 0 or the exit
/// code of a failure.
namespace xgc::bench {

/// Frames of ten thousand instances: nanoseconds a patch, and beside a pass that only reads.
int benchCrowd(const Flags& flags);
/// Triangles and bytes along flights: one level for a mesh, a level a part, a level a patch.
int benchView(const Flags& flags);
/// Triangles of far instances beside another program's at equal deviation.
int benchFar(const Flags& flags);

} // namespace xgc::bench
