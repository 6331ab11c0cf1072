#include "buffer.h"

#include <utility>

namespace xgc::vulkan {
namespace {

MemoryRequest requestFor(Residence residence) {
    MemoryRequest request;
    switch (residence) {
    case Residence::device:
        request.required = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
        break;
    case Residence::upload:
        request.required = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        request.preferred = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
        break;
    case Residence::download:
        request.required = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        request.preferred = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
        break;
    }
    return request;
}

} // namespace

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    std::swap(address_, other.address_);
    return *this;
}

Status Buffer::create(const Context& context, VkDeviceSize bytes, VkBufferUsageFlags usage, Residence residence) {
    destroy();
    if (bytes > context.maxBufferBytes()) {
        return {StatusCode::outOfCapacity, "a buffer of this many bytes is past the device's maxBufferSize", bytes};
    }
    context_ = &context;
    const Functions& vk = context.vk();
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes;
    info.usage = usage;
    VkResult result = vk.vkCreateBuffer(context.device(), &info, context.allocation(), &buffer_);
    if (result != VK_SUCCESS) return refused("vkCreateBuffer failed", result);

    MemoryRequest request = requestFor(residence);
    request.deviceAddress = (usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0;
    vk.vkGetBufferMemoryRequirements(context.device(), buffer_, &request.requirements);
    result = context.allocate(request, memory_);
    if (result == VK_SUCCESS) {
        result = vk.vkBindBufferMemory(context.device(), buffer_, memory_.memory, memory_.offset);
    }
    if (result != VK_SUCCESS) {
        destroy();
        return refused("no device memory for a buffer: lower the arena or staging bytes", result);
    }
    bytes_ = bytes;
    if (request.deviceAddress) {
        const VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer_};
        address_ = vk.vkGetBufferDeviceAddress(context.device(), &address);
    }
    return {};
}

void Buffer::destroy() {
    if (buffer_) context_->vk().vkDestroyBuffer(context_->device(), buffer_, context_->allocation());
    if (memory_.memory) context_->release(memory_);
    buffer_ = VK_NULL_HANDLE;
    memory_ = {};
    bytes_ = 0;
    address_ = 0;
}

} // namespace xgc::vulkan
