#pragma once

#include "surface.h"

#include <memory>

namespace xgc::bake {
class Nearest;
}

namespace xgc::bench {

/// Distances from samples of one surface to another one, mesh units.
struct Deviation {
    double rms = 0; ///< over the samples
    double max = 0; ///< over the samples and the vertices in use
};

struct TwoSided {
    Deviation fromReference, toReference;

    /// Root of the mean square over the samples of both ways.
    double rms() const;
    double max() const;
};

struct SamplePoint {
    glm::vec3 point;
    uint32_t triangle;
    glm::vec3 weights; ///< barycentric
};

/// `count` points spread evenly over a surface by area: the area is cut into `count` equal shares in the order of the
/// triangles, with a random point in each. Fixed seed: the same points on any machine.
std::vector<SamplePoint> samplePoints(const Surface& surface, uint32_t count);

/// A surface that others are compared with, its samples and its tree made once. Queries run in parallel (TBB).
/// Sums are in double and distances are computed in double between float coordinates, so what it cannot see is about
/// half an ulp of the coordinates: 3e-8 of their largest.
class DistanceReference {
public:
    static constexpr uint32_t kSamples = 200'000; ///< each way

    explicit DistanceReference(Surface surface, uint32_t samples = kSamples);
    ~DistanceReference();

    const Surface& surface() const { return surface_; }
    double diagonal() const { return diagonal_; } ///< of the bounds of the points in use

    TwoSided compare(const Surface& other) const;

private:
    Surface surface_;
    uint32_t sampleCount_;
    double diagonal_ = 0;
    std::vector<SamplePoint> samples_;
    std::unique_ptr<bake::Nearest> nearest_;
};

} // namespace xgc::bench
