#include "all_regions.h"
#include "how_many.h"

namespace xgc::bake {

namespace {

RegionsOfAll cutAll(const AnalysedMesh& at, std::span<const uint32_t> counts) {
    RegionsOfAll regions;
    for (size_t c = 0; c < at.components.size(); ++c) regions.push_back(cutInto(at.components[c], counts[c]));
    return regions;
}

} // namespace

uint32_t totalOf(const RegionsOfAll& regions) {
    uint32_t total = 0;
    for (const CellRegions& r : regions) total += r.count;
    return total;
}

RegionsOfAll naturalRegions(const AnalysedMesh& at) {
    std::vector<uint32_t> counts;
    for (const Component& component : at.components) {
        counts.push_back(naturalCount(component.merges, component.islands()));
    }
    return cutAll(at, counts);
}

/// Smoothing contours may join or part regions: the cut is moved until the total is right, or left unsmoothed.
RegionsOfAll cutToTotal(const AnalysedMesh& at, uint32_t wanted) {
    constexpr int kTries = 12;
    std::vector<std::span<const Merge>> merges;
    std::vector<uint32_t> islands;
    for (const Component& component : at.components) {
        merges.push_back(component.merges);
        islands.push_back(component.islands());
    }
    int64_t aim = wanted;
    for (int i = 0; i < kTries && aim > 0; ++i) {
        RegionsOfAll regions = cutAll(at, countsFor(uint32_t(aim), merges, islands));
        const uint32_t total = totalOf(regions);
        if (total == wanted) return regions;
        aim += int64_t(wanted) - int64_t(total);
    }
    const std::vector<uint32_t> counts = countsFor(wanted, merges, islands);
    RegionsOfAll regions;
    for (size_t c = 0; c < at.components.size(); ++c) regions.push_back(cutExactly(at.components[c], counts[c]));
    return regions;
}

RegionsOfAll refine(const AnalysedMesh& at, const RegionsOfAll& regions, uint32_t wanted) {
    const bool isFiner = wanted > totalOf(regions);
    std::vector<FirstRegions> first(at.components.size());
    std::vector<std::vector<Merge>> all(at.components.size());
    std::vector<std::span<const Merge>> merges;
    std::vector<uint32_t> least;
    for (size_t c = 0; c < at.components.size(); ++c) {
        all[c] = mergesOf(at.components[c], regions[c], first[c]);
        const size_t within = first[c].count() - regions[c].count; // merges that do not leave a region
        merges.push_back(isFiner ? std::span(all[c]).first(within) : std::span(all[c]).subspan(within));
        least.push_back(isFiner ? regions[c].count : first[c].count() - uint32_t(all[c].size()));
    }
    const std::vector<uint32_t> counts = countsFor(wanted, merges, least);
    RegionsOfAll refined;
    for (size_t c = 0; c < at.components.size(); ++c) {
        const std::vector<uint32_t> region = regionsAt(all[c], first[c].count(), counts[c]);
        CellRegions cut;
        for (const uint32_t r : first[c].ofCell) cut.ofCell.push_back(region[r]);
        cut.count = counts[c];
        if (isFiner) smoothContours(at.components[c].cells.graph, at.components[c].features, regions[c].ofCell, cut);
        refined.push_back(std::move(cut));
    }
    return refined;
}

} // namespace xgc::bake
