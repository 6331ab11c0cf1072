#include "visibility.h"
#include "exact_math.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace xgc::bake {

namespace {

constexpr uint32_t kRays = 16;
constexpr uint32_t kProbes = 3; ///< cells of a superfacet that look inwards

/// Directions of a cone about +z, and their weights.
struct Cone {
    std::array<glm::vec3, kRays> direction;
    std::array<float, kRays> weight;
};

Cone makeCone() {
    constexpr double kOpening = 60 * 3.141592653589793 / 180, kGoldenAngle = 2.39996;
    Cone cone;
    for (uint32_t r = 0; r < kRays; ++r) {
        const double angle = kOpening * std::sqrt((r + 0.5) / kRays), turn = kGoldenAngle * r;
        cone.direction[r] =
            glm::vec3(exact::sin(angle) * exact::cos(turn), exact::sin(angle) * exact::sin(turn), exact::cos(angle));
        cone.weight[r] = float(1 / (angle + 0.1));
    }
    return cone;
}

/// Cells by superfacet, rising.
struct Members {
    std::vector<uint32_t> offsets, cells;
    std::span<const uint32_t> of(uint32_t s) const {
        return std::span(cells).subspan(offsets[s], offsets[s + 1] - offsets[s]);
    }
};

Members membersOf(const Superfacets& superfacets) {
    Members members;
    members.offsets.assign(superfacets.count() + 1, 0);
    for (const uint32_t s : superfacets.ofCell) ++members.offsets[s + 1];
    std::partial_sum(members.offsets.begin(), members.offsets.end(), members.offsets.begin());
    members.cells.resize(superfacets.ofCell.size());
    std::vector<uint32_t> at(members.offsets.begin(), members.offsets.end() - 1);
    for (uint32_t c = 0; c < superfacets.ofCell.size(); ++c) members.cells[at[superfacets.ofCell[c]]++] = c;
    return members;
}

/// Weighted mean of the hits within a standard deviation of their median; `missed` where nothing was hit.
float depthFrom(const CellGraph& graph, uint32_t cell, const glm::vec3& normal, const Cone& cone, const RayScene& scene,
                float skin) {
    constexpr float kMissed = 0.1f;
    const glm::vec3 inwards = -normal;
    const glm::vec3 helper = std::abs(inwards.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 crossed = glm::cross(inwards, helper);
    const float length = glm::length(crossed);
    if (!(length > 0)) return kMissed;
    const glm::vec3 side = crossed / length, up = glm::cross(inwards, side);
    std::array<float, kRays> depth, weight, sorted;
    size_t hits = 0;
    for (uint32_t r = 0; r < kRays; ++r) {
        const glm::vec3& d = cone.direction[r];
        const float at = scene.nearestHit(graph.centers[cell], side * d.x + up * d.y + inwards * d.z, skin);
        if (at < 0) continue;
        depth[hits] = at;
        weight[hits++] = cone.weight[r];
    }
    if (hits == 0) return kMissed;
    std::copy_n(depth.begin(), hits, sorted.begin());
    std::sort(sorted.begin(), sorted.begin() + ptrdiff_t(hits));
    const float median = sorted[hits / 2];
    float mean = 0, square = 0;
    for (size_t i = 0; i < hits; ++i) mean += depth[i] / float(hits);
    for (size_t i = 0; i < hits; ++i) square += (depth[i] - mean) * (depth[i] - mean) / float(hits);
    const float deviation = std::sqrt(square);
    float sum = 0, weights = 0;
    for (size_t i = 0; i < hits; ++i) {
        if (std::abs(depth[i] - median) > deviation) continue;
        sum += depth[i] * weight[i];
        weights += weight[i];
    }
    return weights > 0 ? sum / weights : median;
}

/// The cell nearest to the centroid of some.
uint32_t middleOf(const CellGraph& graph, std::span<const uint32_t> cells) {
    glm::vec3 centroid(0);
    float area = 0;
    for (const uint32_t c : cells) {
        centroid += graph.centers[c] * graph.areas[c];
        area += graph.areas[c];
    }
    if (area > 0) centroid /= area;
    uint32_t best = cells[0];
    float least = 1e30f;
    for (const uint32_t c : cells) {
        const glm::vec3 d = graph.centers[c] - centroid;
        if (glm::dot(d, d) >= least) continue;
        least = glm::dot(d, d);
        best = c;
    }
    return best;
}

/// The cells in the middle of each third of a superfacet, along the axis on which it extends most: by place, so that
/// other numbers or another tessellation hardly change them.
std::array<uint32_t, kProbes> probesOf(const CellGraph& graph, std::span<const uint32_t> cells) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    float area = 0;
    for (const uint32_t c : cells) {
        low = glm::min(low, graph.centers[c]);
        high = glm::max(high, graph.centers[c]);
        area += graph.areas[c];
    }
    const glm::vec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::vector<uint32_t> along(cells.begin(), cells.end());
    std::sort(along.begin(), along.end(), [&](uint32_t a, uint32_t b) {
        const float x = graph.centers[a][axis], y = graph.centers[b][axis];
        return x != y ? x < y : a < b;
    });
    std::array<uint32_t, kProbes> probes;
    probes.fill(along.back());
    size_t first = 0;
    float before = 0;
    for (uint32_t p = 0; p < kProbes && first < along.size(); ++p) {
        const float until = area * float(p + 1) / float(kProbes);
        size_t end = first;
        do {
            before += graph.areas[along[end++]];
        } while (end < along.size() && (p + 1 == kProbes || before + 0.5f * graph.areas[along[end]] < until));
        probes[p] = middleOf(graph, std::span(along).subspan(first, end - first));
        first = end;
    }
    return probes;
}

bool isSampled(uint32_t i, uint32_t j) {
    uint32_t hash = i * 0x9e3779b1u ^ j * 0x85ebca77u;
    hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
    hash = (hash ^ hash >> 12) * 0x297a2d39u;
    return (hash >> 28) < 3; // of 16
}

} // namespace

