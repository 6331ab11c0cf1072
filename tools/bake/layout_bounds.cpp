#include "bake/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// Bounds and normal cones hold in every state, so they range over all that a corner can become, not over the input
// alone. Everything is computed in double and rounded outwards once.

namespace xgc::bake::layout {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Largest squared distance from a centre, and the point that has it.
std::pair<double, size_t> farthest(std::span<const glm::vec3> points, const glm::dvec3& center) {
    double most = -1;
    size_t at = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(points[i]) - center;
        const double squared = glm::dot(d, d);
        if (squared > most) {
            most = squared;
            at = i;
        }
    }
    return {most, at};
}

/// The centre moves towards the farthest point by ever smaller steps (Badoiu and Clarkson 2003).
Sphere sphereAround(std::span<const glm::vec3> points, glm::dvec3 center) {
    constexpr int kSteps = 24;
    double least = std::numeric_limits<double>::infinity();
    glm::dvec3 best = center;
    for (int step = 1; step <= kSteps; ++step) {
        const auto [squared, at] = farthest(points, center);
        if (squared < least) {
            least = squared;
            best = center;
        }
        center += (glm::dvec3(points[at]) - center) / double(step + 1);
    }
    Sphere sphere;
    sphere.center = glm::vec3(best);
    const double radius = std::sqrt(farthest(points, glm::dvec3(sphere.center)).first);
    // Room for the rounding of a reader's own distances.
    sphere.radius = radius > 0 ? std::nextafter(float(radius * (1 + 1e-6)), kInfinity) : 0.0f;
    return sphere;
}

} // namespace

Bounds boundsOf(std::span<const glm::vec3> points) {
    Bounds bounds;
    if (points.empty()) return bounds;
    bounds.low = bounds.high = points.front();
    for (const glm::vec3& p : points) {
        bounds.low = glm::min(bounds.low, p);
        bounds.high = glm::max(bounds.high, p);
    }
    bounds.sphere = sphereAround(points, (glm::dvec3(bounds.low) + glm::dvec3(bounds.high)) * 0.5);
    return bounds;
}

Bounds boundsOfPatch(const Mesh& mesh, const Hierarchy& h, std::span<const uint32_t> faces, uint32_t patch,
                     std::vector<uint32_t>& scratch) {
    std::vector<glm::vec3> points;
    const uint32_t mark = patch + 1;
    for (const uint32_t f : faces) {
        for (int k = 0; k < 3; ++k) {
            for (uint32_t w = mesh.faces[f][k]; w != kNone && scratch[w] != mark; w = h.wedgeParent[w]) {
                scratch[w] = mark;
                points.push_back(h.positions[h.wedgePosition[w]]);
            }
        }
    }
    return boundsOf(points);
}

namespace {

/// What a corner can become, and the patch's level from which on it can.
struct Stop {
    uint32_t position;
    uint32_t level;
};

void stopsOf(const Hierarchy& h, uint32_t wedge, std::vector<Stop>& stops) {
    stops.clear();
    uint32_t level = 0, domain = kNone;
    for (; wedge != kNone; wedge = h.wedgeParent[wedge]) {
        const uint32_t p = h.wedgePosition[wedge];
        // Steps of one level pass at once: only the last stop of a level is ever drawn. But where the domain widens,
        // a neighbour may hold a stop, however early it collapses.
        if (h.collapseLevel[p] > level || h.domain[p] != domain) stops.push_back({p, level});
        level = std::max<uint32_t>(level, h.collapseLevel[p]);
        domain = h.domain[p];
    }
}

/// Not normalised; zero for triangles without area, which draw nothing.
glm::dvec3 normalOf(const Hierarchy& h, uint32_t a, uint32_t b, uint32_t c) {
    const glm::dvec3 o(h.positions[a]);
    return glm::cross(glm::dvec3(h.positions[b]) - o, glm::dvec3(h.positions[c]) - o);
}

/// Least cosine to the axis of the triangles that appear first at each level.
class LevelCosines {
public:
    LevelCosines(const Hierarchy& h, const glm::vec3& axis)
        : least(h.levelCount, 1.0), h_(h), axis_(axis), end_(h.levelCount) {}

    std::vector<double> least; ///< of no meaning beyond the first that is not positive: no cone reaches there

    /// Every combination of stops: more than the reachable ones, so the cone is safe whatever the neighbours do.
    void addFace(const glm::uvec3& corners) {
        constexpr size_t kMostCombinations = 512;
        for (int k = 0; k < 3; ++k) stopsOf(h_, corners[k], stops_[size_t(k)]);
        uint32_t cap = end_;
        while (combinationsBelow(cap) > kMostCombinations) --cap;
        if (cap < end_) least[cap] = -1;
        for (const Stop& a : stops_[0]) {
            if (a.level >= cap) break; // they rise
            for (const Stop& b : stops_[1]) {
                if (b.level >= cap) break;
                for (const Stop& c : stops_[2]) {
                    const uint32_t level = std::max({a.level, b.level, c.level});
                    if (level < cap) addTriangle(a.position, b.position, c.position, level);
                }
            }
        }
        for (uint32_t level = 0; level < end_; ++level) {
            if (least[level] <= 0) end_ = level;
        }
    }

private:
    size_t combinationsBelow(uint32_t level) const {
        size_t product = 1;
        for (const std::vector<Stop>& stops : stops_) {
            size_t count = 0;
            for (const Stop& stop : stops) count += stop.level < level;
            product *= count;
        }
        return product;
    }

    void addTriangle(uint32_t a, uint32_t b, uint32_t c, uint32_t level) {
        const glm::dvec3 n = normalOf(h_, a, b, c);
        const double length = std::sqrt(glm::dot(n, n));
        if (length > 0) least[level] = std::min(least[level], glm::dot(n, glm::dvec3(axis_)) / length);
    }

    const Hierarchy& h_;
    glm::vec3 axis_;
    uint32_t end_; ///< first level whose cosine is not positive
    std::array<std::vector<Stop>, 3> stops_;
};

/// Of the cones for levels up to 0, 1, ... the one that culls most: the share of directions from which a cone faces
/// away, (1 - sine of its half angle) / 2, times the levels that it serves.
Cone bestCone(const glm::vec3& axis, const std::vector<double>& leastCosines) {
    Cone cone;
    double cosine = 1, most = 0;
    for (uint32_t level = 0; level < leastCosines.size(); ++level) {
        cosine = std::min(cosine, leastCosines[level] - 1e-6);
        if (cosine <= 0) break;
        const double use = (level + 1) * (1 - std::sqrt(1 - cosine * cosine));
        if (use > most) {
            most = use;
            cone = {axis, std::nextafter(float(cosine), -1.0f), level};
        }
    }
    return cone;
}

} // namespace

Cone coneOfPatch(const Mesh& mesh, const Hierarchy& h, std::span<const uint32_t> faces) {
    glm::dvec3 sum(0);
    for (const uint32_t f : faces) {
        const glm::uvec3 p = mesh.facePositions(f);
        sum += normalOf(h, p.x, p.y, p.z);
    }
    const double length = std::sqrt(glm::dot(sum, sum));
    if (!(length > 0)) return {};
    const glm::vec3 axis(sum / length);
    LevelCosines cosines(h, axis);
    for (const uint32_t f : faces) cosines.addFace(mesh.faces[f]);
    return bestCone(axis, cosines.least);
}

} // namespace xgc::bake::layout
