#pragma once

#include <glm/glm.hpp>

#include <cstdint>
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

    /// Squared distance from `p` to the surface, or any value at or below `enough` once the surface is known to
    /// lie that near. Infinite where there is no surface.
    double squared(const glm::dvec3& p, double enough = 0) const;

private:
    struct Node {
        glm::vec3 low, high;
        uint32_t first; ///< leaf: first triangle; inner: right child (the left one follows)
        uint32_t count; ///< 0: inner
    };
    void build(uint32_t first, uint32_t last, const std::vector<glm::vec3>& centroids, std::vector<uint32_t>& order);

    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

} // namespace xgc::bake
