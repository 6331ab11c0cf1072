#pragma once

#include "level_test.h"

#include <xgc/selection.h>

#include <glm/geometric.hpp>

// Culling by +, -, * and comparisons: lengths are compared by their squares. Planes are turned into the mesh space of
// an instance once, so that the spheres of its patches stay exact spheres under any placement.

namespace xgc {

enum class Side : uint32_t { outside, across, inside };

/// Where a sphere lies to a half-space; `plane` need not be of unit length.
inline Side sideOf(const glm::vec4& plane, const Sphere& sphere) {
    const glm::vec3 normal(plane);
    const float value = glm::dot(normal, sphere.center) + plane.w;
    const float reachSquared = sphere.radius * sphere.radius * glm::dot(normal, normal);
    if (value * value < reachSquared) return Side::across;
    return value < 0 ? Side::outside : Side::inside;
}

inline Side sideOf(const Frustum& frustum, const Sphere& sphere) {
    Side side = Side::inside;
    for (uint32_t i = 0; i < frustum.planeCount; ++i) {
        const Side one = sideOf(frustum.planes[i], sphere);
        if (one == Side::outside) return one;
        if (one == Side::across) side = one;
    }
    return side;
}

/// The half-spaces of world space in the mesh space of an instance.
inline Frustum toMeshSpace(const Frustum& world, const glm::mat4x3& toWorld) {
    Frustum mesh;
    mesh.planeCount = world.planeCount;
    for (uint32_t i = 0; i < world.planeCount; ++i) {
        const glm::vec3 n(world.planes[i]);
        mesh.planes[i] = {glm::dot(n, toWorld[0]), glm::dot(n, toWorld[1]), glm::dot(n, toWorld[2]),
                          glm::dot(n, toWorld[3]) + world.planes[i].w};
    }
    return mesh;
}

/// Where a view looks from, in the mesh space of an instance; empty (no cone is tested) where its placement is flat.
struct MeshEye {
    glm::vec3 point{0};
    glm::vec3 forward{0}; ///< where the view is orthographic
    bool orthographic = false;
    bool valid = false;
};

MeshEye meshEye(const View& view, const Placement& placement);

/// True where all normals of the cone look away from the eye, wherever in the sphere their faces lie: with v from the
/// eye to the centre, dot(v, axis) >= |v| * sine + radius.
inline bool turnedAway(const MeshEye& eye, const PatchBounds& patch) {
    if (!eye.valid || patch.coneSine > 1) return false;
    const glm::vec3 v = eye.orthographic ? eye.forward : glm::vec3(patch.sphere) - eye.point;
    const float along = glm::dot(v, patch.coneAxis) - (eye.orthographic ? 0.0f : patch.sphere.w);
    const float sineSquared = patch.coneSine * patch.coneSine + 1e-4f; // against rounding
    return along > 0 && along * along >= sineSquared * glm::dot(v, v);
}

/// True where the sphere covers a smaller radius than so many pixels.
inline bool tooSmall(float pixels, float pixelsPerUnit, bool orthographic, const Standing& at) {
    const float covers = at.scale * at.radius * pixelsPerUnit;
    return covers * covers < pixels * pixels * (orthographic ? 1.0f : at.distanceSquared);
}

} // namespace xgc
