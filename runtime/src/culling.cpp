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

MeshEye meshEye(const View& view, const glm::mat4x3& toWorld) {
    const glm::mat3 linear(toWorld);
    const float volume = glm::determinant(linear);
    MeshEye eye;
    eye.orthographic = view.orthographic;
    eye.valid = std::fabs(volume) > FLT_MIN && std::isfinite(volume);
    if (!eye.valid) return eye;
    const glm::mat3 toMesh = glm::inverse(linear);
    eye.point = toMesh * (view.eye - toWorld[3]);
    eye.forward = toMesh * view.forward;
    return eye;
}

} // namespace xgc
