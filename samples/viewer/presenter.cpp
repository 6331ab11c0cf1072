#include "presenter.h"

namespace xgc::viewer {

Presenter::~Presenter() {
    device_.waitIdle();
    for (const Slot& slot : slots_) {
        if (slot.pool) vkDestroyCommandPool(device_.device(), slot.pool, nullptr);
        if (slot.acquired) vkDestroySemaphore(device_.device(), slot.acquired, nullptr);
        if (slot.done) vkDestroyFence(device_.device(), slot.done, nullptr);
    }
}

bake::Status Presenter::create(Window& window) {
    window_ = &window;
    bake::Status status = device_.create(window.handle());
    for (Slot& slot : slots_) {
        if (status.ok()) status = createSlot(slot);
    }
    if (status.ok()) status = interface_.create(device_, window.handle(), kFramesInFlight, window.contentScale());
    return status;
}

bake::Status Presenter::createSlot(Slot& slot) {
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = device_.queueFamily();
    VkResult result = vkCreateCommandPool(device_.device(), &pool, nullptr, &slot.pool);
    if (result != VK_SUCCESS) return vulkanError("vkCreateCommandPool", result);
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = slot.pool;
    allocate.commandBufferCount = 1;
    result = vkAllocateCommandBuffers(device_.device(), &allocate, &slot.cmd);
    VkSemaphoreCreateInfo semaphore{};
    semaphore.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
    if (result == VK_SUCCESS) result = vkCreateSemaphore(device_.device(), &semaphore, nullptr, &slot.acquired);
    VkFenceCreateInfo fence{};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    fence.flags = VK_FENCE_CREATE_SIGNALED_BIT;
    if (result == VK_SUCCESS) result = vkCreateFence(device_.device(), &fence, nullptr, &slot.done);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("a frame's objects", result);
}

bool Presenter::fit(bake::Status& status) {
    VkExtent2D size{};
    window_->size(size.width, size.height);
    if (size.width == 0 || size.height == 0) return false;
    outdated_ |= size.width != windowSize_.width || size.height != windowSize_.height;
    if (!outdated_) return true;
    device_.waitIdle();
    status = swapchain_.create(device_, size);
    if (status.ok()) status = canvas_.create(device_, swapchain_.size(), swapchain_.format());
    if (status.ok()) status = interface_.attach(canvas_);
    windowSize_ = size;
    outdated_ = false;
    return status.ok();
}

bake::Status Presenter::begin(VkCommandBuffer& cmd) {
    const Slot& slot = slots_[frame_ % kFramesInFlight];
    VkResult result = vkWaitForFences(device_.device(), 1, &slot.done, VK_TRUE, UINT64_MAX);
    if (result == VK_SUCCESS) result = vkResetCommandPool(device_.device(), slot.pool, 0);
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    if (result == VK_SUCCESS) result = vkBeginCommandBuffer(slot.cmd, &begin);
    cmd = slot.cmd;
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("beginning a frame", result);
}

bake::Status Presenter::end(std::span<const VkSemaphoreSubmitInfo> signals, bool capture) {
    const Slot& slot = slots_[frame_++ % kFramesInFlight];
    bake::Status status;
    uint32_t image = 0;
    const bool acquired = swapchain_.acquire(slot.acquired, image, status);
    if (!status.ok()) return status;
    interface_.record(slot.cmd, canvas_);
    if (capture) canvas_.copyToHost(slot.cmd);
    if (acquired) canvas_.copyTo(slot.cmd, swapchain_.image(image));
    status = submit(slot, acquired, image, signals);
    if (status.ok() && acquired) outdated_ |= !swapchain_.present(image, status);
    outdated_ |= !acquired;
    if (status.ok() && capture) vkWaitForFences(device_.device(), 1, &slot.done, VK_TRUE, UINT64_MAX);
    return status;
}

bake::Status Presenter::submit(const Slot& slot, bool acquired, uint32_t image,
                               std::span<const VkSemaphoreSubmitInfo> signals) {
    VkResult result = vkEndCommandBuffer(slot.cmd);
    if (result != VK_SUCCESS) return vulkanError("vkEndCommandBuffer", result);
    VkSemaphoreSubmitInfo wait{};
    wait.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
    wait.semaphore = slot.acquired;
    wait.stageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    std::vector<VkSemaphoreSubmitInfo> all(signals.begin(), signals.end());
    if (acquired) {
        VkSemaphoreSubmitInfo written = wait;
        written.semaphore = swapchain_.written(image);
        written.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        all.push_back(written);
    }
    VkCommandBufferSubmitInfo cmd{};
    cmd.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
    cmd.commandBuffer = slot.cmd;
    VkSubmitInfo2 info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
    info.waitSemaphoreInfoCount = acquired ? 1 : 0;
    info.pWaitSemaphoreInfos = &wait;
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &cmd;
    info.signalSemaphoreInfoCount = uint32_t(all.size());
    info.pSignalSemaphoreInfos = all.data();
    vkResetFences(device_.device(), 1, &slot.done);
    result = vkQueueSubmit2(device_.queue(), 1, &info, slot.done);
    return result == VK_SUCCESS ? bake::Status{} : vulkanError("vkQueueSubmit2", result);
}

} // namespace xgc::viewer
