#include "culling.h"

#include <glm/matrix.hpp>

#include <cmath>

namespace xgc {

Frustum makeFrustum(const glm::mat4& worldToClip) {
    const glm::mat4 rows = glm::transpose(worldToClip);
    const glm::vec4 all[] = {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1],
                             rows[3] - rows[1], rows[2],           rows[3] - rows[2]};
    Frustum out;
    for (const glm::vec4& plane : all) {
        const float length = glm::length(glm::vec3(plane));
        // The missing far plane of an infinite projection has no direction.
        if (length > 1e-6f * std::fabs(plane.w)) out.planes[out.planeCount++] = plane / length;
    }
    return out;
}

bool inverseOf(const Placement& placement, glm::mat3& toMesh) {
    const glm::mat3 linear(placement.toWorld);
    const float volume = glm::determinant(linear);
    if (!(std::fabs(volume) > FLT_MIN && std::isfinite(volume))) return false;
    toMesh = glm::inverse(linear);
    return true;
}

MeshEye meshEye(const View& view, const Placement& placement) {
    MeshEye eye;
    eye.orthographic = view.orthographic;
    glm::mat3 toMesh;
    eye.valid = inverseOf(placement, toMesh);
    if (!eye.valid) return eye;
    eye.point = toMesh * (view.eye - placement.toWorld[3]);
    eye.forward = toMesh * view.forward;
    return eye;
}

} // namespace xgc
