#pragma once

#include "gpu_scene.h"

#include <xgc/selection.h>

#include <array>

namespace xgc::vulkan {

/// The compute shaders of the path.
class GpuPipelines {
public:
    enum Stage : uint32_t { select, place, runs, scan, faces, stageCount };

    GpuPipelines() = default;
    GpuPipelines(const GpuPipelines&) = delete;
    GpuPipelines& operator=(const GpuPipelines&) = delete;
    ~GpuPipelines();

    Status create(const Context& context);
    VkPipelineLayout layout() const { return layout_; }
    VkPipeline at(Stage stage) const { return stages_[stage]; }

private:
    const Context* context_ = nullptr;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    std::array<VkPipeline, stageCount> stages_{};
};

/// A view whose levels, index lists and draws the device makes. All that it makes lies in one buffer:
///
///     kept   [ states of instances | slots ]
///     made   [ firsts and counts of states | ranks | ids | places of runs | items | totals | commands | draws |
///     indices ]
class GpuView {
public:
    Status create(const Context& context, const RendererConfig& config, uint32_t stateCapacity);

    /// What the path cannot do of this, by name; null where it can.
    static const char* lacks(const SelectionDesc& desc);
    void ask(const SelectionDesc& desc);
    /// Writes what shaders read of the frame, after GpuScene::write, and reads back what an earlier one made.
    void write(const GpuScene& scene, uint64_t frame);
    /// Outside rendering; the draws may follow.
    void record(VkCommandBuffer cmd, const GpuPipelines& pipelines) const;

    const GpuStats& stats() const { return stats_; }

    // For draws.
    VkBuffer buffer() const { return made_.handle(); }
    VkDeviceSize commandsOffset() const { return commandsAt_; }
    VkDeviceSize countOffset() const { return totalsAt_ + offsetof(shader::GpuTotals, drawCount); }
    VkDeviceSize indicesOffset() const { return indicesAt_; }
    VkDeviceAddress drawsAddress() const { return made_.address() + drawsAt_; }
    VkDeviceAddress idsAddress() const { return made_.address() + idsAt_; }
    VkDeviceAddress indicesAddress() const { return made_.address() + indicesAt_; }
    uint32_t drawCapacity() const { return drawCapacity_; }
    // For tests.
    VkDeviceSize statesOffset() const { return 0; }
    VkDeviceSize slotsOffset() const { return slotsAt_; }
    VkDeviceSize idsOffset() const { return idsAt_; }
    VkDeviceSize totalsOffset() const { return totalsAt_; }
    VkDeviceSize drawsOffset() const { return drawsAt_; }

private:
    void dispatch(VkCommandBuffer cmd, const GpuPipelines& pipelines, GpuPipelines::Stage stage, uint32_t step,
                  uint32_t groups) const;

    const Context* context_ = nullptr;
    Buffer made_;
    Buffer frames_;   ///< a GpuFrame a frame in flight
    Buffer readBack_; ///< GpuTotals likewise
    uint32_t framesInFlight_ = 1;
    uint32_t drawCapacity_ = 0;
    VkDeviceSize slotsAt_ = 0, wholeFirstsAt_ = 0, wholeCountsAt_ = 0, ranksAt_ = 0, idsAt_ = 0, placesAt_ = 0,
                 itemsAt_ = 0, totalsAt_ = 0, commandsAt_ = 0, drawsAt_ = 0, indicesAt_ = 0;
    shader::GpuFrame asked_{}; ///< but for the addresses
    uint32_t instanceEnd_ = 0, runCount_ = 0;
    uint32_t part_ = 0;
    bool begun_ = false, clears_ = false; ///< the first frame clears what is kept
    GpuStats stats_;
};

} // namespace xgc::vulkan
