#pragma once

#include <xgc/status.h>
#include <xgc/vulkan/functions.h>

namespace xgc::vulkan {

/// Device memory of one resource, as a MemoryHooks gives it.
struct Memory {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    void* mapped = nullptr; ///< of `offset`; null where the memory is not host-visible
    void* token = nullptr;  ///< the hook's own
};

struct MemoryRequest {
    VkMemoryRequirements requirements{};
    VkMemoryPropertyFlags required = 0; ///< HOST_VISIBLE is asked for with HOST_COHERENT, and wants `mapped`
    VkMemoryPropertyFlags preferred = 0;
    bool deviceAddress = false; ///< allocate with VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT
};

/// A host renderer's own memory allocator. Both or neither function; called from the thread that calls xgc, never
/// in a frame, once a resource (about ten in all).
struct MemoryHooks {
    VkResult (*allocate)(void* user, const MemoryRequest& request, Memory& out) = nullptr;
    void (*release)(void* user, const Memory& memory) = nullptr;
    void* user = nullptr;
};

/// The host's Vulkan objects. They stay the host's, and outlive the Context.
struct ContextDesc {
    PFN_vkGetInstanceProcAddr getInstanceProcAddr = nullptr;
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physicalDevice = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE; ///< Vulkan 1.3, made with the features of features.h
    uint32_t queueFamily = 0;         ///< graphics; where the host submits the command buffers that xgc records into
    bool drawIndirectCount = false;   ///< the device was made with this feature: the compute path needs it
    const VkAllocationCallbacks* allocation = nullptr; ///< host memory; null: the driver's own
    MemoryHooks memory;                                ///< device memory; empty: one vkAllocateMemory a resource
};

/// A device as the backend uses it: function table, limits, allocators. Immutable after `create`.
class Context {
public:
    /// Loads the functions and checks limits. The features that the device was made with cannot be asked for, so
    /// that they are enabled is the host's promise; that the hardware has them is checked.
    Status create(const ContextDesc& desc);

    const Functions& vk() const { return functions_; }
    VkDevice device() const { return desc_.device; }
    uint32_t queueFamily() const { return desc_.queueFamily; }
    const VkAllocationCallbacks* allocation() const { return desc_.allocation; }
    VkDeviceSize maxBufferBytes() const { return maxBufferBytes_; }
    uint32_t maxDrawIndirectCount() const { return maxDrawIndirectCount_; }
    bool hasDrawIndirectCount() const { return desc_.drawIndirectCount; }

    VkResult allocate(const MemoryRequest& request, Memory& out) const;
    void release(const Memory& memory) const;

private:
    VkResult allocateOwn(const MemoryRequest& request, Memory& out) const;

    ContextDesc desc_;
    Functions functions_;
    VkPhysicalDeviceMemoryProperties memoryTypes_{};
    VkDeviceSize maxBufferBytes_ = 0;
    uint32_t maxDrawIndirectCount_ = 0;
};

/// A status for a call that the device refused.
inline Status refused(const char* message, VkResult result) {
    return {StatusCode::deviceRefused, message, uint64_t(int64_t(result))};
}

} // namespace xgc::vulkan
