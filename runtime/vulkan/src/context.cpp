#include <xgc/vulkan/context.h>
#include <xgc/vulkan/features.h>

#include <bit>

namespace xgc::vulkan {
namespace {

/// First memory type of the set that has all `required` flags and the most of `preferred`; 32 where none has.
uint32_t findMemoryType(const VkPhysicalDeviceMemoryProperties& types, const MemoryRequest& request) {
    uint32_t best = 32;
    int bestScore = -1;
    for (uint32_t i = 0; i < types.memoryTypeCount; ++i) {
        const VkMemoryPropertyFlags flags = types.memoryTypes[i].propertyFlags;
        if (!(request.requirements.memoryTypeBits >> i & 1u) || (flags & request.required) != request.required)
            continue;
        const int score = std::popcount(flags & request.preferred);
        if (score > bestScore) {
            best = i;
            bestScore = score;
        }
    }
    return best;
}

} // namespace

Status Context::create(const ContextDesc& desc) {
    if (!desc.getInstanceProcAddr || !desc.instance || !desc.physicalDevice || !desc.device) {
        return {StatusCode::badArgument, "ContextDesc: a handle or getInstanceProcAddr is null", 0};
    }
    if (!desc.memory.allocate != !desc.memory.release) {
        return {StatusCode::badArgument, "ContextDesc::memory: set both allocate and release, or neither", 0};
    }
    Functions functions;
    if (!loadFunctions(desc.getInstanceProcAddr, desc.instance, desc.device, functions)) {
        return refused("the device lacks a function of Vulkan 1.3: update its driver", VK_ERROR_INCOMPATIBLE_DRIVER);
    }
    Features features;
    functions.vkGetPhysicalDeviceFeatures2(desc.physicalDevice, features.chain());
    if (missingFeature(features)) {
        return refused("the device lacks a feature that features.h lists", VK_ERROR_FEATURE_NOT_PRESENT);
    }
    VkPhysicalDeviceVulkan13Properties vulkan13{};
    vulkan13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES;
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &vulkan13, {}};
    functions.vkGetPhysicalDeviceProperties2(desc.physicalDevice, &properties);
    desc_ = desc;
    functions_ = functions;
    functions_.vkGetPhysicalDeviceMemoryProperties(desc.physicalDevice, &memoryTypes_);
    maxBufferBytes_ = vulkan13.maxBufferSize;
    maxDrawIndirectCount_ = properties.properties.limits.maxDrawIndirectCount;
    return {};
}

VkResult Context::allocate(const MemoryRequest& request, Memory& out) const {
    if (desc_.memory.allocate) return desc_.memory.allocate(desc_.memory.user, request, out);
    return allocateOwn(request, out);
}

VkResult Context::allocateOwn(const MemoryRequest& request, Memory& out) const {
    const uint32_t type = findMemoryType(memoryTypes_, request);
    if (type == 32) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkMemoryAllocateFlagsInfo flags{};
    flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
    flags.flags = request.deviceAddress ? VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT : 0;
    VkMemoryAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.pNext = &flags;
    info.allocationSize = request.requirements.size;
    info.memoryTypeIndex = type;
    Memory memory;
    VkResult result = functions_.vkAllocateMemory(desc_.device, &info, desc_.allocation, &memory.memory);
    if (result != VK_SUCCESS) return result;
    if (request.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) {
        result = functions_.vkMapMemory(desc_.device, memory.memory, 0, VK_WHOLE_SIZE, 0, &memory.mapped);
        if (result != VK_SUCCESS) {
            functions_.vkFreeMemory(desc_.device, memory.memory, desc_.allocation);
            return result;
        }
    }
    out = memory;
    return VK_SUCCESS;
}

void Context::release(const Memory& memory) const {
    if (!memory.memory) return;
    if (desc_.memory.release) return desc_.memory.release(desc_.memory.user, memory);
    // Freeing unmaps.
    functions_.vkFreeMemory(desc_.device, memory.memory, desc_.allocation);
}

} // namespace xgc::vulkan
