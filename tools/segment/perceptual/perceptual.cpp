#include <xgc/bake/perceptual.h>

#include "../part_order.h"
#include "component.h"
#include "contour_polish.h"
#include "how_many.h"
#include "loose_faces.h"
#include "nearest_position.h"

#include <algorithm>
#include <cmath>
#include <numeric>

/// The perceptual segmentation:
///
///     mesh -> linked faces -> components, each by itself:
///             cells -> turns across links -> superfacets -> thickness, lines of sight -> merges -> contours
namespace xgc::bake {

namespace {

/// Components below this share of the area are no parts of their own.
constexpr double kTinyShare = 0.002;

/// Labels of faces, put together component by component.
struct Labels {
    std::vector<uint32_t> ofFace; ///< kNone: not yet
    uint32_t count = 0;
};

/// Regions of every analysed component.
using RegionsOfAll = std::vector<CellRegions>;

} // namespace

struct PerceptualSegmenter::State {
    const Mesh& mesh;
    const Topology& topology;
    LinkedFaces linked;
    std::vector<Component> components; ///< those that are not tiny
    std::vector<uint32_t> analysed;    ///< of linked: these
    std::vector<uint32_t> tiny;        ///< of linked

    State(const Mesh& m, const Topology& t) : mesh(m), topology(t), linked(linkFaces(m, t)) { analyse(); }

    std::span<const uint32_t> facesOf(uint32_t component) const {
        const uint32_t begin = linked.componentOffsets[component];
        return std::span(linked.componentFaces).subspan(begin, linked.componentOffsets[component + 1] - begin);
    }

    void analyse();
    RegionsOfAll cutAll(std::span<const uint32_t> counts) const;
    RegionsOfAll cutToTotal(uint32_t wanted) const;
    RegionsOfAll naturalRegions() const;
    RegionsOfAll refine(const RegionsOfAll& regions, uint32_t wanted) const;
    Labels label(const RegionsOfAll& regions) const;
    Labels join(const Labels& labels, const RegionsOfAll& regions, const RegionsOfAll& unions) const;
    Labels split(const Labels& labels, const RegionsOfAll& finer) const;
    void placeTiny(Labels& labels) const;
    uint32_t labelAround(uint32_t component, const Labels& labels) const;
    void placeByNearness(Labels& labels) const;
    CellRegions regionsOf(const Component& component, const Segmentation& parts) const;
};

void PerceptualSegmenter::State::analyse() {
    const std::vector<double> areas = faceAreas(mesh);
    std::vector<double> componentArea(linked.componentCount(), 0.0);
    double total = 0;
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        for (const uint32_t f : facesOf(c)) componentArea[c] += areas[f];
        total += componentArea[c];
    }
    PieceScratch scratch = {std::vector<uint32_t>(mesh.positions.size(), kNone),
                            std::vector<uint32_t>(mesh.faces.size(), kNone)};
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        const double share = total > 0 ? componentArea[c] / total : 0;
        if (share >= kTinyShare) {
            Piece piece = extractPiece(mesh, linked, facesOf(c), areas, componentArea[c], scratch);
            components.push_back(analyseComponent(std::move(piece), share));
            analysed.push_back(c);
        } else {
            tiny.push_back(c);
        }
    }
}

RegionsOfAll PerceptualSegmenter::State::cutAll(std::span<const uint32_t> counts) const {
    RegionsOfAll regions;
    for (size_t c = 0; c < components.size(); ++c) regions.push_back(cutInto(components[c], counts[c]));
    return regions;
}

RegionsOfAll PerceptualSegmenter::State::naturalRegions() const {
    std::vector<uint32_t> counts;
    for (const Component& component : components) {
        counts.push_back(naturalCount(component.merges, component.islands()));
    }
    return cutAll(counts);
}

namespace {

uint32_t totalOf(const RegionsOfAll& regions) {
    uint32_t total = 0;
    for (const CellRegions& r : regions) total += r.count;
    return total;
}

} // namespace

