#pragma once

#include <xgc/vulkan/functions.h>

namespace xgc::vulkan {

/// One side of a dependency.
struct Access {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
};

inline void memoryBarrier(const Functions& vk, VkCommandBuffer cmd, const Access& before, const Access& after) {
    VkMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    barrier.srcStageMask = before.stages;
    barrier.srcAccessMask = before.access;
    barrier.dstStageMask = after.stages;
    barrier.dstAccessMask = after.access;
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &barrier;
    vk.vkCmdPipelineBarrier2(cmd, &info);
}

/// A layout change of a whole image.
struct Transition {
    VkImage image;
    VkImageAspectFlags aspect;
    VkImageLayout from;
    VkImageLayout to;
};

inline void imageBarrier(const Functions& vk, VkCommandBuffer cmd, const Transition& transition, const Access& before,
                         const Access& after) {
    VkImageMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barrier.srcStageMask = before.stages;
    barrier.srcAccessMask = before.access;
    barrier.dstStageMask = after.stages;
    barrier.dstAccessMask = after.access;
    barrier.oldLayout = transition.from;
    barrier.newLayout = transition.to;
    barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = transition.image;
    barrier.subresourceRange = {transition.aspect, 0, 1, 0, 1};
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    vk.vkCmdPipelineBarrier2(cmd, &info);
}

} // namespace xgc::vulkan
