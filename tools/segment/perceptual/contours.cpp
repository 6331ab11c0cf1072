#include "contours.h"
#include "min_cut.h"

#include <algorithm>
#include <queue>

namespace xgc::bake {

namespace {

constexpr float kBand = 0.0125f;      ///< either side of a contour
constexpr float kMostOfRegion = 0.5f; ///< that a band may take
constexpr float kTinyPiece = 0.0098f; ///< of the area of the whole

struct RegionPair {
    uint32_t a, b;
    bool operator==(const RegionPair&) const = default;
    auto operator<=>(const RegionPair&) const = default;
};

bool isOneGroup(std::span<const uint32_t> group, const CellGraph::Link& link) {
    return group.empty() || group[link.a] == group[link.b];
}

class Smoother {
public:
    Smoother(const CellGraph& graph, const EdgeFeatures& features, std::span<const uint32_t> group,
             CellRegions& regions)
        : graph_(graph), group_(group), regions_(regions), capacity_(graph.links.size()), areas_(regions.count, 0.0f),
          distance_(graph.size(), kFar), node_(graph.size(), 0) {
        for (size_t l = 0; l < capacity_.size(); ++l) {
            const float concave = features.concave[l] / 0.177f, convex = std::min(features.convex[l], 2.0f);
            capacity_[l] = graph.links[l].length * (0.06f + (1 + 0.4f * convex) / (1 + concave * concave));
        }
        for (uint32_t c = 0; c < graph.size(); ++c) areas_[regions.ofCell[c]] += graph.areas[c];
    }

    void run() {
        for (const RegionPair& pair : neighbours()) smooth(pair);
    }

private:
    static constexpr float kFar = 1e30f;

    std::vector<RegionPair> neighbours() const {
        std::vector<RegionPair> pairs;
        for (const CellGraph::Link& link : graph_.links) {
            const uint32_t a = regions_.ofCell[link.a], b = regions_.ofCell[link.b];
            if (a != b && isOneGroup(group_, link)) pairs.push_back({std::min(a, b), std::max(a, b)});
        }
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        return pairs;
    }

    bool isOf(uint32_t cell, const RegionPair& pair) const {
        return regions_.ofCell[cell] == pair.a || regions_.ofCell[cell] == pair.b;
    }

    /// Cells of both regions by rising distance from the contour between them, up to the band's width; as many of each
    /// as the region can spare.
    void findBand(const RegionPair& pair) {
        band_.clear();
        reached_.clear();
        for (uint32_t l = 0; l < graph_.links.size(); ++l) {
            const CellGraph::Link& link = graph_.links[l];
            const uint32_t a = regions_.ofCell[link.a], b = regions_.ofCell[link.b];
            if (std::min(a, b) != pair.a || std::max(a, b) != pair.b) continue;
            reach(link.a, 0);
            reach(link.b, 0);
        }
        float restA = areas_[pair.a] * kMostOfRegion, restB = areas_[pair.b] * kMostOfRegion;
        while (!queue_.empty()) {
            const Visit visit = queue_.top();
            queue_.pop();
            if (visit.distance > distance_[visit.cell]) continue;
            float& rest = regions_.ofCell[visit.cell] == pair.a ? restA : restB;
            if (rest < graph_.areas[visit.cell]) continue;
            rest -= graph_.areas[visit.cell];
            band_.push_back(visit.cell);
            for (const CellGraph::Arc& arc : graph_.arcsOf(visit.cell)) {
                if (!isOf(arc.to, pair)) continue;
                const float step = glm::length(graph_.centers[arc.to] - graph_.centers[visit.cell]);
                if (visit.distance + step <= kBand) reach(arc.to, visit.distance + step);
            }
        }
        for (const uint32_t c : reached_) distance_[c] = kFar;
    }
    void reach(uint32_t cell, float distance) {
        if (distance >= distance_[cell]) return;
        if (distance_[cell] == kFar) reached_.push_back(cell);
        distance_[cell] = distance;
        queue_.push({distance, cell});
    }

