#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace xgc::bake {

class Nearest;

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

/// Triangles over points, which must outlive it.
struct SurfaceView {
    std::span<const glm::vec3> points;
    std::span<const glm::uvec3> triangles;
};

/// `count` points spread evenly over a surface by area: the area is cut into `count` equal shares in the order of the
/// triangles, with a random point in each. Fixed seed: the same points on any machine. None where there is no area.
std::vector<SamplePoint> samplePoints(const SurfaceView& surface, uint32_t count);

/// A surface that others are compared with, its samples and its tree made once. Queries run in parallel (TBB).
/// Sums are in double and distances are computed in double between float coordinates, so what it cannot see is about
/// half an ulp of the coordinates: 3e-8 of their largest.
class SampledDistance {
public:
    SampledDistance(const SurfaceView& reference, uint32_t samples);
    ~SampledDistance();

    /// Infinite where `other` has no triangle.
    TwoSided compare(const SurfaceView& other) const;

private:
    SurfaceView reference_;
    uint32_t sampleCount_;
    std::vector<SamplePoint> samples_;
    std::unique_ptr<Nearest> nearest_;
};

} // namespace xgc::bake
