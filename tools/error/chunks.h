#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace xgc::bake {

/// Squared errors of the patches as one chunk of work sees and raises them. What a chunk starts from does not depend on
/// other chunks, so neither does what it finds, whatever the threads.
class RunningErrors {
public:
    void start(const std::vector<double>& errors) {
        errors_ = &errors;
        stamps_.resize(errors.size(), 0);
        values_.resize(errors.size());
        ++stamp_;
        raised_.clear();
    }
    double of(uint32_t patch) const { return stamps_[patch] == stamp_ ? values_[patch] : (*errors_)[patch]; }
    void raise(uint32_t patch, double squared) {
        if (squared <= of(patch)) return;
        if (stamps_[patch] != stamp_) raised_.push_back(patch);
        stamps_[patch] = stamp_;
        values_[patch] = squared;
    }
    std::vector<std::pair<uint32_t, double>> raised() const {
        std::vector<std::pair<uint32_t, double>> out;
        for (const uint32_t patch : raised_) out.emplace_back(patch, values_[patch]);
        return out;
    }

private:
    const std::vector<double>* errors_ = nullptr;
    std::vector<uint64_t> stamps_;
    std::vector<double> values_;
    std::vector<uint32_t> raised_;
    uint64_t stamp_ = 0;
};

constexpr uint32_t kChunk = 4096;
inline uint32_t chunkCount(size_t count, uint32_t size = kChunk) {
    return uint32_t((count + size - 1) / size);
}

/// Calls `body(running, chunk, first, last)` for the chunks of `count` elements, in parallel, and raises the errors by
/// what they found.
template <typename Body>
void forChunks(size_t count, std::vector<double>& errors, const Body& body, uint32_t size = kChunk) {
    const uint32_t chunks = chunkCount(count, size);
    std::vector<std::vector<std::pair<uint32_t, double>>> raised(chunks);
    tbb::enumerable_thread_specific<RunningErrors> perThread;
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, chunks, 1), [&](const tbb::blocked_range<uint32_t>& range) {
        RunningErrors& running = perThread.local();
        for (uint32_t chunk = range.begin(); chunk != range.end(); ++chunk) {
            running.start(errors);
            body(running, chunk, chunk * size, uint32_t(std::min<size_t>(count, size_t(chunk + 1) * size)));
            raised[chunk] = running.raised();
        }
    });
    for (const auto& list : raised) {
        for (const auto& [patch, squared] : list) errors[patch] = std::max(errors[patch], squared);
    }
}

} // namespace xgc::bake
