#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <span>

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

/// What a framing camera is told beside what it frames.
struct Framing {
    glm::vec3 towards{0, 0, 1}; ///< from what is framed to the eye, any length
    glm::vec3 up{0, 1, 0};
    float fovY = 0.7f;
    float aspect = 1;
    float margin = 1.06f; ///< 1: touches the edges of the picture
};

/// The nearest camera that sees all points, in the middle of the picture. At least one point.
Camera frame(std::span<const glm::vec3> points, const Framing& framing);

} // namespace xgc::vulkan
