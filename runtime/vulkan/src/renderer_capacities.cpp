#include "renderer_impl.h"

#include <algorithm>

namespace xgc::vulkan {

RendererConfig configFor(std::span<const AssetView* const> assets, uint32_t instances, const RendererConfig& base) {
    RendererConfig config = base;
    uint64_t patches = 0, materials = 0, faces = 0, streamBytes = 0, largestFaces = 0, groups = 0, joints = 0,
             targets = 0;
    for (const AssetView* asset : assets) {
        patches += asset->patchCount();
        materials += asset->materials.size();
        faces += asset->record->faceCount;
        largestFaces = std::max<uint64_t>(largestFaces, asset->record->faceCount);
        config.faceCapacity = std::max(config.faceCapacity, asset->record->maxPatchFaces);
        groups += groupCount(*asset);
        streamBytes += AssetStore::bytesOf(*asset, config.morphGroupCapacity > 0);
        joints += asset->joints.size();
        targets += asset->morphTargets.size();
        config.slotCapacity = std::max(config.slotCapacity, scratchCapacity(*asset));
        config.domainCapacity = std::max(config.domainCapacity, asset->record->domainCount);
    }
    const auto grow = [](uint32_t& field, uint64_t least) {
        field = uint32_t(std::min<uint64_t>(std::max<uint64_t>(field, least), UINT32_MAX));
    };
    grow(config.assetCapacity, assets.size());
    grow(config.instanceCapacity, uint64_t(instances) * assets.size());
    grow(config.assetPatchCapacity, patches);
    grow(config.patchCapacity, patches * instances);
    grow(config.materialCapacity, materials);
    grow(config.jointCapacity, joints * instances);
    grow(config.morphWeightCapacity, targets * instances);
    if (config.morphGroupCapacity > 0) grow(config.morphGroupCapacity, groups * instances);
    // Twice what is held: of mixed instances all, and what frames in flight still read of a whole change.
    grow(config.indexBytes, 2 * 3 * sizeof(uint32_t) * faces * instances * (1 + config.framesInFlight));
    config.vertexArenaBytes = std::max<VkDeviceSize>(config.vertexArenaBytes, streamBytes);
    // Half of it takes the whole of the largest asset at level 0 at once.
    config.stagingBytes = std::max<VkDeviceSize>(config.stagingBytes, 2 * 3 * sizeof(uint32_t) * largestFaces + 4096);
    return config;
}

} // namespace xgc::vulkan
