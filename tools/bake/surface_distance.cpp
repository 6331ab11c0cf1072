#include "surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace xgc::bake {
namespace {

constexpr uint32_t kLeafTriangles = 4;
constexpr uint32_t kNowhere = 0xffffffffu;

double squaredBoxDistance(const glm::dvec3& p, const glm::vec3& low, const glm::vec3& high) {
    const glm::dvec3 d = glm::max(glm::max(glm::dvec3(low) - p, p - glm::dvec3(high)), glm::dvec3(0));
    return glm::dot(d, d);
}

} // namespace

SurfaceDistance::SurfaceDistance(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
    if (triangles_.empty()) return;
    std::vector<glm::vec3> centroids(triangles_.size());
    for (size_t i = 0; i < centroids.size(); ++i) {
        const Triangle& t = triangles_[i];
        centroids[i] = (t.a + t.b + t.c) / 3.0f;
    }
    std::vector<uint32_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0u);
    nodes_.reserve(triangles_.size());
    build(0, uint32_t(order.size()), centroids, order);
    std::vector<Triangle> sorted(triangles_.size());
    for (size_t i = 0; i < order.size(); ++i) sorted[i] = triangles_[order[i]];
    triangles_ = std::move(sorted);
    given_ = std::move(order);
}

// Halves the longest side of the centroids' box at the median: the depth is log2 of the count.
void SurfaceDistance::build(uint32_t first, uint32_t last, const std::vector<glm::vec3>& centroids,
                            std::vector<uint32_t>& order) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low), centerLow = low, centerHigh = high;
    for (uint32_t i = first; i < last; ++i) {
        const Triangle& t = triangles_[order[i]];
        low = glm::min(low, glm::min(t.a, glm::min(t.b, t.c)));
        high = glm::max(high, glm::max(t.a, glm::max(t.b, t.c)));
        centerLow = glm::min(centerLow, centroids[order[i]]);
        centerHigh = glm::max(centerHigh, centroids[order[i]]);
    }
    const auto index = uint32_t(nodes_.size());
    nodes_.push_back({low, high, first, last - first});
    if (last - first <= kLeafTriangles) return;
    const glm::vec3 size = centerHigh - centerLow;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const uint32_t middle = first + (last - first) / 2;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, [&](uint32_t a, uint32_t b) {
        const float x = centroids[a][axis], y = centroids[b][axis];
        return x != y ? x < y : a < b;
    });
    build(first, middle, centroids, order);
    nodes_[index].first = uint32_t(nodes_.size());
    nodes_[index].count = 0;
    build(middle, last, centroids, order);
}

template <typename Counts>
SurfaceDistance::Hit SurfaceDistance::search(const glm::dvec3& p, double enough, double most,
                                             const Counts& counts) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Hit best{most < kInfinity ? std::nextafter(most, kInfinity) : kInfinity, kNowhere};
    if (nodes_.empty()) return {kInfinity, 0};
    struct Entry {
        uint32_t node;
        double distance;
    };
    Entry stack[64];
    uint32_t depth = 0;
    stack[depth++] = {0, squaredBoxDistance(p, nodes_[0].low, nodes_[0].high)};
    while (depth > 0 && best.squared > enough) {
        const Entry entry = stack[--depth];
        if (entry.distance >= best.squared) continue;
        const Node& node = nodes_[entry.node];
        if (node.count > 0) {
            for (uint32_t i = node.first; i < node.first + node.count; ++i) {
                if (!counts(given_[i])) continue;
                const Triangle& t = triangles_[i];
                const double squared = squaredDistance(p, t.a, t.b, t.c);
                if (squared < best.squared) best = {squared, i};
            }
            continue;
        }
        Entry near{entry.node + 1, 0}, far{node.first, 0};
        near.distance = squaredBoxDistance(p, nodes_[near.node].low, nodes_[near.node].high);
        far.distance = squaredBoxDistance(p, nodes_[far.node].low, nodes_[far.node].high);
        if (far.distance < near.distance) std::swap(near, far);
        stack[depth++] = far;
        stack[depth++] = near;
    }
    if (best.triangle == kNowhere) return {kInfinity, 0};
    best.triangle = given_[best.triangle];
    return best;
}

SurfaceDistance::Hit SurfaceDistance::nearest(const glm::dvec3& p, double enough, double most) const {
    return search(p, enough, most, [](uint32_t) { return true; });
}

SurfaceDistance::Hit SurfaceDistance::nearest(const glm::dvec3& p, double enough, double most,
                                              const std::function<bool(uint32_t)>& counts) const {
    return search(p, enough, most, counts);
}

} // namespace xgc::bake
