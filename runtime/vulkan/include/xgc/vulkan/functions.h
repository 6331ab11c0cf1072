#pragma once

#include <vulkan/vulkan_core.h>

/// The Vulkan functions that the backend calls, loaded for one device into a table of its own. Nothing here defines a
/// symbol named vk*, so a host may use the loader's prototypes, volk or a table of its own beside it.
#define XGC_VULKAN_INSTANCE_FUNCTIONS(X)                                                                               \
    X(vkGetDeviceProcAddr)                                                                                             \
    X(vkGetPhysicalDeviceFeatures2)                                                                                    \
    X(vkGetPhysicalDeviceFormatProperties)                                                                             \
    X(vkGetPhysicalDeviceMemoryProperties)                                                                             \
    X(vkGetPhysicalDeviceProperties2)

#define XGC_VULKAN_DEVICE_FUNCTIONS(X)                                                                                 \
    X(vkAllocateCommandBuffers)                                                                                        \
    X(vkAllocateMemory)                                                                                                \
    X(vkBeginCommandBuffer)                                                                                            \
    X(vkBindBufferMemory)                                                                                              \
    X(vkBindImageMemory)                                                                                               \
    X(vkCmdBeginRendering)                                                                                             \
    X(vkCmdBindIndexBuffer)                                                                                            \
    X(vkCmdBindPipeline)                                                                                               \
    X(vkCmdBlitImage)                                                                                                  \
    X(vkCmdCopyBuffer)                                                                                                 \
    X(vkCmdCopyImageToBuffer)                                                                                          \
    X(vkCmdDispatch)                                                                                                   \
    X(vkCmdDispatchIndirect)                                                                                           \
    X(vkCmdDraw)                                                                                                       \
    X(vkCmdDrawIndexedIndirect)                                                                                        \
    X(vkCmdDrawIndexedIndirectCount)                                                                                   \
    X(vkCmdDrawIndirect)                                                                                               \
    X(vkCmdDrawIndirectCount)                                                                                          \
    X(vkCmdEndRendering)                                                                                               \
    X(vkCmdFillBuffer)                                                                                                 \
    X(vkCmdPipelineBarrier2)                                                                                           \
    X(vkCmdPushConstants)                                                                                              \
    X(vkCmdSetDepthBias)                                                                                               \
    X(vkCmdSetScissor)                                                                                                 \
    X(vkCmdSetViewport)                                                                                                \
    X(vkCreateBuffer)                                                                                                  \
    X(vkCreateCommandPool)                                                                                             \
    X(vkCreateComputePipelines)                                                                                        \
    X(vkCreateGraphicsPipelines)                                                                                       \
    X(vkCreateImage)                                                                                                   \
    X(vkCreateImageView)                                                                                               \
    X(vkCreatePipelineLayout)                                                                                          \
    X(vkCreateSemaphore)                                                                                               \
    X(vkCreateShaderModule)                                                                                            \
    X(vkDestroyBuffer)                                                                                                 \
    X(vkDestroyCommandPool)                                                                                            \
    X(vkDestroyImage)                                                                                                  \
    X(vkDestroyImageView)                                                                                              \
    X(vkDestroyPipeline)                                                                                               \
    X(vkDestroyPipelineLayout)                                                                                         \
    X(vkDestroySemaphore)                                                                                              \
    X(vkDestroyShaderModule)                                                                                           \
    X(vkEndCommandBuffer)                                                                                              \
    X(vkFreeMemory)                                                                                                    \
    X(vkGetBufferDeviceAddress)                                                                                        \
    X(vkGetBufferMemoryRequirements)                                                                                   \
    X(vkGetDeviceQueue)                                                                                                \
    X(vkGetImageMemoryRequirements)                                                                                    \
    X(vkGetSemaphoreCounterValue)                                                                                      \
    X(vkMapMemory)                                                                                                     \
    X(vkQueueSubmit2)                                                                                                  \
    X(vkResetCommandPool)                                                                                              \
    X(vkUnmapMemory)                                                                                                   \
    X(vkWaitSemaphores)

namespace xgc::vulkan {

struct Functions {
#define XGC_VULKAN_MEMBER(name) PFN_##name name = nullptr;
    XGC_VULKAN_INSTANCE_FUNCTIONS(XGC_VULKAN_MEMBER)
    XGC_VULKAN_DEVICE_FUNCTIONS(XGC_VULKAN_MEMBER)
#undef XGC_VULKAN_MEMBER
};

/// Loads every function. False where the device lacks one: it is below Vulkan 1.3.
bool loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance, VkDevice device, Functions& out);

} // namespace xgc::vulkan
