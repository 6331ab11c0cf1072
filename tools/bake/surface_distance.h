#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace xgc::bake {

struct Triangle {
    glm::vec3 a, b, c;
};

/// Squared distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
inline double squaredDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return squared(ap);
    const glm::dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return squared(bp);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return squared(ap - ab * (d1 / (d1 - d3)));
    const glm::dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return squared(cp);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return squared(ap - ac * (d2 / (d2 - d6)));
    const double va = d3 * d6 - d5 * d4;
    const double u = d4 - d3, v = d5 - d6;
    if (va <= 0 && u >= 0 && v >= 0 && u + v > 0) return squared(bp - (c - b) * (u / (u + v)));
    const double sum = va + vb + vc;
    if (!(sum > 0)) return std::min({squared(ap), squared(bp), squared(cp)});
    return squared(ap - ab * (vb / sum) - ac * (vc / sum));
}

/// Nearest-point queries against a triangle soup. Double precision, the same answers on any machine.
class SurfaceDistance {
public:
    explicit SurfaceDistance(std::vector<Triangle> triangles);

    struct Hit {
        double squared;    ///< distance; infinite where there is no surface
        uint32_t triangle; ///< that lies so near, of those given
    };
    /// The nearest triangle to `p`, or any at or below the squared distance `enough`; infinite beyond `most`.
    Hit nearest(const glm::dvec3& p, double enough = 0, double most = std::numeric_limits<double>::infinity()) const;
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
