#include <xgc/bake/perceptual.h>

#include "../part_order.h"
#include "all_regions.h"
#include "face_labels.h"
#include "how_many.h"
#include "part_merges.h"

#include <algorithm>
#include <cmath>

/// The perceptual segmentation:
///
///     mesh -> linked faces -> components, each by itself:
///             cells -> turns across links -> superfacets -> thickness, lines of sight -> merges -> contours
///          -> a label per face
namespace xgc::bake {

struct PerceptualSegmenter::State {
    AnalysedMesh at;
};

PerceptualSegmenter::PerceptualSegmenter(const Mesh& mesh, const Topology& topology)
    : state_(new State{AnalysedMesh(mesh, topology)}) {}
PerceptualSegmenter::~PerceptualSegmenter() = default;

Segmentation PerceptualSegmenter::parts(const PerceptualOptions& options) const {
    const AnalysedMesh& at = state_->at;
    const RegionsOfAll regions = options.partsCount > 0 ? cutToTotal(at, options.partsCount) : naturalRegions(at);
    Labels labels = label(at, regions);
    if (options.partsCount == 0 && options.detail != 1) {
        const double wanted = std::round(double(totalOf(regions)) * double(options.detail));
        const RegionsOfAll refined = refine(at, regions, uint32_t(std::clamp(wanted, 1.0, 1e6)));
        labels = options.detail < 1 ? join(labels, regions, refined) : split(at, labels, refined);
    }
    Segmentation parts =
        orderParts(at.mesh, labels.ofFace, [](uint32_t part, uint32_t) { return "part-" + std::to_string(part); });
    nameParts(at.mesh, parts);
    return parts;
}

std::vector<PartMerge> PerceptualSegmenter::merges(const Segmentation& parts) const {
    return findPartMerges(state_->at, parts);
}

std::vector<PerceptualTrace> PerceptualSegmenter::trace() const {
    constexpr size_t kMostCosts = 32;
    std::vector<PerceptualTrace> traces;
    for (const Component& component : state_->at.components) {
        PerceptualTrace trace;
        for (size_t t = 0; t < component.face.size(); ++t)
            trace.faces += t == 0 || component.face[t] != component.face[t - 1];
        trace.cells = component.cells.graph.size();
        trace.superfacets = component.superfacets.count();
        trace.noise = component.features.noise;
        trace.noisy = component.features.isNoisy();
        trace.naturalCount = naturalCount(component.merges, component.islands());
        for (size_t i = component.merges.size(); i > 0 && trace.lastCosts.size() < kMostCosts; --i) {
            trace.lastCosts.push_back(float(component.merges[i - 1].cost));
        }
        traces.push_back(std::move(trace));
    }
    return traces;
}

} // namespace xgc::bake
