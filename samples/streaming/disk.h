#pragma once

#include <xgc/load.h>
#include <xgc/residency.h>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <vector>

/// An engine's own I/O, as simple as it can be: a queue of requests, of which each frame reads as many bytes as a disk
/// of that speed would. A real one reads in a thread and calls Residency::complete from there.
class Disk {
public:
    explicit Disk(std::FILE* file) : file_(file) {}

    xgc::PageReader reader() {
        return {[](void* user, const xgc::PageRequest& r) { static_cast<Disk*>(user)->queue_.push_back(r); }, this};
    }
    void read(xgc::Residency& residency, uint64_t bytesPerFrame) {
        credit_ = std::min(credit_ + bytesPerFrame, 4 * bytesPerFrame);
        while (!queue_.empty() && queue_.front().storedBytes <= std::max(credit_, bytesPerFrame)) {
            const xgc::PageRequest r = queue_.front();
            queue_.pop_front();
            credit_ -= std::min(credit_, r.storedBytes);
            stored_.resize(r.storedBytes);
            const bool ok = std::fseek(file_, long(r.offset), SEEK_SET) == 0 &&
                            std::fread(stored_.data(), 1, stored_.size(), file_) == stored_.size() &&
                            xgc::decodePage(residency.view(r.asset), r.page, stored_, r.out).ok();
            residency.complete(r.ticket, ok);
        }
    }

private:
    std::FILE* file_;
    std::deque<xgc::PageRequest> queue_;
    std::vector<std::byte> stored_;
    uint64_t credit_ = 0;
};