std::vector<float> shapeDiameters(const CellGraph& graph, const Superfacets& superfacets,
                                  std::span<const glm::vec3> normals, const RayScene& scene, float skin) {
    const Cone cone = makeCone();
    const Members members = membersOf(superfacets);
    std::vector<float> diameters(superfacets.count());
    tbb::parallel_for(0u, superfacets.count(), [&](uint32_t s) {
        std::array<float, kProbes> depth;
        const std::array<uint32_t, kProbes> probes = probesOf(graph, members.of(s));
        for (uint32_t i = 0; i < kProbes; ++i)
            depth[i] = depthFrom(graph, probes[i], normals[probes[i]], cone, scene, skin);
        std::sort(depth.begin(), depth.end());
        diameters[s] = float(exact::ln(std::max(1e-4, double(depth[kProbes / 2]))));
    });
    return diameters;
}

LinesOfSight findLinesOfSight(const CellGraph& graph, const Superfacets& superfacets,
                              std::span<const glm::vec3> normals, std::span<const float> diameters,
                              const RayScene& scene) {
    constexpr float kDeepest = 0.015f, kShare = 0.4f;
    const uint32_t count = superfacets.count();
    const Members members = membersOf(superfacets);
    std::vector<glm::vec3> eye(count);
    std::vector<float> area(count, 0.0f);
    for (uint32_t s = 0; s < count; ++s) {
        const uint32_t c = middleOf(graph, members.of(s));
        eye[s] = graph.centers[c] - normals[c] * std::min(kDeepest, kShare * float(exact::exp(double(diameters[s]))));
        for (const uint32_t m : members.of(s)) area[s] += graph.areas[m];
    }
    std::vector<uint8_t> beside(size_t(count) * count, 0);
    for (const CellGraph::Link& link : graph.links) {
        const uint32_t a = superfacets.ofCell[link.a], b = superfacets.ofCell[link.b];
        beside[size_t(a) * count + b] = beside[size_t(b) * count + a] = 1;
    }
    LinesOfSight lines;
    lines.seen.assign(size_t(count) * count, 0.0f);
    lines.sampled.assign(size_t(count) * count, 0.0f);
    tbb::parallel_for(0u, count, [&](uint32_t i) {
        uint32_t occluder = 0;
        for (uint32_t j = i + 1; j < count; ++j) {
            if (!beside[size_t(i) * count + j] && !isSampled(i, j)) continue;
            const float weight = area[i] * area[j];
            const float seen = scene.isBlocked(eye[i], eye[j], occluder) ? 0 : weight;
            for (const size_t at : {size_t(i) * count + j, size_t(j) * count + i}) {
                lines.sampled[at] = weight;
                lines.seen[at] = seen;
            }
        }
    });
    return lines;
}

} // namespace xgc::bake
