#pragma once

#include <xgc/vulkan/context.h>

#include <array>

namespace xgc::vulkan {

struct PipelineFormats {
    VkFormat color;
    VkFormat depth;
    VkSampleCountFlagBits samples;
    VkCompareOp depthCompare;
    VkSampleCountFlagBits depthOnlySamples;
};

/// The pipelines of the backend and their layout: push constants alone, no descriptors.
class Pipelines {
public:
    Pipelines() = default;
    Pipelines(const Pipelines&) = delete;
    Pipelines& operator=(const Pipelines&) = delete;
    ~Pipelines();

    Status create(const Context& context, const PipelineFormats& formats);

    VkPipelineLayout layout() const { return layout_; }
    /// One for assets that cannot be posed, and one for those that can.
    using Pair = std::array<VkPipeline, 2>;
    const Pair& surface() const { return surface_; }
    const Pair& surfaceMasked() const { return surfaceMasked_; } ///< with an alpha test
    const Pair& wire() const { return wire_; }                   ///< fetches indices itself: not indexed
    VkPipeline background() const { return background_; }
    // No colour; depth bias is dynamic.
    const Pair& depth() const { return depth_; } ///< no fragment stage
    const Pair& depthMasked() const { return depthMasked_; }

private:
    const Context* context_ = nullptr;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    Pair surface_{}, surfaceMasked_{}, wire_{}, depth_{}, depthMasked_{};
    VkPipeline background_ = VK_NULL_HANDLE;
};

} // namespace xgc::vulkan
