#include "drawn_asset.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace xgc::viewer {

float worstErrorPixels(std::span<const DrawnAsset> assets, const View& view) {
    float worst = 0;
    for (const DrawnAsset& drawn : assets) {
        const float scale = makePlacement(glm::mat4(drawn.toWorld)).maxScale;
        for (uint32_t patch = 0; patch < drawn.asset->patchCount(); ++patch) {
            if (!drawn.visible[patch]) continue;
            const format::PatchRecord& record = drawn.asset->patches[patch];
            const float* c = record.sphereCenter;
            const glm::vec3 center = drawn.toWorld * glm::vec4(c[0], c[1], c[2], 1);
            const float distance = glm::distance(center, view.eye) - scale * record.sphereRadius;
            const float error = scale * drawn.asset->error(patch, drawn.levels[patch]);
            worst = std::max(worst, error * view.pixelsPerUnit / std::max({distance, view.nearest, 1e-20f}));
        }
    }
    return worst;
}

} // namespace xgc::viewer
