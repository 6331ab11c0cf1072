#pragma once

#include "staging_ring.h"

#include <vector>

namespace xgc::vulkan {

/// Bytes on their way to the vertex arena.
struct Upload {
    uint32_t asset = 0; ///< whose they are
    std::span<const std::byte> source;
    VkDeviceSize target = 0; ///< offset in the arena
};

/// Sends uploads through staging in chunks, in order, a bounded number of bytes a frame.
class Uploader {
public:
    /// Copies of one frame; the rest waits for the next.
    static constexpr uint32_t kMaxCopies = 256;

    void create(uint32_t assetCapacity);
    void add(const Upload& upload);
    /// Forgets what is left of an asset.
    void cancel(uint32_t asset);
    /// Fills at most `budget` bytes of the frame's staging.
    void fill(StagingRing& staging, VkDeviceSize budget);
    /// True where everything of the asset was handed to a frame up to this one.
    bool done(uint32_t asset) const { return pending_[asset] == 0; }

    /// Copies of this frame, staging to arena.
    std::span<const VkBufferCopy> copies() const { return copies_; }
    /// Bytes that this frame copies.
    VkDeviceSize bytes() const { return bytes_; }

private:
    std::vector<Upload> queue_; ///< from `next_` on
    size_t next_ = 0;
    std::vector<uint32_t> pending_; ///< uploads left of each asset
    std::vector<VkBufferCopy> copies_;
    VkDeviceSize bytes_ = 0;
};

} // namespace xgc::vulkan
