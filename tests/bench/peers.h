#pragma once

#include "surface.h"

namespace xgc::bench {

/// meshopt_simplify of the packaged meshoptimizer with default flags and no limit on the error: at most `faces`
/// triangles where the mesh's topology lets it get there. Rows stay those of the input.
Surface meshoptSimplify(const Surface& surface, uint32_t faces);

} // namespace xgc::bench
