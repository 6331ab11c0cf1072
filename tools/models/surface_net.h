#pragma once

#include "models/implicit.h"

namespace xgc::bake::models {

/// A closed manifold over a body: one component, outward triangles, two to a quad.
struct Surface {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<Skin> skins;
    std::vector<glm::uvec3> triangles;
};

/// Polygonises a body inside a box with about `faces` triangles. Thin limbs are fattened where the
/// grid is too coarse to see them.
Surface polygonise(const Body& body, glm::vec3 low, glm::vec3 high, uint32_t faces);

} // namespace xgc::bake::models
