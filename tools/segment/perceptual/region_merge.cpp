#include "region_merge.h"
#include "exact_math.h"

#include <algorithm>
#include <numeric>
#include <queue>

namespace xgc::bake {

namespace {

/// A turn of the normal per filter width that counts as fully concave.
constexpr float kMostConcave = 1.26f;

/// What lies between two regions: integrals along their common contour.
struct Contour {
    uint32_t to = 0;
    float length = 0;
    float concavity = 0;        ///< of min(k-, 2)
    glm::vec3 place{0};         ///< of the position
    glm::vec3 normal{0};        ///< of the surface's normal
    float placeSquared = 0;     ///< of the position's square
    float normalAlongPlace = 0; ///< of the normal times the position

    void add(const Contour& other) {
        length += other.length;
        concavity += other.concavity;
        place += other.place;
        normal += other.normal;
        placeSquared += other.placeSquared;
        normalAlongPlace += other.normalAlongPlace;
    }

    /// How far the surface faces away from the contour's centre along it: 1 around a neck of solid, about 0 around a
    /// bump on a plain, -1 around the bottom of a cavity, where people see no part.
    double girth() const {
        const double l = double(length);
        const double variance = double(placeSquared) / l - double(glm::dot(place, place)) / (l * l);
        if (!(variance > 1e-9)) return 0;
        return (double(normalAlongPlace) - double(glm::dot(normal, place)) / l) / (l * std::sqrt(variance));
    }
};

Contour contourAcross(const CellGraph& graph, const CellGraph::Link& link, float concave) {
    Contour contour;
    const glm::vec3 place = (graph.centers[link.a] + graph.centers[link.b]) * 0.5f;
    const glm::vec3 sum = graph.normals[link.a] + graph.normals[link.b];
    const float length = glm::length(sum);
    const glm::vec3 normal = length > 0 ? sum / length : glm::vec3(0);
    contour.length = link.length;
    contour.concavity = link.length * std::min(concave, kMostConcave);
    contour.place = place * link.length;
    contour.normal = normal * link.length;
    contour.placeSquared = glm::dot(place, place) * link.length;
    contour.normalAlongPlace = glm::dot(normal, place) * link.length;
    return contour;
}

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
        : regions_(first.count()), group_(first.group), alive_(first.count()) {
        std::iota(alive_.begin(), alive_.end(), 0u);
        for (uint32_t c = 0; c < graph.size(); ++c) {
            const uint32_t r = first.ofCell[c];
            regions_[r].area += graph.areas[c];
            regions_[r].weightedDiameter += double(graph.areas[c]) * double(diameters[first.superfacet[r]]);
        }
        for (size_t l = 0; l < graph.links.size(); ++l) {
            const CellGraph::Link& link = graph.links[l];
            const uint32_t a = first.ofCell[link.a], b = first.ofCell[link.b];
            if (a == b) continue;
            Contour contour = contourAcross(graph, link, features.concave[l]);
            contour.to = b;
            regions_[a].contours.push_back(contour);
            contour.to = a;
            regions_[b].contours.push_back(contour);
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
                contours[kept - 1].add(contours[i]);
            } else {
                contours[kept++] = contours[i];
            }
        }
        contours.resize(kept);
    }

    void copyLines(const FirstRegions& first, uint32_t superfacets, const LinesOfSight& lines) {
        const size_t n = regions_.size();
        lines_.resize(n * n);
        for (size_t a = 0; a < n; ++a) {
            const size_t row = size_t(first.superfacet[a]) * superfacets;
            for (size_t b = 0; b < n; ++b)
                lines_[a * n + b] = {lines.seen[row + first.superfacet[b]], lines.sampled[row + first.superfacet[b]]};
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
        const double visible = lines_[at].sampled > 0 ? double(lines_[at].seen / lines_[at].sampled) : 1;
        const double diameters = std::abs(x.weightedDiameter / std::max(1e-9, double(x.area)) -
                                          y.weightedDiameter / std::max(1e-9, double(y.area)));
        const double step = exact::pow(k, 1.2) + 0.32 * exact::pow(std::max(0.0, 1 - visible), 0.336) +
                            0.44 * exact::pow(diameters, 0.72) + 0.1;
        const double cost = girthFactor(contour.girth()) * step * exact::pow(smaller / (smaller + 0.025), 0.32) *
                            exact::pow(length / std::sqrt(smaller), -0.32);
        return smaller < 0.003 ? 0.02 * cost : cost;
    }

    /// Contours around cavities count little.
    static double girthFactor(double girth) {
        constexpr double kNone = 0.1, kMost = 0.7, kGain = 0.05, kLoss = 1.15;
        const double beyond = girth - kNone;
        return 1 + (beyond < 0 ? kLoss : kGain) * std::clamp(beyond, -kMost, kMost);
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
        alive_.erase(std::lower_bound(alive_.begin(), alive_.end(), b));
        for (const uint32_t i : alive_) {
            Lines& sum = lines_[a * n + i];
            sum.seen += lines_[b * n + i].seen;
            sum.sampled += lines_[b * n + i].sampled;
            lines_[i * n + a] = sum;
        }
    }

    /// Between two regions; see LinesOfSight.
    struct Lines {
        float seen, sampled;
    };

    std::vector<Region> regions_;
    std::vector<uint32_t> group_; ///< empty: all may merge
    std::vector<Lines> lines_;    ///< a row a region
    std::vector<uint32_t> alive_; ///< regions that are not gone, rising
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
