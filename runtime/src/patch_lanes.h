#pragma once

#include "culling.h"
#include "memory.h"

// What selection reads of patches, figure by figure, so that a few patches at a time are looked at with one
// instruction. The sums are those of distanceSquared and turnedAway, in the same order: the same bits.

namespace xgc {

/// Of the patches of all assets, or from one of them on.
struct PatchLanes {
    const float *x, *y, *z, *radius;                  ///< spheres, mesh space
    const float *axisX, *axisY, *axisZ, *sineSquared; ///< cones; a square above 1: none
    const uint8_t* coneLevel;                         ///< the coarsest at which they hold

    PatchLanes from(size_t first) const {
        return {x + first,     y + first,     z + first,           radius + first,   axisX + first,
                axisY + first, axisZ + first, sineSquared + first, coneLevel + first};
    }
};

class PatchLaneArrays {
public:
    [[nodiscard]] bool allocate(size_t count);
    void set(size_t at, const PatchBounds& patch);
    PatchLanes lanes() const;

private:
    static constexpr size_t kFigures = 8;
    size_t count_ = 0;
    FixedArray<float> figures_;
    FixedArray<uint8_t> coneLevels_;
};

/// Patches that are looked at together.
inline constexpr uint32_t kLaneBlock = 64;

/// Squared distances from the eye to the centres of `count` spheres.
void distancesSquared(const PatchLanes& lanes, uint32_t count, const Placement& placement, const View& view,
                      float* out);

/// 1 where the cone of a patch looks away from the eye, else 0: `turnedAway`.
void conesTurnedAway(const PatchLanes& lanes, uint32_t count, const MeshEye& eye, uint32_t* out);

} // namespace xgc
