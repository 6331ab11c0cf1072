#pragma once

#include <vulkan/vulkan_core.h>

namespace xgc::vulkan {

/// The features of Vulkan 1.3 that the backend needs, as a chain to query with or to create a device from:
///
///     Features wanted;
///     requireFeatures(wanted);              // adds xgc's to whatever the host set
///     deviceInfo.pNext = wanted.chain();
///
/// | feature                                                | because                                       |
/// | ------------------------------------------------------ | --------------------------------------------- |
/// | multiDrawIndirect, drawIndirectFirstInstance           | one indirect call draws all of a material     |
/// | shaderDrawParameters                                   | gl_DrawID finds the record of a draw          |
/// | bufferDeviceAddress                                    | vertex streams lie in arenas past the largest |
/// |                                                        | storage buffer range; no descriptors at all   |
/// | timelineSemaphore                                      | frames in flight                              |
/// | synchronization2, dynamicRendering                     | barriers, and the host's own attachments      |
///
/// And what it can use: drawIndirectCount, for the compute path (ContextDesc::drawIndirectCount).
struct Features {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, nullptr, {}};
    VkPhysicalDeviceVulkan11Features vulkan11{};
    VkPhysicalDeviceVulkan12Features vulkan12{};
    VkPhysicalDeviceVulkan13Features vulkan13{};

    Features() {
        vulkan11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
        vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
        vulkan13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    }
    /// Links the structs at their present addresses: call it right before use.
    VkPhysicalDeviceFeatures2* chain() {
        core.pNext = &vulkan11;
        vulkan11.pNext = &vulkan12;
        vulkan12.pNext = &vulkan13;
        return &core;
    }
};

/// Sets what the backend needs; leaves the rest as it is.
void requireFeatures(Features& features);

/// Name of the first needed feature that is not set, or null where all are.
const char* missingFeature(const Features& features);

} // namespace xgc::vulkan