    void smooth(const RegionPair& pair) {
        findBand(pair);
        if (band_.empty()) return;
        MinCut cut(uint32_t(band_.size()) + 2);
        for (uint32_t i = 0; i < band_.size(); ++i) node_[band_[i]] = i + 2;
        for (const uint32_t c : band_) {
            for (const CellGraph::Arc& arc : graph_.arcsOf(c)) {
                if (!isOf(arc.to, pair)) continue;
                const float capacity = capacity_[arc.link];
                if (node_[arc.to] >= 2) {
                    if (c < arc.to) cut.addEdge(node_[c], node_[arc.to], capacity);
                } else {
                    const bool isA = regions_.ofCell[arc.to] == pair.a;
                    cut.addEdge(isA ? MinCut::kSource : MinCut::kSink, node_[c], capacity);
                }
            }
        }
        const std::vector<uint8_t> side = cut.run();
        for (const uint32_t c : band_) {
            const uint32_t now = side[node_[c]] ? pair.a : pair.b;
            areas_[regions_.ofCell[c]] -= graph_.areas[c];
            areas_[now] += graph_.areas[c];
            regions_.ofCell[c] = now;
        }
        for (const uint32_t c : band_) node_[c] = 0;
    }

    struct Visit {
        float distance;
        uint32_t cell;
        bool operator>(const Visit& other) const {
            return distance != other.distance ? distance > other.distance : cell > other.cell;
        }
    };

    const CellGraph& graph_;
    std::span<const uint32_t> group_;
    CellRegions& regions_;
    std::vector<float> capacity_, areas_, distance_;
    std::vector<uint32_t> node_; ///< of a cell in the cut; below 2: not in the band
    std::vector<uint32_t> band_, reached_;
    std::priority_queue<Visit, std::vector<Visit>, std::greater<>> queue_;
};

/// Connected sets of cells of a region and group, by lowest cell.
CellRegions connectedSets(const CellGraph& graph, std::span<const uint32_t> group, const CellRegions& regions) {
    CellRegions sets = {std::vector<uint32_t>(graph.size(), kNone), 0};
    std::vector<uint32_t> walk;
    for (uint32_t seed = 0; seed < graph.size(); ++seed) {
        if (sets.ofCell[seed] != kNone) continue;
        walk.assign(1, seed);
        sets.ofCell[seed] = sets.count;
        for (size_t i = 0; i < walk.size(); ++i) {
            for (const CellGraph::Arc& arc : graph.arcsOf(walk[i])) {
                if (sets.ofCell[arc.to] != kNone || regions.ofCell[arc.to] != regions.ofCell[seed]) continue;
                if (!isOneGroup(group, graph.links[arc.link])) continue;
                sets.ofCell[arc.to] = sets.count;
                walk.push_back(arc.to);
            }
        }
        ++sets.count;
    }
    return sets;
}

/// The smallest set that `mustJoin` (set, its area) joins the neighbour with the longest common boundary, until there
/// is none or all that must are alone.
template <class MustJoin>
void joinSets(const CellGraph& graph, std::span<const uint32_t> group, const MustJoin& mustJoin, CellRegions& sets) {
    std::vector<float> area(sets.count, 0.0f);
    for (uint32_t c = 0; c < graph.size(); ++c) area[sets.ofCell[c]] += graph.areas[c];
    std::vector<uint8_t> isDone(sets.count, 0); // joined, or alone
    for (;;) {
        uint32_t smallest = kNone;
        for (uint32_t s = 0; s < sets.count; ++s) {
            if (isDone[s] || !mustJoin(s, area[s])) continue;
            if (smallest == kNone || area[s] < area[smallest]) smallest = s;
        }
        if (smallest == kNone) return;
        isDone[smallest] = 1;
        std::vector<float> common(sets.count, 0.0f);
        for (const CellGraph::Link& link : graph.links) {
            const uint32_t a = sets.ofCell[link.a], b = sets.ofCell[link.b];
            if (a == b || !isOneGroup(group, link)) continue;
            if (a == smallest) common[b] += link.length;
            if (b == smallest) common[a] += link.length;
        }
        const auto longest = uint32_t(std::max_element(common.begin(), common.end()) - common.begin());
        if (!(common[longest] > 0)) continue;
        area[longest] += area[smallest];
        for (uint32_t& s : sets.ofCell) s = s == smallest ? longest : s;
    }
}

void makeDense(CellRegions& regions) {
    std::vector<uint32_t> number(regions.count, kNone);
    regions.count = 0;
    for (uint32_t& r : regions.ofCell) {
        if (number[r] == kNone) number[r] = regions.count++;
        r = number[r];
    }
}

} // namespace

void smoothContours(const CellGraph& graph, const EdgeFeatures& features, std::span<const uint32_t> group,
                    CellRegions& regions) {
    Smoother(graph, features, group, regions).run();
    regions = connectedSets(graph, group, regions);
    joinSets(
        graph, group, [](uint32_t, float area) { return area < kTinyPiece; }, regions);
    makeDense(regions);
}

} // namespace xgc::bake
