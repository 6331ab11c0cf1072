#pragma once

#include <xgc/select.h>

#include <cfloat>

// Whether a sphere is far enough away for a level: the arithmetic of all selection. With s = maxScale, r the radius of
// a sphere, D the distance from the eye to its centre:
//
//   bands   t * R * s       <= D - r * s          <=>   s * (t * R + r)              <= D
//   error   E * s * k / (D - r * s) <= pixels     <=>   s * (E * k + pixels * r)     <= pixels * D
//
// Both sides are squared, so that D needs no root. The eye inside the sphere (D < r * s) fails by itself. An
// orthographic view has D = 1 and r = 0 in the second line. Nothing nearer than View::nearest is seen, so an error that
// fits there does.

namespace xgc {

/// A sphere of mesh space.
struct Sphere {
    glm::vec3 center;
    float radius;
};

inline Sphere sphereOf(const format::PatchRecord& patch) {
    return {{patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2]}, patch.sphereRadius};
}

inline Sphere sphereOf(const format::AssetRecord& asset) {
    return {{asset.sphereCenter[0], asset.sphereCenter[1], asset.sphereCenter[2]}, asset.sphereRadius};
}

/// Squared distance from the eye to a point of mesh space. The translation goes first: moving eye and asset
/// together changes nothing as long as their difference is exact.
inline float distanceSquared(const Placement& placement, const View& view, const glm::vec3& point) {
    const glm::mat4x3& m = placement.toWorld;
    const glm::vec3 offset = m[3] - view.eye;
    const float x = m[0].x * point.x + m[1].x * point.y + m[2].x * point.z + offset.x;
    const float y = m[0].y * point.x + m[1].y * point.y + m[2].y * point.z + offset.y;
    const float z = m[0].z * point.x + m[1].z * point.y + m[2].z * point.z + offset.z;
    return x * x + y * y + z * z;
}

/// reach <= away, by squares. Squares out of float's normal range decide for the finer level, so that neither
/// overflow nor a GPU's flushing of subnormals can make the answer coarser.
inline bool reaches(float reach, float awaySquared) {
    const float reachSquared = reach * reach;
    return reachSquared <= awaySquared && reachSquared <= FLT_MAX && awaySquared >= FLT_MIN;
}

/// Where a sphere stands in a view: what its levels are decided by.
struct Standing {
    float distanceSquared = 0;
    float radius = 0;
    float scale = 1; ///< Placement::maxScale
};

inline Standing standing(const Placement& placement, const View& view, const Sphere& sphere) {
    return {distanceSquared(placement, view, sphere.center), sphere.radius, placement.maxScale};
}

/// For `errorFits`.
inline Standing errorStanding(const Placement& placement, const View& view, const Sphere& sphere) {
    return view.orthographic ? Standing{1, 0, placement.maxScale} : standing(placement, view, sphere);
}

/// The second line: the error stays within the pixels. Infinite pixels take any.
inline bool errorFits(float error, const View& view, float pixels, const Standing& at) {
    if (error == 0 || pixels > FLT_MAX) return true;
    const float projected = error * view.pixelsPerUnit;
    return reaches(at.scale * (projected + pixels * at.radius), pixels * pixels * at.distanceSquared) ||
           at.scale * projected <= pixels * view.nearest;
}

/// The first line: the eye is at the threshold or beyond it. Inside the sphere it is at distance zero.
inline bool bandReached(float threshold, float assetRadius, const Standing& at) {
    if (threshold <= 0) return true;
    return reaches(at.scale * (threshold * assetRadius + at.radius), at.distanceSquared);
}

} // namespace xgc
