#include "attachment.h"
#include "barriers.h"
#include "buffer.h"
#include "timeline.h"

#include <xgc/vulkan/offscreen.h>

#include <algorithm>
#include <array>
#include <vector>

namespace xgc::vulkan {
namespace {

constexpr uint64_t kWaitNanoseconds = 60'000'000'000;
constexpr size_t kMaxSignals = 8;
constexpr Access kColorWrite{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
constexpr Access kDepthWrite{VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                             VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                 VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr Access kCopyRead{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
/// Copies and blits alike: which of them reads the drawn picture depends on the supersampling.
constexpr Access kTransferRead{VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_BLIT_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr Access kBlitWrite{VK_PIPELINE_STAGE_2_BLIT_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr Access kCopyWrite{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr Access kHostRead{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};

} // namespace

struct Offscreen::Impl {
    struct Slot {
        VkCommandPool pool = VK_NULL_HANDLE;
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        Buffer pixels;
    };

    const Context* context = nullptr;
    VkQueue queue = VK_NULL_HANDLE;
    OffscreenDesc desc;
    Attachment samples; ///< where there is more than one sample a pixel
    Attachment color;   ///< one sample a pixel
    Attachment halved;  ///< where it is supersampled
    Attachment depth;
    std::vector<Slot> slots;
    Timeline timeline;
    uint64_t frame = 0;     ///< the one being recorded, or the latest
    uint64_t submitted = 0; ///< the latest

    ~Impl();
    Status createAttachments();
    void startRendering(VkCommandBuffer cmd, VkAttachmentLoadOp load, std::span<const float, 4> clear) const;
    Status createSlot(Slot& slot);
    Slot& slotOf(uint64_t f) { return slots[f % slots.size()]; }
    bool multisampled() const { return desc.samples != VK_SAMPLE_COUNT_1_BIT; }
    VkExtent2D drawnSize() const {
        return {desc.size.width * desc.supersampling, desc.size.height * desc.supersampling};
    }
    void halve(VkCommandBuffer cmd);
};

Offscreen::Impl::~Impl() {
    if (!context) return;
    // A failure here means that the device is lost: then nothing is in use either.
    if (submitted > 0) static_cast<void>(timeline.wait(submitted, kWaitNanoseconds));
    for (Slot& slot : slots) {
        if (slot.pool) context->vk().vkDestroyCommandPool(context->device(), slot.pool, context->allocation());
    }
}

Status Offscreen::Impl::createAttachments() {
    const VkImageUsageFlags drawn = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    Status status = color.create(*context, drawnSize(), desc.colorFormat, VK_SAMPLE_COUNT_1_BIT,
                                 drawn | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    if (status.ok() && multisampled()) {
        status =
            samples.create(*context, drawnSize(), desc.colorFormat, desc.samples, drawn, VK_IMAGE_ASPECT_COLOR_BIT);
    }
    if (status.ok()) {
        status = depth.create(*context, drawnSize(), desc.depthFormat, desc.samples,
                              VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                  (desc.pauses ? VK_IMAGE_USAGE_TRANSFER_SRC_BIT : 0),
                              VK_IMAGE_ASPECT_DEPTH_BIT);
    }
    if (status.ok() && desc.supersampling == 2) {
        status =
            halved.create(*context, desc.size, desc.colorFormat, VK_SAMPLE_COUNT_1_BIT,
                          VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    }
    return status;
}

Status Offscreen::Impl::createSlot(Slot& slot) {
    const Functions& vk = context->vk();
    VkCommandPoolCreateInfo poolInfo{};
    poolInfo.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    poolInfo.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    poolInfo.queueFamilyIndex = context->queueFamily();
    VkResult result = vk.vkCreateCommandPool(context->device(), &poolInfo, context->allocation(), &slot.pool);
    if (result != VK_SUCCESS) return refused("vkCreateCommandPool failed", result);
    VkCommandBufferAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    info.commandPool = slot.pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    result = vk.vkAllocateCommandBuffers(context->device(), &info, &slot.cmd);
    if (result != VK_SUCCESS) return refused("vkAllocateCommandBuffers failed", result);
    return slot.pixels.create(*context, VkDeviceSize(desc.size.width) * desc.size.height * 4,
                              VK_BUFFER_USAGE_TRANSFER_DST_BIT, Residence::download);
}

Offscreen::Offscreen() = default;
Offscreen::~Offscreen() = default;
Offscreen::Offscreen(Offscreen&&) noexcept = default;
Offscreen& Offscreen::operator=(Offscreen&&) noexcept = default;

Status Offscreen::create(const Context& context, VkQueue queue, const OffscreenDesc& desc) {
    if (desc.size.width == 0 || desc.size.height == 0 || desc.framesInFlight == 0) {
        return {StatusCode::badArgument, "OffscreenDesc: the size and framesInFlight must not be zero", 0};
    }
    if (desc.supersampling != 1 && desc.supersampling != 2) {
        return {StatusCode::badArgument, "OffscreenDesc::supersampling: 1 or 2", desc.supersampling};
    }
    if (desc.pauses && desc.samples != VK_SAMPLE_COUNT_1_BIT) {
        return {StatusCode::badArgument, "OffscreenDesc::pauses: takes one sample a pixel", desc.samples};
    }
    auto impl = std::make_unique<Impl>();
    impl->context = &context;
    impl->queue = queue;
    impl->desc = desc;
    Status status = impl->createAttachments();
    if (status.ok()) status = impl->timeline.create(context);
    impl->slots.resize(desc.framesInFlight);
    for (Impl::Slot& slot : impl->slots) {
        if (status.ok()) status = impl->createSlot(slot);
    }
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

Status Offscreen::begin(VkCommandBuffer& cmd) {
    Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    const uint64_t next = self.frame + 1;
    if (next > self.slots.size()) {
        const Status status = self.timeline.wait(next - self.slots.size(), kWaitNanoseconds);
        if (!status.ok()) return status;
    }
    const Impl::Slot& slot = self.slotOf(next);
    VkResult result = vk.vkResetCommandPool(self.context->device(), slot.pool, 0);
    if (result == VK_SUCCESS) {
        VkCommandBufferBeginInfo info{};
        info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
        info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        result = vk.vkBeginCommandBuffer(slot.cmd, &info);
    }
    if (result != VK_SUCCESS) return refused("a command buffer could not be begun", result);
    self.frame = next;
    cmd = slot.cmd;
    return {};
}

void Offscreen::beginRendering(VkCommandBuffer cmd, std::span<const float, 4> clear) {
    Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    const auto discard = [&](const Attachment& target, VkImageAspectFlags aspect, VkImageLayout layout, Access before,
                             Access after) {
        imageBarrier(vk, cmd, {target.image(), aspect, VK_IMAGE_LAYOUT_UNDEFINED, layout}, before, after);
    };
    const VkImageLayout colorLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    // The frame before may still be drawing to the attachments, or copying from them.
    discard(self.color, VK_IMAGE_ASPECT_COLOR_BIT, colorLayout,
            {kColorWrite.stages | kTransferRead.stages, kColorWrite.access}, kColorWrite);
    if (self.multisampled()) {
        discard(self.samples, VK_IMAGE_ASPECT_COLOR_BIT, colorLayout, kColorWrite,
                {kColorWrite.stages, kColorWrite.access | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT});
    }
    discard(self.depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, kDepthWrite, kDepthWrite);

    self.startRendering(cmd, VK_ATTACHMENT_LOAD_OP_CLEAR, clear);
}

void Offscreen::Impl::startRendering(VkCommandBuffer cmd, VkAttachmentLoadOp load,
                                     std::span<const float, 4> clear) const {
    const Functions& vk = context->vk();
    const VkImageLayout colorLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    VkRenderingAttachmentInfo colors{};
    colors.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    colors.imageView = multisampled() ? samples.view() : color.view();
    colors.imageLayout = colorLayout;
    colors.loadOp = load;
    colors.storeOp = multisampled() ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE;
    std::copy(clear.begin(), clear.end(), colors.clearValue.color.float32);
    if (multisampled()) {
        colors.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        colors.resolveImageView = color.view();
        colors.resolveImageLayout = colorLayout;
    }
    VkRenderingAttachmentInfo depths{};
    depths.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    depths.imageView = depth.view();
    depths.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    depths.loadOp = load;
    depths.storeOp = desc.pauses ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea = {{0, 0}, drawnSize()};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colors;
    info.pDepthAttachment = &depths;
    vk.vkCmdBeginRendering(cmd, &info);
    const VkViewport viewport{0, 0, float(info.renderArea.extent.width), float(info.renderArea.extent.height), 0, 1};
    vk.vkCmdSetViewport(cmd, 0, 1, &viewport);
    vk.vkCmdSetScissor(cmd, 0, 1, &info.renderArea);
}

VkImage Offscreen::pauseRendering(VkCommandBuffer cmd) {
    const Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    vk.vkCmdEndRendering(cmd);
    imageBarrier(vk, cmd,
                 {self.depth.image(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                 kDepthWrite, kCopyRead);
    return self.depth.image();
}

void Offscreen::resumeRendering(VkCommandBuffer cmd) {
    const Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    imageBarrier(vk, cmd,
                 {self.depth.image(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                  VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL},
                 kCopyRead, kDepthWrite);
    memoryBarrier(vk, cmd, kColorWrite,
                  {kColorWrite.stages, kColorWrite.access | VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT});
    constexpr std::array<float, 4> kNone{};
    self.startRendering(cmd, VK_ATTACHMENT_LOAD_OP_LOAD, kNone);
}

/// Scales the drawn picture down: the linear filter, halfway between four pixels, is their mean.
void Offscreen::Impl::halve(VkCommandBuffer cmd) {
    const Functions& vk = context->vk();
    // The frame before may still be copying from it.
    imageBarrier(
        vk, cmd,
        {halved.image(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL},
        kCopyRead, kBlitWrite);
    const VkExtent2D from = drawnSize();
    VkImageBlit region{};
    region.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.srcOffsets[1] = {int32_t(from.width), int32_t(from.height), 1};
    region.dstSubresource = region.srcSubresource;
    region.dstOffsets[1] = {int32_t(desc.size.width), int32_t(desc.size.height), 1};
    vk.vkCmdBlitImage(cmd, color.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, halved.image(),
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_LINEAR);
    imageBarrier(vk, cmd,
                 {halved.image(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                 kBlitWrite, kCopyRead);
}

void Offscreen::endRendering(VkCommandBuffer cmd) {
    Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    vk.vkCmdEndRendering(cmd);
    imageBarrier(vk, cmd,
                 {self.color.image(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                  VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                 kColorWrite, kTransferRead);
    const bool halved = self.desc.supersampling == 2;
    if (halved) self.halve(cmd);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {self.desc.size.width, self.desc.size.height, 1};
    vk.vkCmdCopyImageToBuffer(cmd, halved ? self.halved.image() : self.color.image(),
                              VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, self.slotOf(self.frame).pixels.handle(), 1,
                              &region);
    memoryBarrier(vk, cmd, kCopyWrite, kHostRead);
}

Status Offscreen::submit(std::span<const VkSemaphoreSubmitInfo> signals, uint64_t& frame) {
    Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    if (signals.size() > kMaxSignals) return {StatusCode::badArgument, "Offscreen::submit: at most 8 signals", 0};
    const VkCommandBuffer cmd = self.slotOf(self.frame).cmd;
    VkResult result = vk.vkEndCommandBuffer(cmd);
    if (result != VK_SUCCESS) return refused("vkEndCommandBuffer failed", result);
    std::array<VkSemaphoreSubmitInfo, kMaxSignals + 1> all;
    std::copy(signals.begin(), signals.end(), all.begin());
    all[signals.size()] = self.timeline.signal(self.frame);
    VkCommandBufferSubmitInfo commands{};
    commands.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
    commands.commandBuffer = cmd;
    VkSubmitInfo2 info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &commands;
    info.signalSemaphoreInfoCount = uint32_t(signals.size() + 1);
    info.pSignalSemaphoreInfos = all.data();
    result = vk.vkQueueSubmit2(self.queue, 1, &info, VK_NULL_HANDLE);
    if (result != VK_SUCCESS) return refused("vkQueueSubmit2 failed", result);
    self.submitted = self.frame;
    frame = self.frame;
    return {};
}

Status Offscreen::read(uint64_t frame, std::span<std::byte> pixels) {
    Impl& self = *impl_;
    if (frame == 0 || frame > self.submitted || frame + self.slots.size() <= self.frame) {
        return {StatusCode::badArgument, "Offscreen::read: the frame is not in flight any more, or not yet", frame};
    }
    const std::span<const std::byte> mapped = self.slotOf(frame).pixels.mapped();
    if (pixels.size() < mapped.size()) return {StatusCode::badArgument, "Offscreen::read: too few bytes", frame};
    const Status status = self.timeline.wait(frame, kWaitNanoseconds);
    if (status.ok()) std::copy(mapped.begin(), mapped.end(), pixels.begin());
    return status;
}

const OffscreenDesc& Offscreen::desc() const {
    return impl_->desc;
}

} // namespace xgc::vulkan
