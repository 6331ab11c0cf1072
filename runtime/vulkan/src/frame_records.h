#pragma once

#include "buffer.h"
#include "shared.h"

#include <xgc/draw_list.h>

#include <glm/vec4.hpp>

#include <array>

namespace xgc::vulkan {

/// The rows of a joint's matrix.
using JointRows = std::array<glm::vec4, 3>;

/// What the host writes anew each frame for the shaders and the indirect draws: one buffer, a part a frame in flight.
///
///     [ passes | instances | poses: joints, weights of targets |
///       view 0: draws, commands, instance ids, offsets of lambdas, lambdas | view 1: ... ]
class FrameRecords {
public:
    struct Capacities {
        uint32_t passes;
        uint32_t views;
        uint32_t instances;
        uint32_t draws; ///< of each view
        uint32_t framesInFlight;
        uint32_t morphGroups; ///< of each view; 0: no offsets either
        uint32_t joints;
        uint32_t morphWeights;
    };

    Status create(const Context& context, const Capacities& capacities) {
        const auto align = [](VkDeviceSize bytes) { return (bytes + 63) / 64 * 64; };
        frames_ = capacities.framesInFlight;
        instances_ = align(capacities.passes * sizeof(shader::ViewRecord));
        joints_ = instances_ + align(capacities.instances * sizeof(shader::InstanceRecord));
        morphWeights_ = joints_ + align(VkDeviceSize(capacities.joints) * sizeof(JointRows));
        views_ = morphWeights_ + align(VkDeviceSize(capacities.morphWeights) * sizeof(float));
        commands_ = align(capacities.draws * sizeof(shader::DrawRecord));
        ids_ = commands_ + align(capacities.draws * sizeof(DrawCommand));
        lambdaOffsets_ = ids_ + align(capacities.instances * sizeof(uint32_t));
        morphs_ = capacities.morphGroups > 0;
        lambdas_ = lambdaOffsets_ + (morphs_ ? align(capacities.instances * sizeof(uint32_t)) : 0);
        bytesPerView_ = lambdas_ + align(VkDeviceSize(capacities.morphGroups) * sizeof(float));
        bytesPerFrame_ = views_ + capacities.views * bytesPerView_;
        return buffer_.create(context, bytesPerFrame_ * frames_,
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                                  VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                              Residence::upload);
    }

    void begin(uint64_t frame) { begin_ = frame % frames_ * bytesPerFrame_; }

    shader::ViewRecord* passes() { return at<shader::ViewRecord>(0); }
    shader::InstanceRecord* instances() { return at<shader::InstanceRecord>(instances_); }
    JointRows* joints() { return at<JointRows>(joints_); }
    float* morphWeights() { return at<float>(morphWeights_); }
    shader::DrawRecord* draws(uint32_t view) { return at<shader::DrawRecord>(ofView(view)); }
    DrawCommand* commands(uint32_t view) { return at<DrawCommand>(ofView(view) + commands_); }
    uint32_t* ids(uint32_t view) { return at<uint32_t>(ofView(view) + ids_); }
    uint32_t* lambdaOffsets(uint32_t view) { return at<uint32_t>(ofView(view) + lambdaOffsets_); }
    float* lambdas(uint32_t view) { return at<float>(ofView(view) + lambdas_); }

    VkDeviceAddress passAddress(uint32_t pass) const { return address(pass * sizeof(shader::ViewRecord)); }
    VkDeviceAddress instancesAddress() const { return address(instances_); }
    VkDeviceAddress jointsAddress() const { return address(joints_); }
    VkDeviceAddress morphWeightsAddress() const { return address(morphWeights_); }
    VkDeviceAddress drawsAddress(uint32_t view) const { return address(ofView(view)); }
    VkDeviceAddress idsAddress(uint32_t view) const { return address(ofView(view) + ids_); }
    /// 0 where nothing morphs.
    VkDeviceAddress lambdaOffsetsAddress(uint32_t view) const {
        return morphs_ ? address(ofView(view) + lambdaOffsets_) : 0;
    }
    VkDeviceAddress lambdasAddress(uint32_t view) const { return morphs_ ? address(ofView(view) + lambdas_) : 0; }
    VkBuffer handle() const { return buffer_.handle(); }
    VkDeviceSize commandsOffset(uint32_t view) const { return begin_ + ofView(view) + commands_; }

private:
    VkDeviceSize ofView(uint32_t view) const { return views_ + view * bytesPerView_; }
    VkDeviceAddress address(VkDeviceSize offset) const { return buffer_.address() + begin_ + offset; }
    template <typename T>
    T* at(VkDeviceSize offset) {
        return reinterpret_cast<T*>(buffer_.mapped().data() + begin_ + offset);
    }

    Buffer buffer_;
    VkDeviceSize instances_ = 0, joints_ = 0, morphWeights_ = 0, views_ = 0; ///< offsets in a frame's part
    VkDeviceSize commands_ = 0, ids_ = 0;                                    ///< offsets in a view's part of it
    VkDeviceSize lambdaOffsets_ = 0, lambdas_ = 0;
    VkDeviceSize bytesPerView_ = 0, bytesPerFrame_ = 0;
    VkDeviceSize begin_ = 0;
    uint32_t frames_ = 1;
    bool morphs_ = false;
};

} // namespace xgc::vulkan
