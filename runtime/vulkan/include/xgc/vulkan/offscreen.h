#pragma once

#include <xgc/vulkan/context.h>

#include <cstddef>
#include <memory>
#include <span>

namespace xgc::vulkan {

struct OffscreenDesc {
    VkExtent2D size{1280, 720};
    VkFormat colorFormat = VK_FORMAT_R8G8B8A8_SRGB; ///< four bytes a pixel
    VkFormat depthFormat = VK_FORMAT_D32_SFLOAT;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_4_BIT; ///< more than one: resolved
    /// 1, or 2 to draw at twice the size and halve the picture at the end: for stills. What is in pixels of the target
    /// (ViewDesc::linePixels) doubles too.
    uint32_t supersampling = 1;
    uint32_t framesInFlight = 2;
    /// Rendering can be paused to look at the depth (pauseRendering); one sample a pixel then.
    bool pauses = false;
};

/// A target to draw pictures to where there is no window: attachments, a command buffer a frame in flight, and a
/// read-back. A frame:
///
///     begin(cmd);                  // waits for the frame that used the slot before
///     ... copies, compute ...
///     beginRendering(cmd, clear);
///     ... draws ...
///     endRendering(cmd);
///     submit(signals, frame);
///     read(frame, pixels);         // at once, or up to framesInFlight - 1 frames later
class Offscreen {
public:
    Offscreen();
    ~Offscreen(); ///< waits for its frames
    Offscreen(Offscreen&&) noexcept;
    Offscreen& operator=(Offscreen&&) noexcept;

    /// `context` and the queue outlive it.
    Status create(const Context& context, VkQueue queue, const OffscreenDesc& desc);

    Status begin(VkCommandBuffer& cmd);
    /// Clears colour to `clear` (linear RGBA) and depth to 0: depth is reversed, 0 is infinitely far. Sets viewport and
    /// scissor.
    void beginRendering(VkCommandBuffer cmd, std::span<const float, 4> clear);
    void endRendering(VkCommandBuffer cmd);
    /// Between the two: ends rendering, and goes on with what was drawn. In between the depth lies in `depth`, in
    /// VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL.
    VkImage pauseRendering(VkCommandBuffer cmd);
    void resumeRendering(VkCommandBuffer cmd);
    /// Submits and signals `signals` too, such as Renderer::frameDone. `frame` names the frame for `read`.
    Status submit(std::span<const VkSemaphoreSubmitInfo> signals, uint64_t& frame);
    /// Waits for one frame and copies its pixels out: size.width * size.height * 4 bytes, rows from the top.
    Status read(uint64_t frame, std::span<std::byte> pixels);

    const OffscreenDesc& desc() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc::vulkan