/// Smoothing contours may join or part regions: the cut is moved until the total is right, or left unsmoothed.
RegionsOfAll PerceptualSegmenter::State::cutToTotal(uint32_t wanted) const {
    constexpr int kTries = 12;
    std::vector<std::span<const Merge>> merges;
    std::vector<uint32_t> islands;
    for (const Component& component : components) {
        merges.push_back(component.merges);
        islands.push_back(component.islands());
    }
    int64_t aim = wanted;
    for (int i = 0; i < kTries && aim > 0; ++i) {
        RegionsOfAll regions = cutAll(countsFor(uint32_t(aim), merges, islands));
        const uint32_t total = totalOf(regions);
        if (total == wanted) return regions;
        aim += int64_t(wanted) - int64_t(total);
    }
    const std::vector<uint32_t> counts = countsFor(wanted, merges, islands);
    RegionsOfAll regions;
    for (size_t c = 0; c < components.size(); ++c) regions.push_back(cutExactly(components[c], counts[c]));
    return regions;
}

/// Unions of regions, or regions within them: about `wanted` in all.
RegionsOfAll PerceptualSegmenter::State::refine(const RegionsOfAll& regions, uint32_t wanted) const {
    const bool isFiner = wanted > totalOf(regions);
    std::vector<FirstRegions> first(components.size());
    std::vector<std::vector<Merge>> all(components.size());
    std::vector<std::span<const Merge>> merges;
    std::vector<uint32_t> least;
    for (size_t c = 0; c < components.size(); ++c) {
        all[c] = mergesOf(components[c], regions[c], first[c]);
        const size_t within = first[c].count() - regions[c].count; // merges that do not leave a region
        merges.push_back(isFiner ? std::span(all[c]).first(within) : std::span(all[c]).subspan(within));
        least.push_back(isFiner ? regions[c].count : first[c].count() - uint32_t(all[c].size()));
    }
    const std::vector<uint32_t> counts = countsFor(wanted, merges, least);
    RegionsOfAll refined;
    for (size_t c = 0; c < components.size(); ++c) {
        const std::vector<uint32_t> region = regionsAt(all[c], first[c].count(), counts[c]);
        CellRegions cut;
        for (const uint32_t r : first[c].ofCell) cut.ofCell.push_back(region[r]);
        cut.count = counts[c];
        if (isFiner) smoothContours(components[c].cells.graph, components[c].features, regions[c].ofCell, cut);
        refined.push_back(std::move(cut));
    }
    return refined;
}

namespace {

/// Labels the faces of a component: one that was split takes the region that holds most of its area, of those that
/// `isWanted` (face, cell). Where there are none it stays as it is.
template <class IsWanted>
void labelFaces(const Component& component, const CellRegions& regions, const IsWanted& isWanted, Labels& labels) {
    const std::vector<uint32_t>& cell = component.cells.ofTriangle;
    std::vector<float> area(regions.count, 0.0f);
    for (size_t begin = 0, end = 0; begin < cell.size(); begin = end) {
        const uint32_t face = component.face[begin];
        uint32_t best = kNone;
        for (; end < cell.size() && component.face[end] == face; ++end) {
            const uint32_t r = regions.ofCell[cell[end]];
            area[r] += component.cells.graph.areas[cell[end]];
            if (isWanted(face, cell[end]) && (best == kNone || area[r] > area[best])) best = r;
        }
        for (size_t i = begin; i < end; ++i) area[regions.ofCell[cell[i]]] = 0;
        if (best != kNone) labels.ofFace[face] = labels.count + best;
    }
    labels.count += regions.count;
}

bool isAnyCell(uint32_t, uint32_t) {
    return true;
}

} // namespace

