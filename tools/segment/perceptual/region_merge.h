#pragma once

#include "visibility.h"

namespace xgc::bake {

/// One merge of two neighbouring regions: what was `b` is `a` from now on.
struct Merge {
    uint32_t a, b; ///< a < b
    double cost;
};

/// What merging starts from: regions of cells, each within one superfacet. Where `group` has an entry per region, those
/// of a group merge with each other first, down to one a group, and only then with others.
struct FirstRegions {
    std::vector<uint32_t> ofCell;
    std::vector<uint32_t> superfacet; ///< per region
    std::vector<uint32_t> group;      ///< per region, or empty
    uint32_t count() const { return uint32_t(superfacet.size()); }
};
/// The superfacets themselves.
FirstRegions firstRegions(const Superfacets& superfacets);

/// Merges the cheapest pair first, until one region a connected set is left. `diameters` and `lines` per superfacet.
std::vector<Merge> mergeRegions(const CellGraph& graph, const EdgeFeatures& features, const FirstRegions& first,
                                std::span<const float> diameters, const LinesOfSight& lines);

/// Region per first region when the merges have left `count` of them. Dense, by lowest first region.
std::vector<uint32_t> regionsAt(std::span<const Merge> merges, uint32_t firstCount, uint32_t count);

} // namespace xgc::bake
