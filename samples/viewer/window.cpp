#include "window.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace xgc::viewer {
namespace {

Window& windowOf(GLFWwindow* handle) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(handle));
}

/// The library's latest message; it has no other place for it.
std::string lastError() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "no reason given";
}

} // namespace

Window::~Window() {
    if (window_) glfwDestroyWindow(window_);
    if (started_) glfwTerminate();
}

bake::Status Window::create(uint32_t width, uint32_t height) {
    if (!glfwInit()) {
        return bake::systemError(fmt::format("no display to open a window on ({}). Run it in a desktop session, set "
                                             "DISPLAY, or, without a screen, use: xvfb-run -a xgc-viewer ...",
                                             lastError()));
    }
    started_ = true;
    if (!glfwVulkanSupported()) {
        return bake::systemError("no Vulkan loader or driver: install one (Debian: libvulkan1 mesa-vulkan-drivers)");
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    window_ = glfwCreateWindow(int(width), int(height), "xgc-viewer", nullptr, nullptr);
    if (!window_) return bake::systemError(fmt::format("the window could not be made ({})", lastError()));
    // Where the panel still leaves a picture, unless less was asked for.
    glfwSetWindowSizeLimits(window_, std::min(640, int(width)), std::min(420, int(height)), GLFW_DONT_CARE,
                            GLFW_DONT_CARE);
    glfwSetWindowUserPointer(window_, this);
    installCallbacks();
    return {};
}

void Window::size(uint32_t& width, uint32_t& height) const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(window_, &w, &h);
    width = uint32_t(w);
    height = uint32_t(h);
}

float Window::contentScale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x;
}

float Window::pixelsAUnit() const {
    int width = 0, pixels = 0, ignored = 0;
    glfwGetWindowSize(window_, &width, &ignored);
    glfwGetFramebufferSize(window_, &pixels, &ignored);
    return width > 0 ? float(pixels) / float(width) : 1;
}

void Window::setTitle(const char* title) {
    glfwSetWindowTitle(window_, title);
}

std::vector<Event> Window::poll(bool wait) {
    if (wait) {
        glfwWaitEventsTimeout(0.1);
    } else {
        glfwPollEvents();
    }
    if (glfwWindowShouldClose(window_)) {
        Event quit;
        quit.kind = EventKind::quit;
        events_.push_back(quit);
    }
    return std::exchange(events_, {});
}

void Window::installCallbacks() {
    glfwSetCursorPosCallback(window_, [](GLFWwindow* handle, double x, double y) {
        Window& self = windowOf(handle);
        Event event;
        event.x = float(x) * self.pixelsAUnit();
        event.y = float(y) * self.pixelsAUnit();
        self.events_.push_back(event);
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* handle, int button, int action, int) {
        Event event;
        event.kind = EventKind::button;
        event.code = button;
        event.down = action == GLFW_PRESS;
        windowOf(handle).events_.push_back(event);
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* handle, double x, double y) {
        Event event;
        event.kind = EventKind::wheel;
        event.x = float(x);
        event.y = float(y);
        windowOf(handle).events_.push_back(event);
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* handle, int key, int, int action, int) {
        if (action == GLFW_REPEAT || key < 0) return;
        Event event;
        event.kind = EventKind::key;
        event.code = key;
        event.down = action == GLFW_PRESS;
        windowOf(handle).events_.push_back(event);
    });
    glfwSetCharCallback(window_, [](GLFWwindow* handle, unsigned character) {
        Event event;
        event.kind = EventKind::text;
        event.code = int(character);
        windowOf(handle).events_.push_back(event);
    });
    glfwSetDropCallback(window_, [](GLFWwindow* handle, int count, const char** files) {
        Event event;
        event.kind = EventKind::drop;
        event.files.assign(files, files + count);
        windowOf(handle).events_.push_back(event);
    });
}

} // namespace xgc::viewer
