#pragma once

#include "fill.h"

namespace xgc::bake {

/// Merges the smallest region into the neighbour with which it shares the longest boundary until `wanted` are left
/// (thesis 3.7, algorithm 2); ties go to the lower region. A region without neighbours cannot merge: it stays.
/// The merged region keeps the lower number of the two; the result is not dense. O(n log^2 n) in the regions for
/// meshes whose regions have few neighbours each.
std::vector<uint32_t> mergeRegions(const Mesh& mesh, const Topology& topology, const Regions& regions,
                                   std::vector<double> areas, uint32_t wanted);

} // namespace xgc::bake