Labels PerceptualSegmenter::State::label(const RegionsOfAll& regions) const {
    Labels labels = {std::vector<uint32_t>(mesh.faces.size(), kNone), 0};
    std::vector<uint32_t> scratch(mesh.faces.size(), kNone);
    for (size_t c = 0; c < components.size(); ++c) {
        labelFaces(components[c], regions[c], isAnyCell, labels);
        if (components[c].wasSplit) joinLooseFaces(linked, facesOf(analysed[c]), {}, scratch, labels.ofFace);
        if (components[c].wasJoined()) polishContours(mesh, linked, components[c], scratch, labels.ofFace);
    }
    placeTiny(labels);
    return labels;
}

/// Unions of labelled parts, as the regions that they come from are joined.
Labels PerceptualSegmenter::State::join(const Labels& labels, const RegionsOfAll& regions,
                                        const RegionsOfAll& unions) const {
    Labels joined = {{}, 0};
    std::vector<uint32_t> number;
    for (size_t c = 0; c < components.size(); ++c) {
        const size_t first = number.size();
        number.resize(first + regions[c].count);
        for (size_t i = 0; i < regions[c].ofCell.size(); ++i) {
            number[first + regions[c].ofCell[i]] = joined.count + unions[c].ofCell[i];
        }
        joined.count += unions[c].count;
    }
    for (const uint32_t label : labels.ofFace) joined.ofFace.push_back(label < number.size() ? number[label] : 0);
    joined.count = std::max(joined.count, 1u);
    return joined;
}

/// Labelled parts split by finer regions. Faces that came to a part otherwise take a neighbour's label in it, or the
/// part's first.
Labels PerceptualSegmenter::State::split(const Labels& labels, const RegionsOfAll& finer) const {
    Labels fine = {std::vector<uint32_t>(mesh.faces.size(), kNone), 0};
    std::vector<uint32_t> home(labels.count, kNone); // first fine label
    for (size_t c = 0; c < components.size(); ++c) {
        std::vector<uint32_t> regionHome(finer[c].count, kNone); // the part that holds most of a region's faces first
        const Component& component = components[c];
        for (size_t t = 0; t < component.face.size(); ++t) {
            uint32_t& at = regionHome[finer[c].ofCell[component.cells.ofTriangle[t]]];
            if (at == kNone) at = labels.ofFace[component.face[t]];
        }
        const auto isAtHome = [&](uint32_t face, uint32_t cell) {
            return regionHome[finer[c].ofCell[cell]] == labels.ofFace[face];
        };
        labelFaces(component, finer[c], isAtHome, fine);
    }
    std::vector<uint32_t> rest;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (fine.ofFace[f] == kNone) continue;
        rest.push_back(f);
        if (home[labels.ofFace[f]] == kNone) home[labels.ofFace[f]] = fine.ofFace[f];
    }
    for (size_t i = 0; i < rest.size(); ++i) { // outwards from what has a label
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = linked.neighbours[rest[i]][k];
            if (g == kNone || fine.ofFace[g] != kNone || labels.ofFace[g] != labels.ofFace[rest[i]]) continue;
            fine.ofFace[g] = fine.ofFace[rest[i]];
            rest.push_back(g);
        }
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (fine.ofFace[f] != kNone) continue;
        uint32_t& first = home[labels.ofFace[f]];
        if (first == kNone) first = fine.count++;
        fine.ofFace[f] = first;
    }
    std::vector<uint32_t> scratch(mesh.faces.size(), kNone);
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        joinLooseFaces(linked, facesOf(c), labels.ofFace, scratch, fine.ofFace);
    }
    return fine;
}

/// The label that most corners of a component lie on, or kNone.
uint32_t PerceptualSegmenter::State::labelAround(uint32_t component, const Labels& labels) const {
    std::vector<uint32_t> seen;
    for (const uint32_t f : facesOf(component)) {
        for (int k = 0; k < 3; ++k) {
            for (const uint32_t g : topology.facesOfVertex(linked.corners[f][k])) {
                const uint32_t label = labels.ofFace[linked.standsFor[g]];
                if (label != kNone) seen.push_back(label);
            }
        }
    }
    std::sort(seen.begin(), seen.end());
    uint32_t best = kNone;
    size_t most = 0;
    for (size_t i = 0, j = 0; i < seen.size(); i = j) {
        while (j < seen.size() && seen[j] == seen[i]) ++j;
        if (j - i <= most) continue;
        most = j - i;
        best = seen[i];
    }
    return best;
}

