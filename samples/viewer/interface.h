#pragma once

#include "canvas.h"
#include "events.h"

namespace xgc::viewer {

/// ImGui: its input, its look, and its pass over the canvas.
class Interface {
public:
    Interface() = default;
    Interface(const Interface&) = delete;
    Interface& operator=(const Interface&) = delete;
    ~Interface(); ///< the device is idle

    bake::Status create(const Device& device, GLFWwindow* window, uint32_t framesInFlight, float scale);
    /// Again where the canvas was made anew. The device is idle.
    bake::Status attach(const Canvas& canvas);

    void feed(const Event& event);
    bool wantsMouse() const;
    bool wantsKeys() const;

    /// Between these, panels are built.
    void begin(VkExtent2D size, float seconds);
    void end();
    /// Draws them, and leaves the canvas in TRANSFER_SRC_OPTIMAL.
    void record(VkCommandBuffer cmd, const Canvas& canvas) const;

private:
    bake::Status createPass();
    bake::Status uploadFont();

    const Device* device_ = nullptr;
    VkRenderPass pass_ = VK_NULL_HANDLE;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    bool started_ = false;
};

} // namespace xgc::viewer
