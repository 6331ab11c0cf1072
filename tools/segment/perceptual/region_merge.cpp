#include "region_merge.h"
#include "exact_math.h"

#include <algorithm>
#include <numeric>
#include <queue>

namespace xgc::bake {

namespace {

/// A turn of the normal per filter width that counts as fully concave.
constexpr float kMostConcave = 1.77f;

/// What lies between two regions.
struct Contour {
    uint32_t to;
    float length;
    float concavity; ///< integral of min(k-, 2) along it
};

struct Region {
    float area = 0;
    double weightedDiameter = 0;
    uint32_t version = 0;          ///< merges it was in; kNone: gone
    std::vector<Contour> contours; ///< by rising neighbour
};

struct Candidate {
    double cost;
    uint32_t a, b, versionA, versionB;
    bool operator>(const Candidate& other) const {
        if (cost != other.cost) return cost > other.cost;
        return a != other.a ? a > other.a : b > other.b;
    }
};

class Merger {
public:
    Merger(const CellGraph& graph, const EdgeFeatures& features, const FirstRegions& first,
           std::span<const float> diameters, const LinesOfSight& lines)
        : regions_(first.count()), group_(first.group) {
        for (uint32_t c = 0; c < graph.size(); ++c) {
            const uint32_t r = first.ofCell[c];
            regions_[r].area += graph.areas[c];
            regions_[r].weightedDiameter += double(graph.areas[c]) * double(diameters[first.superfacet[r]]);
        }
        for (size_t l = 0; l < graph.links.size(); ++l) {
            const CellGraph::Link& link = graph.links[l];
            const uint32_t a = first.ofCell[link.a], b = first.ofCell[link.b];
            if (a == b) continue;
            const float concavity = link.length * std::min(features.concave[l], kMostConcave);
            regions_[a].contours.push_back({b, link.length, concavity});
            regions_[b].contours.push_back({a, link.length, concavity});
        }
        for (Region& region : regions_) unite(region.contours);
        copyLines(first, uint32_t(diameters.size()), lines);
    }

    std::vector<Merge> run() {
        if (!group_.empty()) {
            mergeAll();
            group_.clear();
        }
        mergeAll();
        return std::move(merges_);
    }

private:
    /// One entry a neighbour, by rising neighbour.
    static void unite(std::vector<Contour>& contours) {
        std::stable_sort(contours.begin(), contours.end(),
                         [](const Contour& x, const Contour& y) { return x.to < y.to; });
        size_t kept = 0;
        for (size_t i = 0; i < contours.size(); ++i) {
            if (kept > 0 && contours[kept - 1].to == contours[i].to) {
                contours[kept - 1].length += contours[i].length;
                contours[kept - 1].concavity += contours[i].concavity;
            } else {
                contours[kept++] = contours[i];
            }
        }
        contours.resize(kept);
    }

    void copyLines(const FirstRegions& first, uint32_t superfacets, const LinesOfSight& lines) {
        const size_t n = regions_.size();
        lines_.seen.resize(n * n);
        lines_.sampled.resize(n * n);
        for (size_t a = 0; a < n; ++a) {
            for (size_t b = 0; b < n; ++b) {
                const size_t at = size_t(first.superfacet[a]) * superfacets + first.superfacet[b];
                lines_.seen[a * n + b] = lines.seen[at];
                lines_.sampled[a * n + b] = lines.sampled[at];
            }
        }
    }

    void mergeAll() {
        for (uint32_t a = 0; a < regions_.size(); ++a) {
            for (const Contour& contour : regions_[a].contours) {
                if (a < contour.to) consider(a, contour);
            }
        }
        while (!queue_.empty()) {
            const Candidate best = queue_.top();
            queue_.pop();
            if (regions_[best.a].version != best.versionA || regions_[best.b].version != best.versionB) continue;
            merges_.push_back({best.a, best.b, best.cost});
            merge(best.a, best.b);
        }
    }

