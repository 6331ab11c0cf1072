#include "how_many.h"
#include "exact_math.h"

#include <algorithm>
#include <numeric>

namespace xgc::bake {

namespace {

/// Costs are judged by the dearest of the component to this power: 0 would take them as they are, 1 as shares of it.
constexpr double kOwnScale = 0.475;

double highestCost(std::span<const Merge> merges) {
    double highest = 0;
    for (const Merge& merge : merges) highest = std::max(highest, merge.cost);
    return highest;
}

} // namespace

uint32_t naturalCount(std::span<const Merge> merges, uint32_t islands) {
    constexpr double kDear = 0.508; ///< scaled
    constexpr double kWhole = 0.42; ///< a last merge below this: one part
    if (merges.empty() || merges.back().cost < kWhole) return islands;
    const double limit = kDear * exact::pow(highestCost(merges), kOwnScale);
    size_t taken = 0;
    while (taken < merges.size() && merges[taken].cost <= limit) ++taken;
    return islands + uint32_t(merges.size() - taken);
}

std::vector<uint32_t> countsFor(uint32_t wanted, std::span<const std::span<const Merge>> merges,
                                std::span<const uint32_t> islands) {
    struct Split {
        double cost; ///< scaled; the dearest merge up to this one
        uint32_t component, order;
    };
    std::vector<Split> splits;
    for (uint32_t c = 0; c < merges.size(); ++c) {
        const double scale = 1 / std::max(1e-9, exact::pow(highestCost(merges[c]), kOwnScale));
        double dearest = 0;
        for (uint32_t i = 0; i < merges[c].size(); ++i) {
            dearest = std::max(dearest, merges[c][i].cost * scale);
            splits.push_back({dearest, c, i});
        }
    }
    std::sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) {
        if (a.cost != b.cost) return a.cost > b.cost;
        return a.component != b.component ? a.component < b.component : a.order > b.order;
    });
    std::vector<uint32_t> counts(islands.begin(), islands.end());
    uint32_t total = std::accumulate(counts.begin(), counts.end(), 0u);
    for (size_t i = 0; i < splits.size() && total < wanted; ++i, ++total) ++counts[splits[i].component];
    return counts;
}

} // namespace xgc::bake
