#include "sampled_distance.h"

#include <cmath>

namespace xgc::bench {
namespace {

bake::SurfaceView viewOf(const Surface& s) {
    return {s.points, s.triangles};
}

double diagonalOf(const Surface& s) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::uvec3& t : s.triangles) {
        for (int k = 0; k < 3; ++k) {
            low = glm::min(low, s.points[t[k]]);
            high = glm::max(high, s.points[t[k]]);
        }
    }
    return glm::distance(glm::dvec3(low), glm::dvec3(high));
}

} // namespace

std::vector<SamplePoint> samplePoints(const Surface& surface, uint32_t count) {
    return bake::samplePoints(viewOf(surface), count);
}

DistanceReference::DistanceReference(Surface surface, uint32_t samples)
    : surface_(std::move(surface)), diagonal_(diagonalOf(surface_)), distance_(viewOf(surface_), samples) {}

TwoSided DistanceReference::compare(const Surface& other) const {
    return distance_.compare(viewOf(other));
}

} // namespace xgc::bench
