#include "camera.h"

#include <algorithm>

namespace xgc::bake {

namespace {

glm::dvec3 unitOr(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 1e-12 ? v / length : otherwise;
}

} // namespace

FittedCamera::FittedCamera(const Mesh& mesh, const PictureOptions& options) {
    forward_ = -unitOr(glm::dvec3(options.viewFrom), {0, 0, 1});
    const glm::dvec3 sideways = glm::cross(forward_, glm::dvec3(options.up));
    const glm::dvec3 other =
        glm::cross(forward_, glm::abs(forward_.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
    right_ = unitOr(sideways, glm::normalize(other));
    up_ = glm::cross(right_, forward_);

    glm::dvec3 low(0), high(0);
    if (!mesh.faces.empty()) low = high = glm::dvec3(mesh.positions[mesh.facePositions(0).x]);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 p(mesh.positions[mesh.facePositions(f)[k]]);
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    center_ = (low + high) * 0.5;
    radius_ = glm::length(high - low) * 0.5;
    if (!(radius_ > 0)) radius_ = 1;

    // Each side of the frustum touches the mesh where x - t z is largest: from two opposite sides follow the eye's
    // place across and its distance.
    const double ty = double(options.tanHalfFov), tx = ty * options.width / options.height;
    const double fill = 1 - double(options.margin);
    double left = 0, right = 0, bottom = 0, top = 0, nearest = 0;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 d =
                directionToView((glm::dvec3(mesh.positions[mesh.facePositions(f)[k]]) - center_) / radius_);
            const bool first = f == 0 && k == 0;
            const auto widen = [&](double& bound, double value) { bound = first ? value : std::max(bound, value); };
            widen(right, d.x - tx * fill * d.z);
            widen(left, -d.x - tx * fill * d.z);
            widen(top, d.y - ty * fill * d.z);
            widen(bottom, -d.y - ty * fill * d.z);
            widen(nearest, -d.z);
        }
    }
    const double distance =
        std::max({(left + right) / (2 * tx * fill), (top + bottom) / (2 * ty * fill), nearest + 0.1});
    eye_ = {(right - left) / 2, (top - bottom) / 2, -distance};

    halfWidth_ = options.width * options.samples * 0.5;
    halfHeight_ = options.height * options.samples * 0.5;
    scale_ = halfHeight_ / ty;
}

glm::dvec3 FittedCamera::toView(const glm::vec3& p) const {
    return directionToView((glm::dvec3(p) - center_) / radius_) - eye_;
}

} // namespace xgc::bake
