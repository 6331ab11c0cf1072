#include "attachment.h"

#include <utility>

namespace xgc::vulkan {

Attachment& Attachment::operator=(Attachment&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(memory_, other.memory_);
    return *this;
}

Status Attachment::create(const Context& context, VkExtent2D size, VkFormat format, VkSampleCountFlagBits samples,
                          VkImageUsageFlags usage, VkImageAspectFlags aspect) {
    destroy();
    context_ = &context;
    const Functions& vk = context.vk();
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {size.width, size.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = samples;
    info.usage = usage;
    VkResult result = vk.vkCreateImage(context.device(), &info, context.allocation(), &image_);
    if (result != VK_SUCCESS) return refused("vkCreateImage failed: is the picture too large?", result);

    MemoryRequest request;
    request.required = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    vk.vkGetImageMemoryRequirements(context.device(), image_, &request.requirements);
    result = context.allocate(request, memory_);
    if (result == VK_SUCCESS) {
        result = vk.vkBindImageMemory(context.device(), image_, memory_.memory, memory_.offset);
    }
    constexpr VkImageUsageFlags kViewed =
        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    if (result == VK_SUCCESS && (usage & kViewed)) {
        VkImageViewCreateInfo view{};
        view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
        view.image = image_;
        view.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view.format = format;
        view.subresourceRange = {aspect, 0, 1, 0, 1};
        result = vk.vkCreateImageView(context.device(), &view, context.allocation(), &view_);
    }
    if (result != VK_SUCCESS) {
        destroy();
        return refused("no device memory for a picture: make it smaller", result);
    }
    return {};
}

void Attachment::destroy() {
    if (view_) context_->vk().vkDestroyImageView(context_->device(), view_, context_->allocation());
    if (image_) context_->vk().vkDestroyImage(context_->device(), image_, context_->allocation());
    if (memory_.memory) context_->release(memory_);
    view_ = VK_NULL_HANDLE;
    image_ = VK_NULL_HANDLE;
    memory_ = {};
}

} // namespace xgc::vulkan
