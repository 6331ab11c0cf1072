#pragma once

#include "device.h"

#include <xgc/bake/image.h>

namespace xgc::viewer {

/// The picture of a frame: the scene is drawn to it in linear light (4 samples, resolved), the panel over it in bytes,
/// and it is copied to the window and to screenshots.
class Canvas {
public:
    static constexpr VkFormat kSceneFormat = VK_FORMAT_R8G8B8A8_SRGB;
    static constexpr VkFormat kPanelFormat = VK_FORMAT_R8G8B8A8_UNORM; ///< the same bytes
    static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
    static constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;

    Canvas() = default;
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;
    ~Canvas();

    /// Again where the size changed. The device is idle.
    bake::Status create(const Device& device, VkExtent2D size, VkFormat windowFormat);

    VkExtent2D size() const { return size_; }
    VkImageView panelView() const { return panelView_; }

    void beginScene(VkCommandBuffer cmd) const;
    void endScene(VkCommandBuffer cmd) const;
    /// Copies to an image of the swapchain that is not yet defined, and leaves it ready to present. The panel's pass
    /// has left the canvas in TRANSFER_SRC_OPTIMAL.
    void copyTo(VkCommandBuffer cmd, VkImage image) const;
    /// Copies to a buffer that the host reads with `picture` once the frame is done.
    void copyToHost(VkCommandBuffer cmd) const;
    bake::Image picture() const;

private:
    bake::Status createImages(bool srgb);
    bake::Status createReadback();
    void destroy();

    const Device* device_ = nullptr;
    VkExtent2D size_{};
    Device::Image color_, samples_, depth_;
    VkImageView sceneView_ = VK_NULL_HANDLE, panelView_ = VK_NULL_HANDLE; ///< of one image
    VkBuffer readback_ = VK_NULL_HANDLE;
    vulkan::Memory readbackMemory_;
};

} // namespace xgc::viewer
