#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

/// Splits a polygon into corners - 2 triangles, which are appended as corner numbers and keep its winding. A fan
/// where one covers the polygon, else ear clipping in the plane of the polygon's mean normal. A polygon that crosses
/// itself or has no area still gives its number of triangles. Three corners or more.
void triangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& out);

} // namespace xgc::bake
