#include "canvas.h"

#include <array>
#include <cstring>

namespace xgc::viewer {
namespace {

struct Use {
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 access;
    VkImageLayout layout;
};

VkImageMemoryBarrier2 barrier(VkImage image, VkImageAspectFlags aspect, const Use& before, const Use& after) {
    VkImageMemoryBarrier2 out{};
    out.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    out.srcStageMask = before.stages;
    out.srcAccessMask = before.access;
    out.dstStageMask = after.stages;
    out.dstAccessMask = after.access;
    out.oldLayout = before.layout;
    out.newLayout = after.layout;
    out.srcQueueFamilyIndex = out.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    out.image = image;
    out.subresourceRange = {aspect, 0, 1, 0, 1};
    return out;
}

template <size_t kCount>
void record(VkCommandBuffer cmd, const std::array<VkImageMemoryBarrier2, kCount>& barriers) {
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.imageMemoryBarrierCount = kCount;
    info.pImageMemoryBarriers = barriers.data();
    vkCmdPipelineBarrier2(cmd, &info);
}

constexpr VkPipelineStageFlags2 kDepthStages =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags2 kDepthWrite =
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags2 kColorWrite = VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT;

} // namespace

Canvas::~Canvas() {
    destroy();
}

void Canvas::destroy() {
    if (!device_) return;
    for (VkImageView* view : {&sceneView_, &panelView_}) {
        if (*view) vkDestroyImageView(device_->device(), *view, nullptr);
        *view = VK_NULL_HANDLE;
    }
    if (readback_) vkDestroyBuffer(device_->device(), readback_, nullptr);
    if (readbackMemory_.memory) device_->context().release(readbackMemory_);
    readback_ = VK_NULL_HANDLE;
    readbackMemory_ = {};
    for (Device::Image* image : {&color_, &samples_, &depth_}) device_->destroy(*image);
}

bake::Status Canvas::create(const Device& device, VkExtent2D size, VkFormat windowFormat) {
    destroy();
    device_ = &device;
    size_ = size;
    const bool srgb = windowFormat == VK_FORMAT_B8G8R8A8_SRGB || windowFormat == VK_FORMAT_R8G8B8A8_SRGB;
    const bake::Status status = createImages(srgb);
    return status.ok() ? createReadback() : status;
}

bake::Status Canvas::createImages(bool srgb) {
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.extent = {size_.width, size_.height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.format = srgb ? kSceneFormat : kPanelFormat; // as the window's: copies keep the bytes then
    info.flags = VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    bake::Status status = device_->makeImage(info, VK_IMAGE_ASPECT_COLOR_BIT, color_);
    info.flags = 0;
    info.format = kSceneFormat;
    info.samples = kSamples;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
    if (status.ok()) status = device_->makeImage(info, VK_IMAGE_ASPECT_COLOR_BIT, samples_);
    info.format = kDepthFormat;
    info.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
    if (status.ok()) status = device_->makeImage(info, VK_IMAGE_ASPECT_DEPTH_BIT, depth_);
    if (!status.ok()) return status;
    status = device_->makeView(color_.image, kSceneFormat, VK_IMAGE_ASPECT_COLOR_BIT, sceneView_);
    if (!status.ok()) return status;
    return device_->makeView(color_.image, kPanelFormat, VK_IMAGE_ASPECT_COLOR_BIT, panelView_);
}

bake::Status Canvas::createReadback() {
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = VkDeviceSize(size_.width) * size_.height * 4;
    info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    VkResult result = vkCreateBuffer(device_->device(), &info, nullptr, &readback_);
    if (result != VK_SUCCESS) return vulkanError("vkCreateBuffer", result);
    vulkan::MemoryRequest request;
    vkGetBufferMemoryRequirements(device_->device(), readback_, &request.requirements);
    request.required = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    request.preferred = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    result = device_->context().allocate(request, readbackMemory_);
    if (result == VK_SUCCESS)
        result = vkBindBufferMemory(device_->device(), readback_, readbackMemory_.memory, readbackMemory_.offset);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("memory for screenshots", result);
}

void Canvas::beginScene(VkCommandBuffer cmd) const {
    // Frames share the images: what the last one did to them is over before this one draws.
    constexpr VkImageLayout kColorLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const Use toColor{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, kColorWrite, kColorLayout};
    const Use wasColor{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                       VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, VK_IMAGE_LAYOUT_UNDEFINED};
    const Use wasDepth{kDepthStages, kDepthWrite, VK_IMAGE_LAYOUT_UNDEFINED};
    const Use toDepth{kDepthStages, kDepthWrite, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL};
    record(cmd, std::array{barrier(color_.image, VK_IMAGE_ASPECT_COLOR_BIT, wasColor, toColor),
                           barrier(samples_.image, VK_IMAGE_ASPECT_COLOR_BIT, wasColor, toColor),
                           barrier(depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, wasDepth, toDepth)});
    VkRenderingAttachmentInfo color{};
    color.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    color.imageView = samples_.view;
    color.imageLayout = kColorLayout;
    color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
    color.resolveImageView = sceneView_;
    color.resolveImageLayout = kColorLayout;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    color.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    color.clearValue.color = {{0.012f, 0.013f, 0.015f, 1}};
    VkRenderingAttachmentInfo depth{};
    depth.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    depth.imageView = depth_.view;
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE; // reversed: cleared to 0, infinitely far
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea.extent = size_;
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &color;
    info.pDepthAttachment = &depth;
    vkCmdBeginRendering(cmd, &info);
}

void Canvas::endScene(VkCommandBuffer cmd) const {
    vkCmdEndRendering(cmd);
}

void Canvas::copyTo(VkCommandBuffer cmd, VkImage image) const {
    const Use none{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
    const Use written{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};
    const Use presented{VK_PIPELINE_STAGE_2_NONE, 0, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
    record(cmd, std::array{barrier(image, VK_IMAGE_ASPECT_COLOR_BIT, none, written)});
    VkImageBlit blit{}; // converts the order of the channels
    blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    blit.srcOffsets[1] = blit.dstOffsets[1] = {int(size_.width), int(size_.height), 1};
    vkCmdBlitImage(cmd, color_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   1, &blit, VK_FILTER_NEAREST);
    record(cmd, std::array{barrier(image, VK_IMAGE_ASPECT_COLOR_BIT, written, presented)});
}

void Canvas::copyToHost(VkCommandBuffer cmd) const {
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {size_.width, size_.height, 1};
    vkCmdCopyImageToBuffer(cmd, color_.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_, 1, &copy);
    VkMemoryBarrier2 memory{};
    memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
    memory.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    memory.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    memory.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    memory.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &memory;
    vkCmdPipelineBarrier2(cmd, &info);
}

bake::Image Canvas::picture() const {
    bake::Image out;
    out.width = size_.width;
    out.height = size_.height;
    out.pixels.resize(size_t(out.width) * out.height);
    std::memcpy(out.pixels.data(), readbackMemory_.mapped, out.pixels.size() * 4);
    for (glm::u8vec4& p : out.pixels) p.a = 255;
    return out;
}

} // namespace xgc::viewer
