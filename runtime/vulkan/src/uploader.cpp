#include "uploader.h"

#include <algorithm>

namespace xgc::vulkan {

void Uploader::create(uint32_t assetCapacity) {
    queue_.clear();
    next_ = 0;
    pending_.assign(assetCapacity, 0);
    copies_.clear();
    copies_.reserve(kMaxCopies);
}

void Uploader::add(const Upload& upload) {
    if (upload.source.empty()) return;
    queue_.erase(queue_.begin(), queue_.begin() + ptrdiff_t(next_));
    next_ = 0;
    queue_.push_back(upload);
    ++pending_[upload.asset];
}

void Uploader::cancel(uint32_t asset) {
    queue_.erase(queue_.begin(), queue_.begin() + ptrdiff_t(next_));
    next_ = 0;
    std::erase_if(queue_, [&](const Upload& u) { return u.asset == asset; });
    pending_[asset] = 0;
}

void Uploader::fill(StagingRing& staging, VkDeviceSize budget) {
    copies_.clear();
    bytes_ = 0;
    while (next_ < queue_.size() && bytes_ < budget && copies_.size() < kMaxCopies) {
        Upload& upload = queue_[next_];
        const VkDeviceSize bytes = std::min<VkDeviceSize>(upload.source.size(), budget - bytes_);
        VkBufferCopy copy{0, upload.target, bytes};
        const std::span<std::byte> room = staging.take(bytes, copy.srcOffset);
        std::copy_n(upload.source.data(), bytes, room.data());
        copies_.push_back(copy);
        bytes_ += bytes;
        upload.source = upload.source.subspan(size_t(bytes));
        upload.target += bytes;
        if (upload.source.empty()) {
            --pending_[upload.asset];
            ++next_;
        }
    }
}

} // namespace xgc::vulkan
