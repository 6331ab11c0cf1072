#include "merge.h"
#include "noise.h"
#include "part_order.h"

#include <algorithm>

/// The contour-based segmentation of the thesis (chapter 3, figure 3.4):
///
///     edges by convexity -> regions filled between concave edges -> noisy? smooth, and again -> merge to n parts
///                     ^                                                       |
///                     +-------------------------------------------------------+
namespace xgc::bake {

namespace {

/// One pass of classification and filling, with what the noise test sees of it.
struct Pass {
    std::vector<EdgeKind> kinds;
    Regions regions;
    std::array<double, 100> histogram{};
    bool noisy = false;
};

class ThesisSegmenter {
public:
    ThesisSegmenter(const Mesh& mesh, const Topology& topology, const ThesisSegmentOptions& options)
        : mesh_(mesh), topology_(topology), options_(options), orientation_(orientConsistently(mesh, topology)),
          original_(mesh.positions.begin(), mesh.positions.end()) {}

    Segmentation run(ThesisSegmentTrace& trace) {
        Pass pass = segmentAt(original_);
        traceFirst(pass, trace);
        smoothWhileNoisy(pass, trace);
        trace.filledRegions = pass.regions.ofFace;
        trace.filledCount = pass.regions.count;
        trace.histogram = pass.histogram;
        trace.noisyAfterSmoothing = pass.noisy;

        std::vector<double> areas = regionAreas(mesh_, pass.regions, original_);
        trace.equationCount = equationCount(areas);
        const auto name = [](uint32_t part, uint32_t) { return "part-" + std::to_string(part); };
        if (!options_.merge) return orderParts(mesh_, pass.regions.ofFace, name);
        const uint32_t wanted = options_.partsCount > 0 ? options_.partsCount : std::max(2u, trace.equationCount);
        return orderParts(mesh_, mergeRegions(mesh_, topology_, pass.regions, std::move(areas), wanted), name);
    }

private:
    Pass segmentAt(std::span<const glm::dvec3> positions) const {
        Pass pass;
        pass.kinds = classifyEdges(mesh_, topology_, orientation_, positions, double(options_.flatTolerance));
        pass.regions = fillRegions(topology_, pass.kinds, options_.seedFromConvexEdges);
        pass.histogram = areaHistogram(regionAreas(mesh_, pass.regions, positions));
        pass.noisy = isNoisy(pass.histogram, double(options_.noiseRatio));
        return pass;
    }

    void traceFirst(const Pass& pass, ThesisSegmentTrace& trace) const {
        trace.edgeKinds = pass.kinds;
        trace.firstHistogram = pass.histogram;
        trace.noisy = pass.noisy;
        for (uint32_t f = 0; f < mesh_.faceCount(); ++f) {
            ++trace.triangleTypes[triangleType(countEdges(topology_, pass.kinds, f))];
        }
    }

    void smoothWhileNoisy(Pass& pass, ThesisSegmentTrace& trace) const {
        std::vector<glm::dvec3> positions = original_;
        while (pass.noisy && trace.smoothingRounds < options_.smoothingRounds) {
            positions = smoothPositions(topology_, positions);
            pass = segmentAt(positions);
            ++trace.smoothingRounds;
        }
    }

    const Mesh& mesh_;
    const Topology& topology_;
    const ThesisSegmentOptions& options_;
    Orientation orientation_;
    std::vector<glm::dvec3> original_;
};

} // namespace

Segmentation segmentThesis(const Mesh& mesh, const Topology& topology, const ThesisSegmentOptions& options,
                           ThesisSegmentTrace* trace) {
    ThesisSegmentTrace own;
    ThesisSegmentTrace& seen = trace ? *trace : own;
    seen = {};
    return ThesisSegmenter(mesh, topology, options).run(seen);
}

} // namespace xgc::bake
