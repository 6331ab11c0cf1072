#pragma once

#include "buffer.h"
#include "staging_ring.h"

#include <xgc/vulkan/renderer.h>

#include <vector>

namespace xgc::vulkan {

/// The rows of a Residency's pool on the device: an array of each stream, by the numbers that index lists give rows. So
/// shaders draw a streamed asset as any other, and a page that comes is a copy a stream.
class StreamedRows {
public:
    /// Of RendererConfig::residency, where there is one.
    Status create(const Context& context, const RendererConfig& config);

    /// Refuses assets with streams that there is no array for.
    Status check(const AssetView& tables) const;

    /// Brings the residency up to date, and takes what came into the frame's staging.
    void update(StagingRing& staging);
    std::span<const VkBufferCopy> copies() const { return copies_; }
    VkDeviceSize bytes() const { return bytes_; } ///< that this frame copies
    const Buffer& rows() const { return rows_; }

    /// Of row 0; 0 where the asset has no such stream.
    VkDeviceAddress address(const AssetView& tables, format::StreamKind kind, uint32_t set) const;

private:
    struct Lane {
        format::StreamKind kind;
        uint32_t set;
        format::StreamFormat format;
        uint32_t stride;
        VkDeviceSize offset = 0;
    };
    const Lane* find(format::StreamKind kind, uint32_t set) const;

    Residency* residency_ = nullptr;
    std::vector<Lane> lanes_;
    Buffer rows_;
    std::vector<VkBufferCopy> copies_; ///< reserved for all that an update may install
    VkDeviceSize bytes_ = 0;
};

} // namespace xgc::vulkan
