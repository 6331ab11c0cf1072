#pragma once

#include "drawn_asset.h"

#include <xgc/vulkan/camera.h>

#include <glm/vec2.hpp>

#include <optional>

namespace xgc::viewer {

struct Ray {
    glm::vec3 origin{0};
    glm::vec3 direction{0, 0, -1}; ///< any length but 0
};

/// Through a point of the picture: 0, 0 is its upper left corner, 1, 1 the lower right one.
Ray rayThrough(const vulkan::Camera& camera, const glm::vec2& place);

struct Hit {
    uint32_t asset = 0; ///< of those that were given
    uint32_t patch = 0;
    uint32_t part = 0;
    float along = 0; ///< of the ray's direction
    glm::vec3 position{0};
};

/// The nearest triangle, as it is drawn, that the ray meets from either side. Where parts meet at one point, the first.
std::optional<Hit> pick(std::span<const DrawnAsset> assets, const Ray& ray);

} // namespace xgc::viewer