    void consider(uint32_t a, const Contour& contour) {
        if (!group_.empty() && group_[a] != group_[contour.to]) return;
        const uint32_t b = contour.to, low = std::min(a, b), high = std::max(a, b);
        queue_.push({costOf(a, contour), low, high, regions_[low].version, regions_[high].version});
    }

    double costOf(uint32_t a, const Contour& contour) const {
        const Region& x = regions_[a];
        const Region& y = regions_[contour.to];
        const size_t at = size_t(a) * regions_.size() + contour.to;
        const double smaller = std::max(1e-9, double(std::min(x.area, y.area)));
        const double length = std::max(1e-9, double(contour.length));
        const double k = double(contour.concavity) / length;
        const double visible = lines_.sampled[at] > 0 ? double(lines_.seen[at] / lines_.sampled[at]) : 1;
        const double diameters = std::abs(x.weightedDiameter / std::max(1e-9, double(x.area)) -
                                          y.weightedDiameter / std::max(1e-9, double(y.area)));
        const double step = exact::pow(k, 1.2) + 0.32 * exact::pow(std::max(0.0, 1 - visible), 0.3) +
                            0.44 * exact::pow(diameters, 0.72) + 0.1;
        const double cost =
            step * exact::pow(smaller / (smaller + 0.0154), 0.32) * exact::pow(length / std::sqrt(smaller), -0.32);
        return smaller < 0.003 ? 0.02 * cost : cost;
    }

    void merge(uint32_t a, uint32_t b) {
        Region& x = regions_[a];
        Region& y = regions_[b];
        x.area += y.area;
        x.weightedDiameter += y.weightedDiameter;
        ++x.version;
        y.version = kNone;
        x.contours.insert(x.contours.end(), y.contours.begin(), y.contours.end());
        y.contours = {};
        std::erase_if(x.contours, [&](const Contour& c) { return c.to == a || c.to == b; });
        unite(x.contours);
        for (const Contour& contour : x.contours) redirect(contour.to, a, b);
        addLines(a, b);
        for (const Contour& contour : x.contours) consider(a, contour);
    }

    void redirect(uint32_t region, uint32_t a, uint32_t b) {
        std::vector<Contour>& contours = regions_[region].contours;
        for (Contour& contour : contours) {
            if (contour.to == b) contour.to = a;
        }
        unite(contours);
    }

    void addLines(uint32_t a, uint32_t b) {
        const size_t n = regions_.size();
        for (std::vector<float>* table : {&lines_.seen, &lines_.sampled}) {
            for (size_t i = 0; i < n; ++i) {
                (*table)[a * n + i] += (*table)[b * n + i];
                (*table)[i * n + a] = (*table)[a * n + i];
            }
        }
    }

    std::vector<Region> regions_;
    std::vector<uint32_t> group_; ///< empty: all may merge
    LinesOfSight lines_;          ///< per region
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
    std::vector<Merge> merges_;
};

} // namespace

FirstRegions firstRegions(const Superfacets& superfacets) {
    FirstRegions first = {superfacets.ofCell, std::vector<uint32_t>(superfacets.count()), {}};
    std::iota(first.superfacet.begin(), first.superfacet.end(), 0u);
    return first;
}

std::vector<Merge> mergeRegions(const CellGraph& graph, const EdgeFeatures& features, const FirstRegions& first,
                                std::span<const float> diameters, const LinesOfSight& lines) {
    return Merger(graph, features, first, diameters, lines).run();
}

std::vector<uint32_t> regionsAt(std::span<const Merge> merges, uint32_t firstCount, uint32_t count) {
    std::vector<uint32_t> parent(firstCount);
    std::iota(parent.begin(), parent.end(), 0u);
    const size_t taken = firstCount > count ? std::min(merges.size(), size_t(firstCount - count)) : 0;
    for (size_t i = 0; i < taken; ++i) parent[merges[i].b] = merges[i].a;
    std::vector<uint32_t> region(firstCount);
    uint32_t dense = 0;
    for (uint32_t r = 0; r < firstCount; ++r) region[r] = parent[r] == r ? dense++ : region[parent[r]];
    return region;
}

} // namespace xgc::bake
