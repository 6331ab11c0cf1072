#include "verify/sampled_distance.h"

#include "verify/nearest.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace xgc::bake {
namespace {

glm::dvec3 at(const SurfaceView& s, uint32_t row) {
    return s.points[row];
}

double areaOf(const SurfaceView& s, const glm::uvec3& t) {
    return glm::length(glm::cross(at(s, t.y) - at(s, t.x), at(s, t.z) - at(s, t.x))) / 2;
}

/// In [0, 1), from the generator's own bits: the standard's distributions differ between libraries.
double unit(std::mt19937_64& random) {
    return double(random() >> 11) * 0x1p-53;
}

std::vector<glm::vec3> pointsInUse(const SurfaceView& s) {
    std::vector<uint8_t> used(s.points.size());
    for (const glm::uvec3& t : s.triangles) used[t.x] = used[t.y] = used[t.z] = 1;
    std::vector<glm::vec3> points;
    for (size_t v = 0; v < used.size(); ++v) {
        if (used[v]) points.push_back(s.points[v]);
    }
    return points;
}

std::vector<double> distances(size_t count, const Nearest& to, auto&& point) {
    std::vector<double> d(count);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 1024), [&](const tbb::blocked_range<size_t>& range) {
        for (size_t i = range.begin(); i != range.end(); ++i) d[i] = to.distance(point(i));
    });
    return d;
}

Deviation deviationOf(const SurfaceView& s, std::span<const SamplePoint> samples, const Nearest& to) {
    Deviation deviation;
    const std::vector<double> d = distances(samples.size(), to, [&](size_t i) { return samples[i].point; });
    for (const double x : d) {
        deviation.rms += x * x / double(d.size());
        deviation.max = std::max(deviation.max, x);
    }
    deviation.rms = std::sqrt(deviation.rms);
    const std::vector<glm::vec3> vertices = pointsInUse(s);
    for (const double x : distances(vertices.size(), to, [&](size_t i) { return vertices[i]; }))
        deviation.max = std::max(deviation.max, x);
    return deviation;
}

template <typename T>
std::vector<T> copy(std::span<const T> values) {
    return {values.begin(), values.end()};
}

} // namespace

double TwoSided::rms() const {
    return std::sqrt((fromReference.rms * fromReference.rms + toReference.rms * toReference.rms) / 2);
}

double TwoSided::max() const {
    return std::max(fromReference.max, toReference.max);
}

std::vector<SamplePoint> samplePoints(const SurfaceView& s, uint32_t count) {
    std::vector<double> sums{0}; // of areas
    for (const glm::uvec3& t : s.triangles) sums.push_back(sums.back() + areaOf(s, t));
    std::mt19937_64 random(1);
    std::vector<SamplePoint> samples;
    if (sums.back() <= 0) return samples;
    samples.reserve(count);
    uint32_t triangle = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const double area = (i + unit(random)) / count * sums.back();
        while (triangle + 2 < sums.size() && sums[triangle + 1] <= area) ++triangle;
        const double root = std::sqrt(unit(random)), v = unit(random);
        const glm::dvec3 weights(1 - root, root * (1 - v), root * v);
        const glm::uvec3& t = s.triangles[triangle];
        const glm::dvec3 point = weights.x * at(s, t.x) + weights.y * at(s, t.y) + weights.z * at(s, t.z);
        samples.push_back({glm::vec3(point), triangle, glm::vec3(weights)});
    }
    return samples;
}

SampledDistance::SampledDistance(const SurfaceView& reference, uint32_t samples)
    : reference_(reference), sampleCount_(samples), samples_(samplePoints(reference, samples)),
      nearest_(std::make_unique<Nearest>(copy(reference.points), copy(reference.triangles))) {}

SampledDistance::~SampledDistance() = default;

TwoSided SampledDistance::compare(const SurfaceView& other) const {
    const Nearest nearest(copy(other.points), copy(other.triangles));
    return {deviationOf(reference_, samples_, nearest),
            deviationOf(other, samplePoints(other, sampleCount_), *nearest_)};
}

} // namespace xgc::bake
