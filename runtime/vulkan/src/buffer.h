#pragma once

#include <xgc/vulkan/context.h>

#include <cstddef>
#include <span>

namespace xgc::vulkan {

enum class Residence {
    device,   ///< device-local: the host never sees it
    upload,   ///< the host writes it, in device memory where there is such
    download, ///< the host reads it, cached where there is such
};

/// A buffer with memory of its own, and its address where the usage has one.
class Buffer {
public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept { *this = static_cast<Buffer&&>(other); }
    Buffer& operator=(Buffer&& other) noexcept;
    ~Buffer() { destroy(); }

    /// Replaces what was there. `context` outlives the buffer.
    Status create(const Context& context, VkDeviceSize bytes, VkBufferUsageFlags usage, Residence residence);
    void destroy();

    VkBuffer handle() const { return buffer_; }
    VkDeviceSize bytes() const { return bytes_; }
    VkDeviceAddress address() const { return address_; }
    /// Empty where the host does not see it.
    std::span<std::byte> mapped() const {
        return {static_cast<std::byte*>(memory_.mapped), memory_.mapped ? size_t(bytes_) : 0};
    }

private:
    const Context* context_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Memory memory_;
    VkDeviceSize bytes_ = 0;
    VkDeviceAddress address_ = 0;
};

} // namespace xgc::vulkan
