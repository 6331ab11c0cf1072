#pragma once

#include "gpu_scene.h"

#include <xgc/selection.h>

#include <glm/mat4x4.hpp>

#include <array>

namespace xgc::vulkan {

/// The compute shaders of the path.
class GpuPipelines {
public:
    enum Stage : uint32_t { select, place, runs, scan, faces, pyramid, hide, stageCount };

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

/// A view whose levels, index lists and draws the device makes. All that it makes lies in one buffer, the lists twice
/// where there is occlusion, one for each phase:
///
///     kept    [ states of instances | slots ]
///     lists   [ firsts and counts of states | ranks | ids | places of runs | items | totals | commands | draws ]
///     depth   [ pyramid ]
///
/// and the indices in one of their own, for each phase: drivers were met that forget the offset of an index buffer.
class GpuView {
public:
    /// Offsets in buffer().
    struct Lists {
        VkDeviceSize wholeFirsts, wholeCounts, ranks, ids, places, items, totals, commands, draws;
    };

    Status create(const Context& context, const RendererConfig& config, uint32_t stateCapacity);

    /// What the path cannot do of this, by name; null where it can.
    static const char* lacks(const SelectionDesc& desc);
    void ask(const SelectionDesc& desc);
    bool canOcclude() const { return depthPixels_ > 0; }
    void useOcclusion(bool use) { occludes_ = use && canOcclude(); }
    bool occludes() const { return occludes_; }

    /// Writes what shaders read of the frame, after GpuScene::write, and reads back what an earlier one made.
    void write(const GpuScene& scene, uint64_t frame);
    /// Outside rendering; the draws may follow.
    void record(VkCommandBuffer cmd, const GpuPipelines& pipelines) const;
    /// Likewise: what the depth does not hide and is not drawn yet.
    Status recordLate(VkCommandBuffer cmd, const GpuPipelines& pipelines, const glm::mat4& worldToClip, VkImage depth,
                      VkExtent2D size);

    const GpuStats& stats() const { return stats_; }
    VkBuffer buffer() const { return made_.handle(); }
    VkDeviceAddress address() const { return made_.address(); }
    const Lists& lists(bool late = false) const { return lists_[late]; }
    const Buffer& indices(bool late = false) const { return indices_[late]; }
    VkDeviceSize slotsOffset() const { return slotsAt_; } ///< the states of instances begin the buffer
    uint32_t drawCapacity() const { return drawCapacity_; }
    /// Draws of one kind (shader::kDraw...).
    struct DrawRange {
        uint32_t first;              ///< in `draws`
        VkDeviceSize command, count; ///< offsets in buffer()
    };
    DrawRange drawRange(bool late, uint32_t kind) const;
    /// Something of this kind may be drawn.
    bool hasKind(uint32_t kind) const;

private:
    struct Dispatch {
        GpuPipelines::Stage stage;
        uint32_t step = 0;
        uint32_t groups = 1;
    };
    VkDeviceSize frameAt(bool late) const { return (2 * part_ + late) * sizeof(shader::GpuFrame); }
    void point(shader::GpuFrame& frame, bool late) const;
    void dispatch(VkCommandBuffer cmd, const GpuPipelines& pipelines, bool late, const Dispatch& what) const;
    void recordLists(VkCommandBuffer cmd, const GpuPipelines& pipelines, bool late) const;

    const Context* context_ = nullptr;
    Buffer made_;
    Buffer frames_;   ///< two GpuFrames a frame in flight
    Buffer readBack_; ///< GpuTotals likewise
    uint32_t framesInFlight_ = 1;
    uint32_t drawCapacity_ = 0;
    VkDeviceSize slotsAt_ = 0, depthAt_ = 0;
    std::array<Lists, 2> lists_{};
    std::array<Buffer, 2> indices_;
    uint32_t depthPixels_ = 0;
    bool occludes_ = false;
    shader::GpuFrame asked_{}; ///< but for the addresses of lists and of the scene
    uint32_t instanceEnd_ = 0, runCount_ = 0;
    uint32_t part_ = 0;
    bool begun_ = false, clears_ = false; ///< the first frame clears what is kept
    GpuStats stats_;
};

} // namespace xgc::vulkan
