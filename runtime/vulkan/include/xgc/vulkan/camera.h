#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace xgc::vulkan {

/// A perspective camera for Vulkan: right-handed world, y down in clip space, reversed depth with the far plane at
/// infinity (depth 1 at `nearPlane`, 0 infinitely far).
struct Camera {
    glm::vec3 eye{0, 0, 1};
    glm::vec3 target{0};
    glm::vec3 up{0, 1, 0};
    float fovY = 0.7f; ///< radians
    float aspect = 1;  ///< width / height
    float nearPlane = 0.01f;

    /// Unit vectors in the world. Where `up` is along the view, another is taken.
    struct Basis {
        glm::vec3 right, up, forward;
    };
    Basis basis() const;
    glm::mat4 worldToClip() const;
};

/// A camera that sees a whole sphere, just, from the direction `towards` (from its centre, any length).
Camera framingCamera(const glm::vec3& center, float radius, const glm::vec3& towards, const glm::vec3& up, float fovY,
                     float aspect);

} // namespace xgc::vulkan
