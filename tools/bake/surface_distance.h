#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace xgc::bake {

struct Triangle {
    glm::vec3 a, b, c;
};

/// Squared distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double squaredDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Nearest-point queries against a triangle soup. Double precision, the same answers on any machine.
class SurfaceDistance {
public:
    explicit SurfaceDistance(std::vector<Triangle> triangles);

    struct Hit {
        double squared;    ///< distance; infinite where there is no surface
        uint32_t triangle; ///< that lies so near, of those given
    };
    /// The nearest triangle to `p`, or any at or below the squared distance `enough`.
    Hit nearest(const glm::dvec3& p, double enough = 0) const;
    /// Among the triangles, as given, that `counts` takes; infinite beyond the squared distance `most`.
    Hit nearest(const glm::dvec3& p, double enough, double most, const std::function<bool(uint32_t)>& counts) const;

private:
    template <typename Counts>
    Hit search(const glm::dvec3& p, double enough, double most, const Counts& counts) const;

    struct Node {
        glm::vec3 low, high;
        uint32_t first; ///< leaf: first triangle; inner: right child (the left one follows)
        uint32_t count; ///< 0: inner
    };
    void build(uint32_t first, uint32_t last, const std::vector<glm::vec3>& centroids, std::vector<uint32_t>& order);

    std::vector<Triangle> triangles_; ///< in the order of the leaves
    std::vector<uint32_t> given_;     ///< triangle as given, by leaf order
    std::vector<Node> nodes_;
};

} // namespace xgc::bake
