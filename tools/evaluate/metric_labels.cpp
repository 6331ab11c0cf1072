#include <xgc/bake/segmentation_metrics.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <queue>
#include <unordered_map>

namespace xgc::bake {

namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Numbers the labels by first use.
uint32_t makeDense(std::span<const uint32_t> labels, std::vector<uint32_t>& segments) {
    std::unordered_map<uint32_t, uint32_t> numbers; // looked up, never iterated
    segments.reserve(labels.size());
    for (const uint32_t label : labels) {
        segments.push_back(numbers.try_emplace(label, uint32_t(numbers.size())).first->second);
    }
    return uint32_t(numbers.size());
}

void groupFaces(const MetricSurface& surface, uint32_t segmentCount, MetricLabels& out) {
    out.segmentOffsets.assign(segmentCount + 1, 0);
    out.segmentArea.assign(segmentCount, 0.0);
    for (uint32_t f = 0; f < surface.faceCount(); ++f) {
        ++out.segmentOffsets[out.faceSegment[f] + 1];
        out.segmentArea[out.faceSegment[f]] += surface.faceArea[f];
    }
    for (uint32_t s = 0; s < segmentCount; ++s) out.segmentOffsets[s + 1] += out.segmentOffsets[s];
    std::vector<uint32_t> next(out.segmentOffsets.begin(), out.segmentOffsets.end() - 1);
    out.segmentFaces.resize(surface.faceCount());
    for (uint32_t f = 0; f < surface.faceCount(); ++f) out.segmentFaces[next[out.faceSegment[f]]++] = f;
}

std::vector<uint32_t> findCut(const MetricSurface& surface, std::span<const uint32_t> faceSegment) {
    std::vector<uint32_t> cut;
    for (const MetricSurface::Joint& joint : surface.joints) {
        if (faceSegment[joint.faces.x] == faceSegment[joint.faces.y]) continue;
        cut.push_back(joint.positions.x);
        cut.push_back(joint.positions.y);
    }
    std::sort(cut.begin(), cut.end());
    cut.erase(std::unique(cut.begin(), cut.end()), cut.end());
    return cut;
}

/// Dijkstra's algorithm from all of the cut at once.
std::vector<double> distancesTo(const MetricSurface& surface, std::span<const uint32_t> cut) {
    using Reached = std::pair<double, uint32_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
    std::vector<double> distance(surface.positions.size(), kUnreached);
    for (const uint32_t v : cut) {
        distance[v] = 0;
        queue.emplace(0.0, v);
    }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > distance[v]) continue;
        for (uint32_t i = surface.neighborOffsets[v]; i < surface.neighborOffsets[v + 1]; ++i) {
            const MetricSurface::Neighbor& n = surface.neighbors[i];
            if (!(d + n.length < distance[n.position])) continue;
            distance[n.position] = d + n.length;
            queue.emplace(distance[n.position], n.position);
        }
    }
    return distance;
}

} // namespace

MetricLabels prepareLabels(const MetricSurface& surface, std::span<const uint32_t> labels) {
    assert(labels.size() == surface.faceCount());
    MetricLabels out;
    const uint32_t segmentCount = makeDense(labels, out.faceSegment);
    groupFaces(surface, segmentCount, out);
    out.cut = findCut(surface, out.faceSegment);
    out.cutDistance = distancesTo(surface, out.cut);
    return out;
}

} // namespace xgc::bake
