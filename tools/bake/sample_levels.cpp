#include "bake/sample_levels.h"

#include "verify/sampled_distance.h"

#include <limits>

namespace xgc::bake {

std::vector<float> sampleLevels(const Mesh& mesh, const Hierarchy& hierarchy, uint32_t samples,
                                const std::function<bool(double)>& progress) {
    std::vector<glm::vec3> points;
    for (const uint32_t p : hierarchy.wedgePosition) points.push_back(hierarchy.positions[p]);
    const SampledDistance distance({points, mesh.faces}, samples);
    std::vector<float> rms(hierarchy.levelCount, 0.0f);
    for (uint32_t level = 1; level < hierarchy.levelCount; ++level) {
        if (!progress(double(level) / hierarchy.levelCount)) break;
        const std::vector<uint8_t> levels(hierarchy.patchCount(), uint8_t(level));
        const DrawnSurface drawn = drawSurface(mesh, hierarchy, levels);
        rms[level] = drawn.triangles.empty() ? std::numeric_limits<float>::infinity()
                                             : float(distance.compare({points, drawn.triangles}).rms());
    }
    return rms;
}

} // namespace xgc::bake
