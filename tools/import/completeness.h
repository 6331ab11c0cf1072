#pragma once

#include <import/readers.h>

namespace xgc::bake {

/// Refuses OFF, PLY and STL files that hold less than they promise, or promise more than they could hold. Assimp makes
/// room by the header alone, fills up what is missing in silence, and looks for ever for a PLY header's end.
Status checkComplete(const Source& source);

} // namespace xgc::bake
