#include "peers.h"

#include <meshoptimizer.h>

namespace xgc::bench {

Surface meshoptSimplify(const Surface& surface, uint32_t faces) {
    constexpr float kNoLimit = 1e10f;
    Surface out = surface;
    const size_t indices = meshopt_simplify(&out.triangles[0].x, &surface.triangles[0].x, 3 * surface.triangles.size(),
                                            &surface.points[0].x, surface.points.size(), sizeof(glm::vec3),
                                            3 * size_t(faces), kNoLimit, 0, nullptr);
    out.triangles.resize(indices / 3);
    return out;
}

} // namespace xgc::bench
