#pragma once

#include "device.h"

#include <vector>

namespace xgc::viewer {

/// The window's images, which pictures are copied to. Presents in step with the display (FIFO).
class Swapchain {
public:
    Swapchain() = default;
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;
    ~Swapchain();

    /// For a window of a size that is not empty; again where that changed. The device is idle.
    bake::Status create(const Device& device, VkExtent2D size);

    VkExtent2D size() const { return size_; }
    VkFormat format() const { return format_; }
    VkImage image(uint32_t index) const { return images_[index]; }
    /// To be signalled by what writes the image; presenting waits for it.
    VkSemaphore written(uint32_t index) const { return written_[index]; }

    /// False: it no longer fits the window, and is to be made anew.
    bool acquire(VkSemaphore ready, uint32_t& index, bake::Status& status);
    bool present(uint32_t index, bake::Status& status);

private:
    void destroySemaphores();

    const Device* device_ = nullptr;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkExtent2D size_{};
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    std::vector<VkImage> images_;
    std::vector<VkSemaphore> written_; ///< an image each: it may be waited for until that image comes again
};

} // namespace xgc::viewer
