#pragma once

#include "edge_features.h"

namespace xgc::bake {

/// Regions of cells: dense numbers.
struct CellRegions {
    std::vector<uint32_t> ofCell;
    uint32_t count = 0;
};

/// Moves the contour between every two neighbouring regions, within a band beside it, to where it is short and runs
/// along concave edges (a minimum cut); then gives pieces that were cut off a region of their own or, where they are
/// tiny, to the neighbour with the longest common boundary. Contours between cells of different `group` stay where they
/// are (one a cell; empty: all are of one).
void smoothContours(const CellGraph& graph, const EdgeFeatures& features, std::span<const uint32_t> group,
                    CellRegions& regions);

} // namespace xgc::bake
