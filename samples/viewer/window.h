#pragma once

#include "events.h"

#include <xgc/bake/status.h>

#include <cstdint>
#include <vector>

struct GLFWwindow;

namespace xgc::viewer {

/// A window and what its user does in it. One at a time.
class Window {
public:
    Window() = default;
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    ~Window();

    /// The message says what is missing where there is no display or no Vulkan loader.
    bake::Status create(uint32_t width, uint32_t height);

    GLFWwindow* handle() const { return window_; }
    /// Pixels of the picture; 0 while it is minimised.
    void size(uint32_t& width, uint32_t& height) const;
    /// Of text and controls, on displays with small pixels.
    float contentScale() const;
    /// Events since the last call, in order. Waits for one where asked to, at most for a while.
    std::vector<Event> poll(bool wait);
    void setTitle(const char* title);

private:
    void installCallbacks();
    float pixelsAUnit() const; ///< of the pointer's units

    GLFWwindow* window_ = nullptr;
    bool started_ = false;
    std::vector<Event> events_;
};

} // namespace xgc::viewer
