#include "camera_controls.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::viewer {
namespace {

constexpr float kYaw = 0.55f, kPitch = 0.30f;
constexpr float kSteepest = 1.55f; ///< radians: short of straight up, where the horizon would flip
constexpr float kRadiansAPicture = 3.6f;
constexpr float kZoomStep = 0.88f;
constexpr float kNearest = 1e-3f, kFarthest = 300; ///< radii of what was framed
constexpr float kFlySpeed = 1.1f;                  ///< distances a second

/// Distance at which a sphere fits a picture.
float distanceFor(float radius, float fovY, float aspect) {
    const float half = std::atan(std::tan(fovY / 2) * std::min(1.0f, aspect));
    return 1.08f * radius / std::sin(half);
}

} // namespace

void CameraControls::frame(std::span<const glm::vec3> points, float aspect) {
    yaw_ = kYaw;
    pitch_ = kPitch;
    vulkan::Framing framing;
    framing.towards = -forward();
    framing.up = up_;
    framing.fovY = fovY_;
    framing.aspect = aspect;
    framing.margin = 1.12f;
    const vulkan::Camera fitted = vulkan::frame(points, framing);
    target_ = fitted.target;
    distance_ = std::max(glm::distance(fitted.eye, fitted.target), 1e-6f);
    extent_ = 0.3f * distance_;
}

void CameraControls::focus(const glm::vec3& center, float radius, float aspect) {
    target_ = center;
    distance_ = distanceFor(std::max(radius, kNearest * extent_), fovY_, aspect);
}

void CameraControls::setUp(const glm::vec3& up) {
    up_ = up;
}

/// From eye to target.
glm::vec3 CameraControls::forward() const {
    // The axis that yaw 0 looks along: -z where y is up, y where z is.
    const glm::vec3 back = up_.y > 0.5f ? glm::vec3(0, 0, 1) : glm::vec3(0, -1, 0);
    const glm::vec3 side = glm::cross(up_, back);
    const glm::vec3 level = std::cos(yaw_) * back + std::sin(yaw_) * side;
    return -(std::cos(pitch_) * level + std::sin(pitch_) * up_);
}

void CameraControls::orbit(float dx, float dy, float height) {
    yaw_ = std::remainder(yaw_ - kRadiansAPicture * dx / height, 6.2831853f);
    pitch_ = std::clamp(pitch_ + kRadiansAPicture * dy / height, -kSteepest, kSteepest);
}

void CameraControls::look(float dx, float dy, float height) {
    const glm::vec3 eye = target_ - distance_ * forward();
    orbit(0.5f * dx, 0.5f * dy, height);
    target_ = eye + distance_ * forward();
}

void CameraControls::pan(float dx, float dy, float height) {
    const vulkan::Camera::Basis basis = camera(1).basis();
    const float unitsAPixel = 2 * distance_ * std::tan(fovY_ / 2) / height;
    target_ += unitsAPixel * (dy * basis.up - dx * basis.right);
}

void CameraControls::zoom(float steps) {
    distance_ = std::clamp(distance_ * std::pow(kZoomStep, steps), kNearest * extent_, kFarthest * extent_);
}

void CameraControls::fly(const glm::vec3& direction, float seconds) {
    const vulkan::Camera::Basis basis = camera(1).basis();
    const float speed = kFlySpeed * std::max(distance_, 0.05f * extent_);
    target_ += seconds * speed * (direction.x * basis.right + direction.y * up_ + direction.z * basis.forward);
}

vulkan::Camera CameraControls::camera(float aspect) const {
    vulkan::Camera camera;
    camera.target = target_;
    camera.eye = target_ - distance_ * forward();
    camera.up = up_;
    camera.fovY = fovY_;
    camera.aspect = aspect;
    camera.nearPlane = std::min(0.002f * extent_, 0.1f * distance_);
    return camera;
}

} // namespace xgc::viewer
