#include "frame_line.h"

#include <fmt/format.h>

namespace xgc::headless {
namespace {

std::string levelCounts(const AssetView& asset, Levels levels) {
    if (levels.empty()) return "[]";
    std::vector<uint32_t> patches(asset.levelCount(), 0);
    for (const uint8_t level : levels) ++patches[level];
    return fmt::format("[{}]", fmt::join(patches, ","));
}

} // namespace

std::string frameLine(uint32_t frame, const vulkan::Renderer& renderer, const std::vector<SceneInstance>& instances) {
    const FrameStats& stats = renderer.stats();
    std::string line = fmt::format(
        R"({{"frame":{},"triangles":{},"patchesChanged":{},"patchesRebuilt":{},"uploadBytes":{},"deferred":{},"levels":[)",
        frame, stats.triangles, stats.patchesChanged, stats.patchesRebuilt, stats.uploadBytes, stats.deferredInstances);
    for (size_t i = 0; i < instances.size(); ++i) {
        if (i > 0) line += ',';
        line += levelCounts(*instances[i].asset, renderer.levels(instances[i].handle));
    }
    return line + "]}";
}

} // namespace xgc::headless
