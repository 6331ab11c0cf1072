#include <xgc/bake/segmentation_metrics.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace xgc::bake {

namespace {

/// What a segment of each labeling have in common.
struct Overlap {
    uint32_t a = 0, b = 0;
    uint32_t faces = 0;
    double area = 0;
};

/// All that are not empty, by segment of `a`. Areas are summed by rising face, as those of whole segments are: equal
/// labelings come out as exactly equal.
std::vector<Overlap> findOverlaps(const MetricSurface& surface, const MetricLabels& a, const MetricLabels& b) {
    std::vector<Overlap> overlaps;
    std::vector<uint32_t> slotOf(b.segmentCount(), kNone); // of the segment of a at hand
    for (uint32_t s = 0; s < a.segmentCount(); ++s) {
        const auto first = uint32_t(overlaps.size());
        for (uint32_t i = a.segmentOffsets[s]; i < a.segmentOffsets[s + 1]; ++i) {
            const uint32_t face = a.segmentFaces[i], t = b.faceSegment[face];
            if (slotOf[t] == kNone) {
                slotOf[t] = uint32_t(overlaps.size());
                overlaps.push_back({s, t});
            }
            Overlap& o = overlaps[slotOf[t]];
            ++o.faces;
            o.area += surface.faceArea[face];
        }
        for (size_t i = first; i < overlaps.size(); ++i) slotOf[overlaps[i].b] = kNone;
    }
    return overlaps;
}

uint32_t sizeOf(const MetricLabels& labels, uint32_t segment) {
    return labels.segmentOffsets[segment + 1] - labels.segmentOffsets[segment];
}

uint64_t pairsOf(uint64_t n) {
    return n > 0 ? n * (n - 1) / 2 : 0;
}

uint64_t pairsTogether(const MetricLabels& labels) {
    uint64_t pairs = 0;
    for (uint32_t s = 0; s < labels.segmentCount(); ++s) pairs += pairsOf(sizeOf(labels, s));
    return pairs;
}

double randIndexError(uint64_t faces, const MetricLabels& a, const MetricLabels& b, std::span<const Overlap> overlaps) {
    const uint64_t all = faces > 0 ? (faces - 1) / 2 * faces : 0;
    if (all == 0) return 0;
    uint64_t inBoth = 0;
    for (const Overlap& o : overlaps) inBoth += pairsOf(o.faces);
    return double(pairsTogether(a) + pairsTogether(b) - 2 * inBoth) / double(all);
}

/// Area of the segments outside the one of the other labeling that each shares most with.
double missedArea(std::span<const double> segmentArea, std::span<const double> mostShared) {
    double missed = 0;
    for (size_t s = 0; s < segmentArea.size(); ++s) missed += segmentArea[s] - mostShared[s];
    return missed;
}

double hammingDistance(double area, const MetricLabels& a, const MetricLabels& b, std::span<const Overlap> overlaps) {
    if (!(area > 0)) return 0;
    std::vector<double> bestOfA(a.segmentCount(), 0.0), bestOfB(b.segmentCount(), 0.0);
    for (const Overlap& o : overlaps) {
        bestOfA[o.a] = std::max(bestOfA[o.a], o.area);
        bestOfB[o.b] = std::max(bestOfB[o.b], o.area);
    }
    return (missedArea(a.segmentArea, bestOfA) + missedArea(b.segmentArea, bestOfB)) / (2 * area);
}

void measureConsistency(uint32_t faces, const MetricLabels& a, const MetricLabels& b, std::span<const Overlap> overlaps,
                        SegmentationErrors& errors) {
    if (a.segmentCount() < 2 || b.segmentCount() < 2) return;
    double ofA = 0, ofB = 0, ofSmaller = 0;
    for (const Overlap& o : overlaps) {
        const uint32_t sizeA = sizeOf(a, o.a), sizeB = sizeOf(b, o.b);
        const double outsideA = double(sizeA - o.faces) / sizeA, outsideB = double(sizeB - o.faces) / sizeB;
        ofA += outsideA * o.faces;
        ofB += outsideB * o.faces;
        ofSmaller += std::min(outsideA, outsideB) * o.faces;
    }
    errors.globalConsistency = std::min(ofA, ofB) / faces;
    errors.localConsistency = ofSmaller / faces;
}

double straightDistance(const MetricSurface& surface, uint32_t position, std::span<const uint32_t> cut) {
    const glm::dvec3 p(surface.positions[position]);
    double nearest = glm::length(glm::dvec3(surface.positions[cut.front()]) - p);
    for (const uint32_t v : cut) nearest = std::min(nearest, glm::length(glm::dvec3(surface.positions[v]) - p));
    return nearest;
}

/// Summed over the cut of `from`.
double distanceBetweenCuts(const MetricSurface& surface, const MetricLabels& from, const MetricLabels& to) {
    double sum = 0;
    for (const uint32_t v : from.cut) {
        const double along = to.cutDistance[v];
        sum += std::isfinite(along) ? along : straightDistance(surface, v, to.cut);
    }
    return sum;
}

std::optional<double> cutDiscrepancy(const MetricSurface& surface, const MetricLabels& a, const MetricLabels& b) {
    if (a.cut.empty() || b.cut.empty() || !(surface.averageRadius > 0)) return std::nullopt;
    const double sum = distanceBetweenCuts(surface, a, b) + distanceBetweenCuts(surface, b, a);
    return sum / double(a.cut.size() + b.cut.size()) / surface.averageRadius;
}

} // namespace

SegmentationErrors compareLabels(const MetricSurface& surface, const MetricLabels& a, const MetricLabels& b) {
    assert(a.faceSegment.size() == surface.faceCount() && b.faceSegment.size() == surface.faceCount());
    const std::vector<Overlap> overlaps = findOverlaps(surface, a, b);
    SegmentationErrors errors;
    errors.randIndex = randIndexError(surface.faceCount(), a, b, overlaps);
    errors.cutDiscrepancy = cutDiscrepancy(surface, a, b);
    errors.hamming = hammingDistance(surface.area, a, b, overlaps);
    measureConsistency(surface.faceCount(), a, b, overlaps, errors);
    return errors;
}

} // namespace xgc::bake
