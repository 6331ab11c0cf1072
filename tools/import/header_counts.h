#pragma once

#include <import/readers.h>

namespace xgc::bake {

/// Refuses an OFF or PLY file whose header promises more elements than the file has bytes, before Assimp makes room
/// for them.
Status checkHeaderCounts(const Source& source);

} // namespace xgc::bake
