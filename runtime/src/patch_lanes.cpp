#include "patch_lanes.h"

#include <algorithm>
#include <limits>

namespace xgc {

bool PatchLaneArrays::allocate(size_t count) {
    count_ = count;
    return figures_.allocate(kFigures * count) && coneLevels_.allocate(count);
}

void PatchLaneArrays::set(size_t at, const PatchBounds& patch) {
    const float sine = patch.coneSine;
    const float values[kFigures] = {patch.sphere.x,   patch.sphere.y,   patch.sphere.z,   patch.sphere.w,
                                    patch.coneAxis.x, patch.coneAxis.y, patch.coneAxis.z, sine * sine + 1e-4f};
    for (size_t i = 0; i < kFigures; ++i) figures_[i * count_ + at] = values[i];
    if (sine > 1) figures_[(kFigures - 1) * count_ + at] = std::numeric_limits<float>::infinity();
    coneLevels_[at] = uint8_t(std::min<uint32_t>(patch.coneLevel, format::kNever));
}

PatchLanes PatchLaneArrays::lanes() const {
    const float* f = figures_.data();
    const size_t n = count_;
    return {f, f + n, f + 2 * n, f + 3 * n, f + 4 * n, f + 5 * n, f + 6 * n, f + 7 * n, coneLevels_.data()};
}

void distancesSquared(const PatchLanes& lanes, uint32_t count, const Placement& placement, const View& view,
                      float* out) {
    const glm::mat4x3 m = placement.toWorld;
    const glm::vec3 offset = m[3] - view.eye;
    for (uint32_t i = 0; i < count; ++i) {
        const float x = m[0].x * lanes.x[i] + m[1].x * lanes.y[i] + m[2].x * lanes.z[i] + offset.x;
        const float y = m[0].y * lanes.x[i] + m[1].y * lanes.y[i] + m[2].y * lanes.z[i] + offset.y;
        const float z = m[0].z * lanes.x[i] + m[1].z * lanes.y[i] + m[2].z * lanes.z[i] + offset.z;
        out[i] = x * x + y * y + z * z;
    }
}

void conesTurnedAway(const PatchLanes& lanes, uint32_t count, const MeshEye& eye, uint32_t* out) {
    const glm::vec3 from = eye.point;
    for (uint32_t i = 0; i < count; ++i) {
        const float x = lanes.x[i] - from.x, y = lanes.y[i] - from.y, z = lanes.z[i] - from.z;
        const float along = x * lanes.axisX[i] + y * lanes.axisY[i] + z * lanes.axisZ[i] - lanes.radius[i];
        const float least = lanes.sineSquared[i] * (x * x + y * y + z * z);
        out[i] = uint32_t(along > 0) & uint32_t(along * along >= least);
    }
}

} // namespace xgc
