#pragma once

#include <xgc/vulkan/context.h>

namespace xgc::vulkan {

/// A 2D image with memory of its own, and a view where the usage is that of an attachment.
class Attachment {
public:
    Attachment() = default;
    Attachment(Attachment&& other) noexcept { *this = static_cast<Attachment&&>(other); }
    Attachment& operator=(Attachment&& other) noexcept;
    ~Attachment() { destroy(); }

    Status create(const Context& context, VkExtent2D size, VkFormat format, VkSampleCountFlagBits samples,
                  VkImageUsageFlags usage, VkImageAspectFlags aspect);
    void destroy();

    VkImage image() const { return image_; }
    VkImageView view() const { return view_; }

private:
    const Context* context_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    Memory memory_;
};

} // namespace xgc::vulkan
