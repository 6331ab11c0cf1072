#include <xgc/vulkan/camera.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

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

// With x right, y up and z towards the eye, the eye at (ex, ey, d) sees a point where |x - ex| <= t (d - z): for the
// right side t d + ex >= x + t z, for the left t d - ex >= -x + t z. So the extremes of +-x + t z over all points give
// the least d and the ex in the middle; likewise for y.
Camera frame(std::span<const glm::vec3> points, const Framing& framing) {
    Camera camera;
    camera.up = framing.up;
    camera.fovY = framing.fovY;
    camera.aspect = framing.aspect;
    camera.eye = framing.towards;
    camera.target = glm::vec3(0);
    const Camera::Basis basis = camera.basis();
    const float ty = std::tan(framing.fovY / 2) / framing.margin, tx = ty * framing.aspect;

    const glm::vec3 origin = points.front();
    glm::vec3 low(0), high(0);  // x, y, z
    glm::vec4 extremes(-1e30f); // right, left, up, down
    for (const glm::vec3& p : points) {
        const glm::vec3 o = p - origin;
        const glm::vec3 v(glm::dot(o, basis.right), glm::dot(o, basis.up), -glm::dot(o, basis.forward));
        low = glm::min(low, v);
        high = glm::max(high, v);
        extremes = glm::max(extremes, {v.x + tx * v.z, tx * v.z - v.x, v.y + ty * v.z, ty * v.z - v.y});
    }
    const float size = std::max(glm::length(high - low), 1e-6f);
    const float depth =
        std::max({(extremes.x + extremes.y) / (2 * tx), (extremes.z + extremes.w) / (2 * ty), high.z + 0.01f * size});
    // One of the two directions may have room to spare: there the middle depends on the depth.
    glm::vec2 eye((extremes.x - extremes.y) / 2, (extremes.z - extremes.w) / 2);
    for (int pass = 0; pass < 6; ++pass) {
        glm::vec2 least(1e30f), most(-1e30f);
        for (const glm::vec3& p : points) {
            const glm::vec3 o = p - origin;
            const glm::vec2 across(glm::dot(o, basis.right), glm::dot(o, basis.up));
            const glm::vec2 slope = (across - eye) / (depth + glm::dot(o, basis.forward));
            least = glm::min(least, slope);
            most = glm::max(most, slope);
        }
        eye += 0.5f * (least + most) * (depth - (low.z + high.z) / 2);
    }
    const glm::vec3 middle = origin + basis.right * eye.x + basis.up * eye.y - basis.forward * ((low.z + high.z) / 2);
    camera.target = middle;
    camera.eye = middle - basis.forward * (depth - (low.z + high.z) / 2);
    camera.nearPlane = 0.001f * size;
    return camera;
}

} // namespace xgc::vulkan
