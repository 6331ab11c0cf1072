#include "attachment.h"
#include "barriers.h"
#include "buffer.h"

#include <xgc/vulkan/shadow_map.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>

namespace xgc::vulkan {
namespace {

constexpr Access kDepthWrite{VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                             VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                 VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr Access kCopyRead{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr Access kCopyWrite{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr Access kShaderRead{VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
constexpr VkImageLayout kDrawn = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;

} // namespace

SunView sunView(const glm::vec3& towards, const glm::vec3& center, float radius, uint32_t texels) {
    const glm::vec3 across = std::fabs(towards.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 right = glm::normalize(glm::cross(across, towards)), up = glm::cross(towards, right);
    SunView sun;
    // Whole steps of texels, and one more around for the step.
    const float size = 2 * radius * (1 + 2.0f / float(texels));
    sun.texelUnits = size / float(texels);
    const auto snapped = [&](const glm::vec3& axis) {
        return std::floor(glm::dot(center, axis) / sun.texelUnits) * sun.texelUnits;
    };
    const float x = snapped(right), y = snapped(up), z = glm::dot(center, towards) + radius;
    sun.view = makeOrthographicView(right * x + up * y + towards * z, -towards, size, float(texels));
    const float scale = 2 / size, depth = 1 / (2 * radius);
    // Rows of the matrix; depth is 1 at the near plane, 0 at the far one.
    sun.worldToClip = glm::transpose(glm::mat4(glm::vec4(scale * right, -scale * x), glm::vec4(-scale * up, scale * y),
                                               glm::vec4(depth * towards, 1 - depth * z), glm::vec4(0, 0, 0, 1)));
    return sun;
}

struct ShadowMap::Impl {
    const Context* context = nullptr;
    uint32_t texels = 0;
    Attachment depth;
    Buffer depths;
};

ShadowMap::ShadowMap() = default;
ShadowMap::~ShadowMap() = default;
ShadowMap::ShadowMap(ShadowMap&&) noexcept = default;
ShadowMap& ShadowMap::operator=(ShadowMap&&) noexcept = default;

Status ShadowMap::create(const Context& context, uint32_t texels) {
    if (texels == 0) return {StatusCode::badArgument, "ShadowMap: texels must not be zero", 0};
    auto impl = std::make_unique<Impl>();
    impl->context = &context;
    impl->texels = texels;
    Status status = impl->depth.create(context, {texels, texels}, VK_FORMAT_D32_SFLOAT, VK_SAMPLE_COUNT_1_BIT,
                                       VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                       VK_IMAGE_ASPECT_DEPTH_BIT);
    if (status.ok()) {
        status = impl->depths.create(context, VkDeviceSize(texels) * texels * sizeof(float),
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                         VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                     Residence::device);
    }
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

void ShadowMap::begin(VkCommandBuffer cmd) {
    const Functions& vk = impl_->context->vk();
    // The frame before may still be copying it.
    imageBarrier(vk, cmd, {impl_->depth.image(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, kDrawn},
                 {kDepthWrite.stages | kCopyRead.stages, kDepthWrite.access}, kDepthWrite);
    VkRenderingAttachmentInfo depth{};
    depth.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    depth.imageView = impl_->depth.view();
    depth.imageLayout = kDrawn;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingInfo info{};
    info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
    info.renderArea = {{0, 0}, {impl_->texels, impl_->texels}};
    info.layerCount = 1;
    info.pDepthAttachment = &depth;
    vk.vkCmdBeginRendering(cmd, &info);
    const VkViewport viewport{0, 0, float(impl_->texels), float(impl_->texels), 0, 1};
    vk.vkCmdSetViewport(cmd, 0, 1, &viewport);
    vk.vkCmdSetScissor(cmd, 0, 1, &info.renderArea);
}

void ShadowMap::end(VkCommandBuffer cmd) {
    const Functions& vk = impl_->context->vk();
    vk.vkCmdEndRendering(cmd);
    imageBarrier(vk, cmd,
                 {impl_->depth.image(), VK_IMAGE_ASPECT_DEPTH_BIT, kDrawn, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                 kDepthWrite, kCopyRead);
    // The frame before may still be reading the depths.
    memoryBarrier(vk, cmd, {kShaderRead.stages, 0}, kCopyWrite);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 0, 1};
    region.imageExtent = {impl_->texels, impl_->texels, 1};
    vk.vkCmdCopyImageToBuffer(cmd, impl_->depth.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, impl_->depths.handle(),
                              1, &region);
    memoryBarrier(vk, cmd, kCopyWrite, kShaderRead);
}

uint32_t ShadowMap::texels() const {
    return impl_->texels;
}

VkDeviceAddress ShadowMap::depths() const {
    return impl_->depths.address();
}

} // namespace xgc::vulkan
