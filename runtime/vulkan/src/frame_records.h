#pragma once

#include "buffer.h"
#include "shared.h"

#include <xgc/draw_list.h>

namespace xgc::vulkan {

/// What the host writes anew each frame for the shaders and the indirect draws: one buffer, a part a frame in flight.
class FrameRecords {
public:
    struct Capacities {
        uint32_t views;
        uint32_t instances;
        uint32_t draws;
        uint32_t framesInFlight;
    };

    Status create(const Context& context, const Capacities& capacities) {
        const auto align = [](VkDeviceSize bytes) { return (bytes + 63) / 64 * 64; };
        frames_ = capacities.framesInFlight;
        instances_ = align(capacities.views * sizeof(shader::ViewRecord));
        draws_ = instances_ + align(capacities.instances * sizeof(shader::InstanceRecord));
        commands_ = draws_ + align(capacities.draws * sizeof(shader::DrawRecord));
        bytesPerFrame_ = commands_ + align(capacities.draws * sizeof(DrawCommand));
        return buffer_.create(context, bytesPerFrame_ * frames_,
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                  VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                              Residence::upload);
    }

    void begin(uint64_t frame) { begin_ = frame % frames_ * bytesPerFrame_; }

    shader::ViewRecord* views() { return at<shader::ViewRecord>(0); }
    shader::InstanceRecord* instances() { return at<shader::InstanceRecord>(instances_); }
    shader::DrawRecord* draws() { return at<shader::DrawRecord>(draws_); }
    DrawCommand* commands() { return at<DrawCommand>(commands_); }

    VkDeviceAddress viewAddress(uint32_t view) const {
        return buffer_.address() + begin_ + view * sizeof(shader::ViewRecord);
    }
    VkDeviceAddress instancesAddress() const { return buffer_.address() + begin_ + instances_; }
    VkDeviceAddress drawsAddress() const { return buffer_.address() + begin_ + draws_; }
    VkBuffer handle() const { return buffer_.handle(); }
    VkDeviceSize commandsOffset() const { return begin_ + commands_; }

private:
    template <typename T>
    T* at(VkDeviceSize offset) {
        return reinterpret_cast<T*>(buffer_.mapped().data() + begin_ + offset);
    }

    Buffer buffer_;
    VkDeviceSize instances_ = 0, draws_ = 0, commands_ = 0; ///< offsets in a frame's part
    VkDeviceSize bytesPerFrame_ = 0;
    VkDeviceSize begin_ = 0;
    uint32_t frames_ = 1;
};

} // namespace xgc::vulkan
