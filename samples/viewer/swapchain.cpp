#include "swapchain.h"

#include <algorithm>

namespace xgc::viewer {
namespace {

/// One that keeps bytes as they are, else one that the copy can convert to.
VkSurfaceFormatKHR chooseFormat(VkPhysicalDevice physical, VkSurfaceKHR surface) {
    uint32_t count = 0;
    vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, &count, nullptr);
    std::vector<VkSurfaceFormatKHR> formats(count);
    vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, &count, formats.data());
    for (const VkFormat wanted :
         {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R8G8B8A8_SRGB}) {
        for (const VkSurfaceFormatKHR& f : formats) {
            if (f.format == wanted && f.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return f;
        }
    }
    return {};
}

bool isOutdated(VkResult result) {
    return result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
}

} // namespace

Swapchain::~Swapchain() {
    destroySemaphores();
    if (swapchain_) vkDestroySwapchainKHR(device_->device(), swapchain_, nullptr);
}

void Swapchain::destroySemaphores() {
    for (const VkSemaphore semaphore : written_) vkDestroySemaphore(device_->device(), semaphore, nullptr);
    written_.clear();
}

bake::Status Swapchain::create(const Device& device, VkExtent2D size) {
    device_ = &device;
    VkSurfaceCapabilitiesKHR can;
    VkResult result = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical(), device.surface(), &can);
    if (result != VK_SUCCESS) return vulkanError("vkGetPhysicalDeviceSurfaceCapabilitiesKHR", result);
    const VkSurfaceFormatKHR format = chooseFormat(device.physical(), device.surface());
    if (format.format == VK_FORMAT_UNDEFINED) return bake::systemError("the window has no format of 8 bits in sRGB");
    if (can.currentExtent.width != UINT32_MAX) size = can.currentExtent;

    VkSwapchainCreateInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR;
    info.surface = device.surface();
    info.minImageCount = can.minImageCount + 1;
    if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = {std::clamp(size.width, can.minImageExtent.width, can.maxImageExtent.width),
                        std::clamp(size.height, can.minImageExtent.height, can.maxImageExtent.height)};
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.preTransform = can.currentTransform;
    info.compositeAlpha = can.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                              : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    info.oldSwapchain = swapchain_;
    VkSwapchainKHR made = VK_NULL_HANDLE;
    result = vkCreateSwapchainKHR(device.device(), &info, nullptr, &made);
    if (swapchain_) vkDestroySwapchainKHR(device.device(), swapchain_, nullptr);
    swapchain_ = made;
    if (result != VK_SUCCESS) return vulkanError("vkCreateSwapchainKHR", result);
    size_ = info.imageExtent;
    format_ = format.format;

    uint32_t count = 0;
    vkGetSwapchainImagesKHR(device.device(), swapchain_, &count, nullptr);
    images_.resize(count);
    vkGetSwapchainImagesKHR(device.device(), swapchain_, &count, images_.data());
    destroySemaphores();
    VkSemaphoreCreateInfo semaphore{};
    semaphore.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
    for (uint32_t i = 0; i < count && result == VK_SUCCESS; ++i) {
        written_.push_back(VK_NULL_HANDLE);
        result = vkCreateSemaphore(device.device(), &semaphore, nullptr, &written_.back());
    }
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkCreateSemaphore", result);
}

bool Swapchain::acquire(VkSemaphore ready, uint32_t& index, bake::Status& status) {
    const VkResult result =
        vkAcquireNextImageKHR(device_->device(), swapchain_, UINT64_MAX, ready, VK_NULL_HANDLE, &index);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return false;
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR) status = vulkanError("vkAcquireNextImageKHR", result);
    return status.ok(); // a suboptimal image can be drawn to; presenting says so again
}

bool Swapchain::present(uint32_t index, bake::Status& status) {
    VkPresentInfoKHR info{};
    info.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR;
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &written_[index];
    info.swapchainCount = 1;
    info.pSwapchains = &swapchain_;
    info.pImageIndices = &index;
    const VkResult result = vkQueuePresentKHR(device_->queue(), &info);
    if (isOutdated(result)) return false;
    if (result != VK_SUCCESS) status = vulkanError("vkQueuePresentKHR", result);
    return status.ok();
}

} // namespace xgc::viewer
