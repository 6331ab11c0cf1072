#pragma once

#include <xgc/vulkan/camera.h>

#include <glm/vec2.hpp>

#include <vector>

namespace xgc::viewer {

/// Two points of a picture: 0, 0 is its upper left corner, 1, 1 the lower right one.
struct Line {
    glm::vec2 from, to;
};

/// A segment of the world as a camera sees it, clipped at its near plane; none where it is behind.
std::vector<Line> project(const vulkan::Camera& camera, const glm::vec3& from, const glm::vec3& to);

/// The edges of what `of` sees up to a depth, as seen by another camera: four rays from its eye and the far rectangle,
/// and an arrow's tip that says where up is.
std::vector<Line> frustumLines(const vulkan::Camera& seenBy, const vulkan::Camera& of, float depth);

} // namespace xgc::viewer
