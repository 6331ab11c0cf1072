#pragma once

#include <xgc/vulkan/context.h>

namespace xgc::vulkan {

struct PipelineFormats {
    VkFormat color;
    VkFormat depth;
    VkSampleCountFlagBits samples;
    VkCompareOp depthCompare;
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
    VkPipeline surface() const { return surface_; }
    VkPipeline wire() const { return wire_; } ///< fetches indices itself: not indexed
    VkPipeline background() const { return background_; }

private:
    const Context* context_ = nullptr;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline surface_ = VK_NULL_HANDLE;
    VkPipeline wire_ = VK_NULL_HANDLE;
    VkPipeline background_ = VK_NULL_HANDLE;
};

} // namespace xgc::vulkan