/// Tiny components take the label that they touch, a few rounds of it, then that of the nearest position.
void PerceptualSegmenter::State::placeTiny(Labels& labels) const {
    constexpr int kRounds = 4;
    std::vector<uint32_t> rest = tiny;
    for (int round = 0; round < kRounds && !rest.empty(); ++round) {
        std::erase_if(rest, [&](uint32_t c) {
            const uint32_t label = labelAround(c, labels);
            for (const uint32_t f : facesOf(c)) labels.ofFace[f] = label;
            return label != kNone;
        });
    }
    if (!rest.empty()) placeByNearness(labels);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) labels.ofFace[f] = labels.ofFace[linked.standsFor[f]];
}

void PerceptualSegmenter::State::placeByNearness(Labels& labels) const {
    std::vector<uint32_t> labelAt(mesh.positions.size(), kNone), labelled;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (labels.ofFace[f] == kNone) continue;
        for (int k = 0; k < 3; ++k) {
            const uint32_t p = linked.corners[f][k];
            if (labelAt[p] == kNone) labelled.push_back(p);
            labelAt[p] = std::min(labelAt[p], labels.ofFace[f]);
        }
    }
    const bool none = labelled.empty(); // nothing but crumbs: one part
    const NearestPosition nearest(mesh.positions, std::move(labelled));
    for (const uint32_t c : tiny) {
        const std::span<const uint32_t> faces = facesOf(c);
        if (labels.ofFace[faces[0]] != kNone) continue;
        glm::vec3 center(0);
        for (const uint32_t f : faces) center += mesh.positions[linked.corners[f].x] / float(faces.size());
        const uint32_t label = none ? 0 : labelAt[nearest.of(center)];
        for (const uint32_t f : faces) labels.ofFace[f] = label;
    }
    labels.count = std::max(labels.count, 1u);
}

/// The part that holds most of each cell. Of cells that parts share, some parts may hold none.
CellRegions PerceptualSegmenter::State::regionsOf(const Component& component, const Segmentation& parts) const {
    const std::vector<uint32_t>& cell = component.cells.ofTriangle;
    CellRegions regions = {std::vector<uint32_t>(component.cells.graph.size(), kNone), parts.partCount()};
    std::vector<std::pair<uint32_t, uint32_t>> members; // cell, part
    members.reserve(cell.size());
    for (size_t t = 0; t < cell.size(); ++t) members.emplace_back(cell[t], parts.facePart[component.face[t]]);
    std::sort(members.begin(), members.end());
    for (size_t i = 0, j = 0; i < members.size();) {
        uint32_t most = 0;
        const uint32_t c = members[i].first;
        for (; i < members.size() && members[i].first == c; i = j) {
            while (j < members.size() && members[j] == members[i]) ++j;
            if (uint32_t(j - i) <= most) continue;
            most = uint32_t(j - i);
            regions.ofCell[c] = members[i].second;
        }
    }
    return regions;
}

