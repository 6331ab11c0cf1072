#pragma once

#include "sampled_distance.h"

namespace xgc::bench {

/// How far the attributes of one surface are from another's, over samples of both ways. A sample is compared with what
/// the other surface has near it: of the points on triangles not much farther than the nearest one, the one that
/// agrees best, so that a seam or a crease that moved a little is not taken for its other side.
struct AttributeDeviation {
    double normalDegrees = 0; ///< RMS angle between interpolated normals
    double uvRms = 0;   ///< RMS distance of UVs, as a length on the surface: times sqrt(area / UV area), mesh units
    double stretch = 0; ///< RMS of ln of the ratio of L2 texture stretches (Sander et al. 2001)
};

/// Zero where either surface lacks the attribute.
AttributeDeviation compareAttributes(const Surface& reference, const Surface& other, uint32_t samples);

} // namespace xgc::bench
