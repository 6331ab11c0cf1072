#include <xgc/vulkan/camera.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::vulkan {
namespace {

/// The axis that is least along `v`.
glm::vec3 acrossAxis(const glm::vec3& v) {
    const glm::vec3 a = glm::abs(v);
    if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
    return a.y <= a.z ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
}

} // namespace

Camera::Basis Camera::basis() const {
    const glm::vec3 toTarget = target - eye;
    const float distance = glm::length(toTarget);
    const glm::vec3 forward = distance > 0 ? toTarget / distance : glm::vec3(0, 0, -1);
    glm::vec3 right = glm::cross(forward, up);
    if (glm::dot(right, right) < 1e-8f * glm::dot(up, up)) right = glm::cross(forward, acrossAxis(forward));
    right = glm::normalize(right);
    return {right, glm::cross(right, forward), forward};
}

glm::mat4 Camera::worldToClip() const {
    const Basis b = basis();
    const float focal = 1 / std::tan(fovY / 2);
    const float sx = focal / aspect;
    // Rows of the matrix: x, y (down), z = nearPlane, w = distance along the view.
    const glm::vec4 x(sx * b.right, -sx * glm::dot(b.right, eye));
    const glm::vec4 y(-focal * b.up, focal * glm::dot(b.up, eye));
    const glm::vec4 z(0, 0, 0, nearPlane);
    const glm::vec4 w(b.forward, -glm::dot(b.forward, eye));
    return glm::transpose(glm::mat4(x, y, z, w));
}

Camera framingCamera(const glm::vec3& center, float radius, const glm::vec3& towards, const glm::vec3& up, float fovY,
                     float aspect) {
    // The narrower of the two half angles decides.
    const float halfY = fovY / 2;
    const float halfX = std::atan(std::tan(halfY) * aspect);
    const float distance = std::max(radius, 1e-6f) / std::sin(std::min(halfX, halfY));
    Camera camera;
    camera.target = center;
    camera.eye = center + glm::normalize(towards) * distance;
    camera.up = up;
    camera.fovY = fovY;
    camera.aspect = aspect;
    camera.nearPlane = distance / 1000;
    return camera;
}

} // namespace xgc::vulkan
