#include "near_walk.h"

#include "bake/surface_distance.h"

namespace xgc::bake {
namespace {

/// Vertices whose stars were looked at last.
struct Visited {
    uint32_t vertices[8] = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
    uint32_t count = 0;
    bool has(uint32_t v) const {
        bool found = false;
        for (const uint32_t u : vertices) found |= u == v;
        return found;
    }
    void add(uint32_t v) { vertices[count++ % 8] = v; }
};

} // namespace

double squaredTo(const DrawnLevel& d, uint32_t triangle, const glm::dvec3& p) {
    const glm::uvec3& t = d.triangles[triangle];
    return squaredDistance(p, d.points[t.x], d.points[t.y], d.points[t.z]);
}

NearTriangle walkNear(const DrawnLevel& d, const glm::dvec3& p, NearTriangle best, glm::uvec3 seeds,
                      const Allowance& allowance) {
    Visited visited;
    const auto look = [&](uint32_t vertex) {
        for (const uint32_t t : d.star(vertex)) {
            const glm::uvec3& corners = d.triangles[t];
            if (visited.has(corners.x) || visited.has(corners.y) || visited.has(corners.z)) continue;
            const double squared = squaredTo(d, t, p);
            if (squared < best.squared) best = {t, squared};
            if (allowance.covers(d.patches[t], squared)) {
                best = {t, squared};
                return true;
            }
        }
        visited.add(vertex);
        return false;
    };
    for (int k = 0; k < 3; ++k) {
        if (seeds[k] != kNone && !visited.has(seeds[k]) && look(seeds[k])) return best;
    }
    uint32_t from = kNone;
    while (best.triangle != from && best.triangle != kNone) {
        from = best.triangle;
        const glm::uvec3 corners = d.triangles[from];
        for (int k = 0; k < 3; ++k) {
            if (!visited.has(corners[k]) && look(corners[k])) return best;
        }
    }
    return best;
}

} // namespace xgc::bake
