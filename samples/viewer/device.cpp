#include "device.h"

#include <xgc/vulkan/features.h>

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <cstring>
#include <vector>

namespace xgc::viewer {
namespace {

constexpr const char* kSwapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;

int rankOf(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return 2;
    default:
        return 1;
    }
}

bool hasSwapchain(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    for (const VkExtensionProperties& e : extensions) {
        if (std::strcmp(e.extensionName, kSwapchain) == 0) return true;
    }
    return false;
}

/// The first queue family that draws and presents; -1: none.
int familyFor(VkPhysicalDevice physical, VkSurfaceKHR surface) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    for (uint32_t i = 0; i < count; ++i) {
        VkBool32 presents = VK_FALSE;
        vkGetPhysicalDeviceSurfaceSupportKHR(physical, i, surface, &presents);
        if (presents && families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) return int(i);
    }
    return -1;
}

} // namespace

bake::Status vulkanError(const char* call, VkResult result) {
    return bake::systemError(fmt::format("{} failed ({})", call, int(result)));
}

Device::~Device() {
    if (device_) vkDestroyDevice(device_, nullptr);
    if (surface_) vkDestroySurfaceKHR(instance_, surface_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

bake::Status Device::create(GLFWwindow* window) {
    bake::Status status = createInstance();
    if (!status.ok()) return status;
    const VkResult made = glfwCreateWindowSurface(instance_, window, nullptr, &surface_);
    if (made != VK_SUCCESS) return vulkanError("the window's Vulkan surface", made);
    status = chooseDevice();
    if (status.ok()) status = createDevice();
    return status;
}

bake::Status Device::createInstance() {
    uint32_t count = 0;
    const char** extensions = glfwGetRequiredInstanceExtensions(&count);
    if (!extensions) {
        return bake::systemError("this display has no Vulkan surfaces: install a Vulkan driver (Debian: "
                                 "mesa-vulkan-drivers)");
    }
    VkApplicationInfo app{};
    app.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    app.pApplicationName = "xgc-viewer";
    app.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &app;
    info.enabledExtensionCount = count;
    info.ppEnabledExtensionNames = extensions;
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkCreateInstance (is a driver installed?)", result);
}

bake::Status Device::chooseDevice() {
    uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance_, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vkEnumeratePhysicalDevices(instance_, &count, devices.data());
    int best = 0;
    std::string refusals;
    for (const VkPhysicalDevice physical : devices) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(physical, &properties);
        vulkan::Features features;
        const char* missing = "Vulkan 1.3";
        if (properties.apiVersion >= VK_API_VERSION_1_3) {
            vkGetPhysicalDeviceFeatures2(physical, features.chain());
            missing = vulkan::missingFeature(features);
        }
        const int family = familyFor(physical, surface_);
        if (!missing && (family < 0 || !hasSwapchain(physical))) missing = "presenting to this window";
        if (missing) {
            refusals += fmt::format("; {} lacks {}", properties.deviceName, missing);
        } else if (rankOf(properties.deviceType) > best) {
            best = rankOf(properties.deviceType);
            physical_ = physical;
            queueFamily_ = uint32_t(family);
            name_ = properties.deviceName;
        }
    }
    if (best > 0) return {};
    return bake::systemError("no Vulkan 1.3 device that can draw to this window: install a driver (Mesa's lavapipe "
                             "will do)" +
                             refusals);
}

bake::Status Device::createDevice() {
    vulkan::Features features;
    vulkan::requireFeatures(features);
    const float priority = 1;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = queueFamily_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = features.chain();
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = 1;
    info.ppEnabledExtensionNames = &kSwapchain;
    const VkResult result = vkCreateDevice(physical_, &info, nullptr, &device_);
    if (result != VK_SUCCESS) return vulkanError("vkCreateDevice", result);
    vkGetDeviceQueue(device_, queueFamily_, 0, &queue_);
    vulkan::ContextDesc desc;
    desc.getInstanceProcAddr = vkGetInstanceProcAddr;
    desc.instance = instance_;
    desc.physicalDevice = physical_;
    desc.device = device_;
    desc.queueFamily = queueFamily_;
    const Status status = context_.create(desc);
    return status.ok() ? bake::Status{} : bake::systemError(status.message);
}

void Device::waitIdle() const {
    if (device_) vkDeviceWaitIdle(device_);
}

bake::Status Device::makeImage(const VkImageCreateInfo& info, VkImageAspectFlags aspect, Image& out) const {
    VkResult result = vkCreateImage(device_, &info, nullptr, &out.image);
    if (result != VK_SUCCESS) return vulkanError("vkCreateImage", result);
    vulkan::MemoryRequest request;
    vkGetImageMemoryRequirements(device_, out.image, &request.requirements);
    request.required = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    result = context_.allocate(request, out.memory);
    if (result == VK_SUCCESS) result = vkBindImageMemory(device_, out.image, out.memory.memory, out.memory.offset);
    if (result != VK_SUCCESS) return vulkanError("memory for an image", result);
    return makeView(out.image, info.format, aspect, out.view);
}

bake::Status Device::makeView(VkImage image, VkFormat format, VkImageAspectFlags aspect, VkImageView& out) const {
    VkImageViewCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = format;
    info.subresourceRange = {aspect, 0, 1, 0, 1};
    const VkResult result = vkCreateImageView(device_, &info, nullptr, &out);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkCreateImageView", result);
}

void Device::destroy(Image& image) const {
    if (image.view) vkDestroyImageView(device_, image.view, nullptr);
    if (image.image) vkDestroyImage(device_, image.image, nullptr);
    if (image.memory.memory) context_.release(image.memory);
    image = {};
}

} // namespace xgc::viewer
