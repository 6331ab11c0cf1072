#pragma once

#include "surface.h"

#include <verify/sampled_distance.h>

namespace xgc::bench {

using bake::Deviation;
using bake::SamplePoint;
using bake::TwoSided;

std::vector<SamplePoint> samplePoints(const Surface& surface, uint32_t count);

/// bake::SampledDistance of a surface that it keeps.
class DistanceReference {
public:
    static constexpr uint32_t kSamples = 200'000; ///< each way

    explicit DistanceReference(Surface surface, uint32_t samples = kSamples);
    DistanceReference(const DistanceReference&) = delete;
    DistanceReference& operator=(const DistanceReference&) = delete;

    const Surface& surface() const { return surface_; }
    double diagonal() const { return diagonal_; } ///< of the bounds of the points in use

    TwoSided compare(const Surface& other) const;

private:
    Surface surface_;
    double diagonal_ = 0;
    bake::SampledDistance distance_;
};

} // namespace xgc::bench