namespace {

/// Parts that have joined; a set goes by its lowest.
class JoinedParts {
public:
    explicit JoinedParts(uint32_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    uint32_t find(uint32_t p) const {
        while (parent_[p] != p) p = parent_[p];
        return p;
    }
    void join(uint32_t p, uint32_t q, double cost, std::vector<PartMerge>& merges) {
        p = find(p);
        q = find(q);
        if (p == q) return;
        parent_[std::max(p, q)] = std::min(p, q);
        merges.push_back({std::min(p, q), std::max(p, q), float(cost)});
    }

private:
    std::vector<uint32_t> parent_;
};

/// Per part: the one it shares most border with, or kNone.
std::vector<uint32_t> closestNeighbours(const Mesh& mesh, const Topology& topology, const Segmentation& parts) {
    struct Border {
        uint32_t part, other;
        double length;
    };
    std::vector<Border> borders;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        for (size_t i = 1; i < faces.size(); ++i) {
            const uint32_t p = parts.facePart[faces[0]], q = parts.facePart[faces[i]];
            if (p == q) continue;
            const double length =
                double(glm::distance(mesh.positions[topology.edges[e].x], mesh.positions[topology.edges[e].y]));
            borders.push_back({p, q, length});
            borders.push_back({q, p, length});
        }
    }
    std::stable_sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
        return a.part != b.part ? a.part < b.part : a.other < b.other;
    });
    std::vector<uint32_t> closest(parts.partCount(), kNone);
    std::vector<double> most(parts.partCount(), -1.0);
    for (size_t i = 0, j = 0; i < borders.size(); i = j) {
        double sum = 0;
        for (; j < borders.size() && borders[j].part == borders[i].part && borders[j].other == borders[i].other; ++j)
            sum += borders[j].length;
        if (sum <= most[borders[i].part]) continue;
        most[borders[i].part] = sum;
        closest[borders[i].part] = borders[i].other;
    }
    return closest;
}

} // namespace

PerceptualSegmenter::PerceptualSegmenter(const Mesh& mesh, const Topology& topology)
    : state_(std::make_unique<State>(mesh, topology)) {}
PerceptualSegmenter::~PerceptualSegmenter() = default;

Segmentation PerceptualSegmenter::parts(const PerceptualOptions& options) const {
    const State& s = *state_;
    const RegionsOfAll regions = options.partsCount > 0 ? s.cutToTotal(options.partsCount) : s.naturalRegions();
    Labels labels = s.label(regions);
    if (options.partsCount == 0 && options.detail != 1) {
        const double wanted = std::round(double(totalOf(regions)) * double(options.detail));
        const RegionsOfAll refined = s.refine(regions, uint32_t(std::clamp(wanted, 1.0, 1e6)));
        labels = options.detail < 1 ? s.join(labels, regions, refined) : s.split(labels, refined);
    }
    return orderParts(s.mesh, labels.ofFace, [](uint32_t part, uint32_t) { return "part-" + std::to_string(part); });
}

std::vector<PartMerge> PerceptualSegmenter::merges(const Segmentation& parts) const {
    struct Step {
        double dearest; ///< cost of this or an earlier merge of the component
        uint32_t component, order;
        uint32_t p, q;
        double cost;
    };
    std::vector<Step> steps;
    std::vector<uint8_t> hasCells(parts.partCount(), 0);
    for (uint32_t c = 0; c < state_->components.size(); ++c) {
        FirstRegions first;
        const CellRegions regions = state_->regionsOf(state_->components[c], parts);
        const std::vector<Merge> merges = mergesOf(state_->components[c], regions, first);
        for (const uint32_t part : first.group) hasCells[part] = 1;
        double dearest = 0;
        for (uint32_t i = 0; i < merges.size(); ++i) {
            const uint32_t p = first.group[merges[i].a], q = first.group[merges[i].b];
            if (p == q) continue; // within a part
            dearest = std::max(dearest, merges[i].cost);
            steps.push_back({dearest, c, i, p, q, merges[i].cost});
        }
    }
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
        if (a.dearest != b.dearest) return a.dearest < b.dearest;
        return a.component != b.component ? a.component < b.component : a.order < b.order;
    });
    std::vector<PartMerge> merges;
    JoinedParts joined(parts.partCount());
    const std::vector<uint32_t> closest = closestNeighbours(state_->mesh, state_->topology, parts);
    for (uint32_t p = 0; p < parts.partCount(); ++p) {
        if (!hasCells[p] && closest[p] != kNone) joined.join(p, closest[p], 0, merges);
    }
    for (const Step& step : steps) joined.join(step.p, step.q, step.cost, merges);
    return merges;
}

std::vector<PerceptualTrace> PerceptualSegmenter::trace() const {
    constexpr size_t kMostCosts = 32;
    std::vector<PerceptualTrace> traces;
    for (const Component& component : state_->components) {
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
