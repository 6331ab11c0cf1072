#include "changed_surface.h"

#include "sampled_distance.h"

#include <segment/perceptual/nearest_position.h>

#include <glm/gtc/quaternion.hpp>
#include <meshoptimizer.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace xgc::bench {
namespace {

ChangedSurface copyOf(const Surface& original) {
    ChangedSurface changed{{original.points, {}, {}, original.triangles}, {}};
    changed.from.resize(original.triangles.size());
    std::iota(changed.from.begin(), changed.from.end(), 0u);
    return changed;
}

double diagonalOf(const Surface& s) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& p : s.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return glm::distance(glm::dvec3(low), glm::dvec3(high));
}

/// 0 to 1. Not std::uniform_real_distribution, which differs between libraries.
double draw(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}

/// About normal: of mean 0 and variance 1.
double drawDeviate(std::mt19937& random) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += draw(random);
    return sum;
}

void shuffle(std::vector<uint32_t>& order, std::mt19937& random) {
    for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
}

/// The nearest triangle of `original` to each triangle's centroid, as close as samples of it tell.
std::vector<uint32_t> nearestTriangles(const Surface& original, const Surface& surface) {
    const std::vector<SamplePoint> samples = samplePoints(original, 10 * original.faceCount());
    std::vector<glm::vec3> points;
    for (const SamplePoint& s : samples) points.push_back(s.point);
    std::vector<uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    const bake::NearestPosition nearest(points, std::move(all));
    std::vector<uint32_t> triangles;
    for (const glm::uvec3& t : surface.triangles) {
        const glm::vec3 centroid = (surface.points[t.x] + surface.points[t.y] + surface.points[t.z]) / 3.0f;
        triangles.push_back(samples[nearest.of(centroid)].triangle);
    }
    return triangles;
}

ChangedSurface splitOnce(const ChangedSurface& before) {
    ChangedSurface after;
    for (size_t i = 0; i < before.surface.triangles.size(); ++i) {
        const glm::uvec3& t = before.surface.triangles[i];
        const glm::vec3 p = before.surface.points[t.x], q = before.surface.points[t.y], r = before.surface.points[t.z];
        const auto base = uint32_t(after.surface.points.size());
        for (const glm::vec3& corner : {p, q, r, (p + q) * 0.5f, (q + r) * 0.5f, (r + p) * 0.5f})
            after.surface.points.push_back(corner);
        for (const glm::uvec3& child : {glm::uvec3(0, 3, 5), {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
            after.surface.triangles.push_back(child + base);
            after.from.push_back(before.from[i]);
        }
    }
    return after;
}

} // namespace

ChangedSurface scaled(const Surface& original, float factor) {
    ChangedSurface changed = copyOf(original);
    for (glm::vec3& p : changed.surface.points) p *= factor;
    return changed;
}

ChangedSurface movedAndScaled(const Surface& original) {
    constexpr float kFactor = 3.7f;
    ChangedSurface changed = scaled(original, kFactor);
    const glm::vec3 offset = glm::vec3(1.3f, -2.1f, 0.7f) * float(diagonalOf(original));
    for (glm::vec3& p : changed.surface.points) p += offset;
    return changed;
}

ChangedSurface rotatedAndShuffled(const Surface& original, uint32_t seed) {
    std::mt19937 random(seed);
    glm::dvec4 q;
    for (int k = 0; k < 4; ++k) q[k] = drawDeviate(random);
    const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::dquat(q.w, q.x, q.y, q.z)));
    std::vector<uint32_t> points(original.points.size()), place(original.points.size());
    std::iota(points.begin(), points.end(), 0u);
    shuffle(points, random);
    ChangedSurface changed;
    for (uint32_t i = 0; i < points.size(); ++i) {
        place[points[i]] = i;
        changed.surface.points.emplace_back(rotation * glm::dvec3(original.points[points[i]]));
    }
    changed.from.resize(original.triangles.size());
    std::iota(changed.from.begin(), changed.from.end(), 0u);
    shuffle(changed.from, random);
    for (const uint32_t f : changed.from) {
        const glm::uvec3& t = original.triangles[f];
        changed.surface.triangles.emplace_back(place[t.x], place[t.y], place[t.z]);
    }
    return changed;
}

ChangedSurface decimated(const Surface& original, double share) {
    constexpr float kNoLimit = 1e10f;
    ChangedSurface changed{{original.points, {}, {}, original.triangles}, {}};
    const auto wanted = size_t(share * double(original.triangles.size()));
    const size_t indices = meshopt_simplify(
        &changed.surface.triangles[0].x, &original.triangles[0].x, 3 * original.triangles.size(), &original.points[0].x,
        original.points.size(), sizeof(glm::vec3), 3 * wanted, kNoLimit, 0, nullptr);
    changed.surface.triangles.resize(indices / 3);
    changed.from = nearestTriangles(original, changed.surface);
    return changed;
}

ChangedSurface subdivided(const Surface& original, int rounds) {
    ChangedSurface changed = copyOf(original);
    for (int i = 0; i < rounds; ++i) changed = splitOnce(changed);
    return changed;
}

ChangedSurface noisy(const Surface& original, double share, uint32_t seed) {
    ChangedSurface changed = copyOf(original);
    const double by = share * diagonalOf(original);
    std::mt19937 random(seed);
    for (glm::vec3& p : changed.surface.points) {
        for (int k = 0; k < 3; ++k) p[k] += float(by * drawDeviate(random));
    }
    return changed;
}

} // namespace xgc::bench
