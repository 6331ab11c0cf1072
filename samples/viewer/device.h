#pragma once

#include <xgc/bake/status.h>
#include <xgc/vulkan/context.h>

#include <vulkan/vulkan.h>

#include <string>

struct GLFWwindow;

namespace xgc::viewer {

/// A status for a Vulkan call that failed.
bake::Status vulkanError(const char* call, VkResult result);

/// Instance, surface, device and queue for a window.
class Device {
public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    bake::Status create(GLFWwindow* window);

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkDevice device() const { return device_; }
    VkQueue queue() const { return queue_; }
    uint32_t queueFamily() const { return queueFamily_; }
    VkSurfaceKHR surface() const { return surface_; }
    const std::string& name() const { return name_; }
    const vulkan::Context& context() const { return context_; }
    void waitIdle() const;

    /// An image with memory of its own and a view. To be given back to `destroy`.
    struct Image {
        VkImage image = VK_NULL_HANDLE;
        VkImageView view = VK_NULL_HANDLE;
        vulkan::Memory memory;
    };
    bake::Status makeImage(const VkImageCreateInfo& info, VkImageAspectFlags aspect, Image& out) const;
    bake::Status makeView(VkImage image, VkFormat format, VkImageAspectFlags aspect, VkImageView& out) const;
    void destroy(Image& image) const;

private:
    bake::Status createInstance();
    bake::Status chooseDevice();
    bake::Status createDevice();

    VkInstance instance_ = VK_NULL_HANDLE;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t queueFamily_ = 0;
    std::string name_;
    vulkan::Context context_;
};

} // namespace xgc::viewer
