#pragma once

#include "linked_faces.h"

namespace xgc::bake {

/// How a component of a mesh is put before it is segmented: its centroid at the origin, turned so that it extends most
/// along x and least along z, the longer tails towards +x and +y, scaled to an area of 1. What goes by place (cubes of
/// a grid, directions of rays) then does not change with how the mesh lies in space.
struct Pose {
    glm::dvec3 centroid{0};
    glm::dmat3 turn{1.0};
    double scale = 1;

    glm::vec3 placeOf(const glm::dvec3& point) const { return glm::vec3(turn * (point - centroid) * scale); }
    glm::vec3 directionOf(const glm::vec3& direction) const { return glm::vec3(turn * glm::dvec3(direction)); }
};

/// `faceAreas` and `area` (their sum over `faces`, over 0) in mesh units.
Pose poseOf(const Mesh& mesh, const LinkedFaces& linked, std::span<const uint32_t> faces,
            std::span<const double> faceAreas, double area);

} // namespace xgc::bake
