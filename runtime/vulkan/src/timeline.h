#pragma once

#include <xgc/vulkan/context.h>

namespace xgc::vulkan {

/// A timeline semaphore that counts frames: frame n signals the value n when the device is done with it.
class Timeline {
public:
    Timeline() = default;
    Timeline(Timeline&& other) noexcept { *this = static_cast<Timeline&&>(other); }
    Timeline& operator=(Timeline&& other) noexcept;
    ~Timeline() { destroy(); }

    Status create(const Context& context);
    void destroy();

    /// Waits for one frame, never for the device to be idle; gives up after `nanoseconds`.
    Status wait(uint64_t frame, uint64_t nanoseconds) const;
    /// The latest frame that is done.
    uint64_t done() const;
    /// For vkQueueSubmit2: signals `frame` when all commands before it are done.
    VkSemaphoreSubmitInfo signal(uint64_t frame) const;

private:
    const Context* context_ = nullptr;
    VkSemaphore semaphore_ = VK_NULL_HANDLE;
};

} // namespace xgc::vulkan
