#pragma once

#include <xgc/bake/picture.h>

namespace xgc::bake {

/// A perspective camera that sees all of a mesh. View space: x right, y up, z into the picture, in radii of the mesh.
class FittedCamera {
public:
    FittedCamera(const Mesh& mesh, const PictureOptions& options);

    glm::dvec3 toView(const glm::vec3& p) const;
    glm::dvec3 directionToView(const glm::dvec3& d) const {
        return {glm::dot(right_, d), glm::dot(up_, d), glm::dot(forward_, d)};
    }
    /// Sample coordinates from the top left corner, and 1 / depth.
    glm::dvec3 toScreen(const glm::dvec3& view) const {
        return {halfWidth_ + scale_ * view.x / view.z, halfHeight_ - scale_ * view.y / view.z, 1 / view.z};
    }
    /// Change of 1 / depth, relative, when a point moves by one sample's width towards the eye.
    double relativeSampleSize() const { return 1 / scale_; }

private:
    glm::dvec3 right_{1, 0, 0}, up_{0, 1, 0}, forward_{0, 0, -1};
    glm::dvec3 center_{0};
    double radius_ = 1;
    glm::dvec3 eye_{0}; ///< in view directions, radii from the centre
    double halfWidth_ = 0, halfHeight_ = 0, scale_ = 0;
};

} // namespace xgc::bake
