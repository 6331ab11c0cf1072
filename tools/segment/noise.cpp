#include "noise.h"

#include <algorithm>

namespace xgc::bake {

namespace {

double total(std::span<const double> areas) {
    double sum = 0;
    for (const double a : areas) sum += a;
    return sum;
}

} // namespace

std::array<double, 100> areaHistogram(std::span<const double> regionAreas) {
    std::array<double, 100> histogram{};
    const double sum = total(regionAreas);
    if (!(sum > 0)) return histogram;
    for (const double a : regionAreas) {
        const double percent = 100 * (a / sum);
        histogram[std::min<size_t>(99, size_t(percent))] += percent;
    }
    return histogram;
}

bool isNoisy(const std::array<double, 100>& histogram, double ratio) {
    const double largestOther = *std::max_element(histogram.begin() + 1, histogram.end());
    return histogram[0] > 0 && histogram[0] >= ratio * largestOther;
}

std::vector<glm::dvec3> smoothPositions(const Topology& topology, std::span<const glm::dvec3> positions) {
    std::vector<glm::dvec3> sum(positions.size(), glm::dvec3(0));
    std::vector<uint32_t> neighbours(positions.size(), 0);
    for (const glm::uvec2& e : topology.edges) { // sorted: the order of the sums is fixed
        sum[e.x] += positions[e.y];
        sum[e.y] += positions[e.x];
        ++neighbours[e.x];
        ++neighbours[e.y];
    }
    for (size_t v = 0; v < sum.size(); ++v) {
        sum[v] = neighbours[v] > 0 ? sum[v] / double(neighbours[v]) : positions[v];
    }
    return sum;
}

std::vector<double> regionAreas(const Mesh& mesh, const Regions& regions, std::span<const glm::dvec3> positions) {
    std::vector<double> areas(regions.count, 0.0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 c = mesh.facePositions(f);
        const glm::dvec3 p = positions[c.x];
        areas[regions.ofFace[f]] += 0.5 * glm::length(glm::cross(positions[c.y] - p, positions[c.z] - p));
    }
    return areas;
}

uint32_t equationCount(std::span<const double> regionAreas) {
    const double sum = total(regionAreas);
    if (!(sum > 0)) return 0;
    return uint32_t(
        std::count_if(regionAreas.begin(), regionAreas.end(), [&](double a) { return size_t(100 * (a / sum)) >= 1; }));
}

} // namespace xgc::bake
