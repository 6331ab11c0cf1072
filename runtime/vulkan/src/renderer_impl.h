#pragma once

#include "asset_store.h"
#include "frame_records.h"
#include "gpu_view.h"
#include "pipelines.h"
#include "staging_ring.h"
#include "streamed_rows.h"
#include "timeline.h"

#include <xgc/vulkan/renderer.h>

#include <vector>

// What is behind a Renderer. Its members stand in a file each of what they do: renderer.cpp (set-up, assets,
// instances), renderer_frame.cpp, renderer_recording.cpp, renderer_compute.cpp (the compute path),
// renderer_capacities.cpp.
//
// Memory of the backend, all taken by `create`:
//
//   device-local   [ vertex arena: streams of assets, by address ]   [ index arena: ranges of the draw list ]
//                        ^ copies   [ rows of the residency's pool ]     ^ copies
//                        |               ^ copies                        |
//   mapped         [ staging: pages | streams | indices ] x frames in flight
//   mapped         [ views | instances | draws | commands | lambdas ] x frames in flight     [ materials ]
//
// Frame n writes part n % framesInFlight of the mapped buffers after it waited for frame n - framesInFlight.

namespace xgc::vulkan {

/// An instance as the renderer keeps it.
struct StoredInstance {
    uint32_t generation = 0; ///< odd while it is there
    uint32_t asset = 0;
    bool visible = true; ///< the host's wish; it is while its asset is resident
    // Of its pose, in the renderer's lists.
    RangeList::Range joints{}, weights{};
    bool skinned = false, displaced = false;
};

/// A view with levels of its own.
struct StoredView {
    Selection selection;
    DrawList draws;
    bool used = false;                               ///< was asked for levels
    const char* hostReason = "GpuPathConfig::views"; ///< null: `gpu` chooses
    GpuView gpu;

    bool onDevice() const { return used && !hostReason; }
};

struct Renderer::Impl {
    const Context* context = nullptr;
    RendererConfig config;
    Pipelines pipelines;
    AssetStore assets;
    StreamedRows streamedRows;
    Buffer indexArena;
    StagingRing staging;
    FrameRecords records;
    Timeline timeline;
    Scene scene;
    IndexCache indexCache;
    std::vector<StoredView> views;
    GpuPipelines gpuPipelines;
    GpuScene gpuScene;
    const char* gpuLacks = nullptr;    ///< what the device has not, for the compute path
    uint32_t assetsOffGpu = 0;         ///< that the path cannot draw
    std::vector<uint32_t> storedAsset; ///< by id of the scene's asset: its index in the store

    std::vector<StoredInstance> instances;               ///< by id in the scene
    std::vector<shader::InstanceRecord> instanceRecords; ///< likewise
    uint32_t instanceEnd = 0;                            ///< ids from here on were never used
    RangeList jointRanges, weightRanges;
    std::vector<JointRows> joints; ///< of all poses
    std::vector<float> weights;    ///< of targets, likewise

    uint64_t frame = 0;
    VkDeviceSize indexStagingOffset = 0;
    uint32_t passCount = 0;
    std::vector<VkBufferCopy> indexCopies; ///< reserved for all that a frame may have
    FrameStats stats;

    Status allocate();
    Status allocateGpu();
    bool hasGpu() const { return config.gpu.views > 0 && !gpuLacks; }
    bool isOnGpu(uint32_t instance) const { return assets.at(instances[instance].asset).onGpu; }
    Status addGpuAsset(StoredAsset& asset);
    const char* hostReason(uint32_t view, const SelectionDesc& desc) const;
    void writeGpu();
    StoredInstance* find(InstanceHandle handle);
    Status enterAsset(AssetHandle handle);
    bool resident(uint32_t asset) const;
    void showResident();
    void writePoses();
    void releasePose(StoredInstance& instance);
    void writeDraws(uint32_t view);
    void writeLambdas(uint32_t view);
    Status beginPass(uint32_t view, const shader::ViewRecord& record, shader::PushConstants& push);
    enum class Which : uint32_t { all, opaque, masked };
    void recordBatches(VkCommandBuffer cmd, uint32_t view, shader::PushConstants push, const Pipelines::Pair& pair,
                       Which which) const;
    struct GpuDraws {
        uint32_t view;
        bool late;
        const Pipelines::Pair &opaque, &masked;
        bool indexed;
    };
    void recordGpuDraws(VkCommandBuffer cmd, const GpuDraws& what, shader::PushConstants push) const;
    Status recordDraws(VkCommandBuffer cmd, const ViewDesc& desc, bool late);
};

} // namespace xgc::vulkan
