#pragma once

#include "memory.h"
#include "patch_lanes.h"
#include "range_allocator.h"

#include <xgc/scene.h>

namespace xgc {

/// Of one asset: thirty octaves in quarters, zero, and the largest error itself.
inline constexpr uint32_t kMaxWholeStates = 124;

struct SceneAsset {
    AssetDesc desc{}; ///< no asset: the id is free
    uint32_t patchRange = format::kNone;
    uint32_t firstPatch = 0; ///< in Scene::Impl::patches
    uint32_t instanceCount = 0;
    uint32_t wholeStateCount = 0;
    uint32_t firstWhole = 0; ///< the finest state in which instances may be whole
    uint32_t nextFree = format::kNone;
};

struct SceneInstance {
    uint32_t generation = 0; ///< odd while it is there
    uint32_t asset = 0;
    Placement placement{};
    bool visible = true;
    uint32_t slotRange = format::kNone;
    uint32_t firstSlot = 0; ///< of its patches, in the arrays of views
    uint32_t controlRange = format::kNone;
    uint32_t firstControl = 0; ///< in Scene::Impl::controls, where it has a range
    bool posed = false;        ///< Scene::Impl::posed has its patches, by slot
    glm::vec4 posedSphere{0};
    uint32_t weightRange = format::kNone;
    uint32_t firstWeight = 0; ///< in Scene::Impl::morphWeights, where it has a range
    uint32_t weightCount = 0; ///< of its pose
    uint32_t nextFree = format::kNone;

    bool steered() const { return controlRange != format::kNone; }
};

struct Scene::Impl : Allocated<Scene::Impl> {
    SceneConfig config;

    FixedArray<SceneAsset> assets;
    uint32_t freeAsset = format::kNone;
    RangeAllocator patchRanges;
    FixedArray<PatchBounds> patches;
    PatchLaneArrays lanes; ///< of them
    // asset * kMaxWholeStates + state:
    FixedArray<float> wholeErrors;
    FixedArray<uint32_t> wholeTriangles;
    FixedArray<uint8_t> levelScratch; ///< of one asset

    FixedArray<SceneInstance> instances;
    uint32_t instanceEnd = 0;
    uint32_t freeInstance = format::kNone;
    RangeAllocator slotRanges;

    RangeAllocator controlRanges;
    FixedArray<PartControl> controls;

    FixedArray<PosedPatch> posed; ///< by slot
    RangeAllocator weightRanges;
    FixedArray<float> morphWeights;

    bool allocate();
    void fillTables(uint32_t asset);
    void fillWholeErrors(uint32_t asset);
    std::span<const float> errorsOf(uint32_t asset) const {
        return {wholeErrors.data() + size_t(asset) * kMaxWholeStates, assets[asset].wholeStateCount};
    }
    uint32_t trianglesOf(uint32_t asset, uint32_t state) const {
        return wholeTriangles[size_t(asset) * kMaxWholeStates + state];
    }
    void wholeLevels(uint32_t asset, uint32_t state, std::span<uint8_t> levels) const;
    const SceneAsset& assetAt(uint32_t id) const;
    const SceneInstance& at(uint32_t id) const;
    SceneInstance& at(uint32_t id) { return const_cast<SceneInstance&>(static_cast<const Impl*>(this)->at(id)); }
};

} // namespace xgc
