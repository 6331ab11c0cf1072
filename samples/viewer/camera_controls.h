#pragma once

#include <xgc/vulkan/camera.h>

#include <span>

namespace xgc::viewer {

/// A camera that orbits a target and flies: one state for both. Orbiting turns the eye about the target, looking turns
/// the target about the eye.
class CameraControls {
public:
    /// Looks at points from three quarters, a little above, so that they fill the picture. At least one.
    void frame(std::span<const glm::vec3> points, float aspect);
    /// Moves to where a sphere fits; the direction stays.
    void focus(const glm::vec3& center, float radius, float aspect);
    /// Up in the world: y or, for models made so, z.
    void setUp(const glm::vec3& up);

    // Drags, in pixels of a picture of `height` of them.
    void orbit(float dx, float dy, float height);
    void look(float dx, float dy, float height);
    /// What is under the pointer at the target's depth follows it.
    void pan(float dx, float dy, float height);
    /// Positive steps go nearer. Never past the target, never out of reach.
    void zoom(float steps);
    /// Flies: right, up and forward are -1 to 1. Speed goes with the distance to the target.
    void fly(const glm::vec3& direction, float seconds);

    vulkan::Camera camera(float aspect) const;
    const glm::vec3& target() const { return target_; }
    float distance() const { return distance_; }

private:
    glm::vec3 forward() const;

    glm::vec3 target_{0};
    glm::vec3 up_{0, 1, 0};
    float distance_ = 3;
    float yaw_ = 0.55f;   ///< radians about `up_`
    float pitch_ = 0.30f; ///< radians that the eye is above the target
    float fovY_ = 0.6f;
    float extent_ = 1; ///< radius of what was framed
};

} // namespace xgc::viewer
