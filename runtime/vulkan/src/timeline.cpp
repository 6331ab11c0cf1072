#include "timeline.h"

#include <utility>

namespace xgc::vulkan {

Timeline& Timeline::operator=(Timeline&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(semaphore_, other.semaphore_);
    return *this;
}

Status Timeline::create(const Context& context) {
    destroy();
    context_ = &context;
    VkSemaphoreTypeCreateInfo type{};
    type.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO;
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
    const VkResult result = context.vk().vkCreateSemaphore(context.device(), &info, context.allocation(), &semaphore_);
    return result == VK_SUCCESS ? Status{} : refused("vkCreateSemaphore failed", result);
}

void Timeline::destroy() {
    if (semaphore_) context_->vk().vkDestroySemaphore(context_->device(), semaphore_, context_->allocation());
    semaphore_ = VK_NULL_HANDLE;
}

Status Timeline::wait(uint64_t frame, uint64_t nanoseconds) const {
    VkSemaphoreWaitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO;
    info.semaphoreCount = 1;
    info.pSemaphores = &semaphore_;
    info.pValues = &frame;
    const VkResult result = context_->vk().vkWaitSemaphores(context_->device(), &info, nanoseconds);
    if (result == VK_TIMEOUT) return refused("an earlier frame is not done: was it submitted with its signal?", result);
    return result == VK_SUCCESS ? Status{} : refused("waiting for a frame failed", result);
}

uint64_t Timeline::done() const {
    uint64_t value = 0;
    if (context_->vk().vkGetSemaphoreCounterValue(context_->device(), semaphore_, &value) != VK_SUCCESS) return 0;
    return value;
}

VkSemaphoreSubmitInfo Timeline::signal(uint64_t frame) const {
    VkSemaphoreSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
    info.semaphore = semaphore_;
    info.value = frame;
    info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    return info;
}

} // namespace xgc::vulkan
