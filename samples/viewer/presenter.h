#pragma once

#include "canvas.h"
#include "interface.h"
#include "swapchain.h"
#include "window.h"

#include <array>
#include <span>

namespace xgc::viewer {

/// From a command buffer to the window: the device, the canvas, the interface's pass, and frames in flight. A frame:
///
///     begin(size, cmd)        // waits for the frame two before; false: there is nothing to draw to now
///     ... copies, canvas().beginScene(cmd), draws, canvas().endScene(cmd) ...
///     end(signals, capture)   // interface, copies, submission, presentation
class Presenter {
public:
    static constexpr uint32_t kFramesInFlight = 2;

    Presenter() = default;
    Presenter(const Presenter&) = delete;
    Presenter& operator=(const Presenter&) = delete;
    ~Presenter();

    bake::Status create(Window& window);

    Device& device() { return device_; }
    Canvas& canvas() { return canvas_; }
    Interface& interface() { return interface_; }

    /// Makes what depends on the window's size anew where it changed. False while the window is minimised.
    bool fit(bake::Status& status);
    bake::Status begin(VkCommandBuffer& cmd);
    /// `capture`: the picture can be read once this returns.
    bake::Status end(std::span<const VkSemaphoreSubmitInfo> signals, bool capture);

private:
    struct Slot {
        VkCommandPool pool = VK_NULL_HANDLE;
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        VkSemaphore acquired = VK_NULL_HANDLE;
        VkFence done = VK_NULL_HANDLE;
    };
    bake::Status createSlot(Slot& slot);
    bake::Status submit(const Slot& slot, bool acquired, uint32_t image,
                        std::span<const VkSemaphoreSubmitInfo> signals);

    Window* window_ = nullptr;
    Device device_;
    Swapchain swapchain_;
    Canvas canvas_;
    Interface interface_;
    std::array<Slot, kFramesInFlight> slots_;
    uint32_t frame_ = 0;
    VkExtent2D windowSize_{};
    bool outdated_ = true;
};

} // namespace xgc::viewer
