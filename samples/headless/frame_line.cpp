#include "frame_line.h"

#include <fmt/format.h>

#include <algorithm>

namespace xgc::headless {
namespace {

/// Patches at each level; none where the instance is not drawn.
std::string levelCounts(const vulkan::Renderer& renderer, uint32_t instance) {
    const Scene& scene = renderer.scene();
    const DrawList& list = renderer.drawList();
    if (list.kind(instance) == InstanceKind::culled) return "[]";
    const uint32_t assetId = scene.assetOf(instance);
    const AssetView& asset = *scene.asset(assetId).asset;
    std::vector<uint8_t> levels(asset.patchCount());
    if (list.kind(instance) == InstanceKind::whole) {
        scene.wholeLevels(assetId, list.wholeState(instance), levels);
    } else {
        std::copy(list.levels(instance).begin(), list.levels(instance).end(), levels.begin());
    }
    std::vector<uint32_t> patches(asset.levelCount(), 0);
    for (const uint8_t level : levels) ++patches[level];
    return fmt::format("[{}]", fmt::join(patches, ","));
}

} // namespace

std::string frameLine(uint32_t frame, const vulkan::Renderer& renderer, const std::vector<SceneInstance>& instances) {
    const vulkan::FrameStats& stats = renderer.stats();
    const SelectionStats& chosen = renderer.selection().stats();
    std::string line =
        fmt::format(R"({{"frame":{},"triangles":{},"draws":{},"pixels":{:.4g},"wholeInstances":{},"culledPatches":{},)"
                    R"("patchesChanged":{},"patchesRebuilt":{},"uploadBytes":{},"deferred":{},"levels":[)",
                    frame, stats.triangles, stats.draws, chosen.pixels, chosen.wholeInstances, chosen.culledPatches,
                    stats.patchesChanged, stats.patchesRebuilt, stats.uploadBytes, stats.deferredInstances);
    for (size_t i = 0; i < instances.size(); ++i) {
        if (i > 0) line += ',';
        line += levelCounts(renderer, instances[i].handle.index);
    }
    return line + "]}";
}

} // namespace xgc::headless
