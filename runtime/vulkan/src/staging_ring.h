#pragma once

#include "buffer.h"

namespace xgc::vulkan {

/// Mapped memory that the host fills and the device copies from: one part a frame in flight, used in turn. The caller
/// begins a frame's part when the frame that last used it is done.
class StagingRing {
public:
    Status create(const Context& context, VkDeviceSize bytesPerFrame, uint32_t framesInFlight) {
        bytesPerFrame_ = (bytesPerFrame + 15) / 16 * 16;
        frames_ = framesInFlight;
        return buffer_.create(context, bytesPerFrame_ * frames_, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Residence::upload);
    }

    void begin(uint64_t frame) {
        begin_ = frame % frames_ * bytesPerFrame_;
        used_ = 0;
    }
    /// Takes the next `bytes` of the part, 16-byte aligned; at most `freeBytes()`.
    std::span<std::byte> take(VkDeviceSize bytes, VkDeviceSize& offset) {
        offset = begin_ + used_;
        used_ += (bytes + 15) / 16 * 16;
        return buffer_.mapped().subspan(size_t(offset), size_t(bytes));
    }
    VkDeviceSize freeBytes() const { return bytesPerFrame_ - used_; }
    VkDeviceSize bytesPerFrame() const { return bytesPerFrame_; }
    VkBuffer handle() const { return buffer_.handle(); }

private:
    Buffer buffer_;
    VkDeviceSize bytesPerFrame_ = 0;
    uint32_t frames_ = 1;
    VkDeviceSize begin_ = 0;
    VkDeviceSize used_ = 0;
};

} // namespace xgc::vulkan
