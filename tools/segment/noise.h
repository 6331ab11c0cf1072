#pragma once

#include "fill.h"

namespace xgc::bake {

/// Cumulative relative-area histogram (thesis 3.6.1): bin i holds the percent of the total area that lies in
/// regions of [i, i + 1[ percent; a region of 100 percent is in the last bin. All zero where there is no area.
std::array<double, 100> areaHistogram(std::span<const double> regionAreas);

/// The noise bin [0,1[ holds at least `ratio` times the largest other bin.
bool isNoisy(const std::array<double, 100>& histogram, double ratio);

/// One round of the uniform Laplacian over all positions at once: each becomes the mean of its neighbours.
std::vector<glm::dvec3> smoothPositions(const Topology& topology, std::span<const glm::dvec3> positions);

/// Area of each region at `positions`.
std::vector<double> regionAreas(const Mesh& mesh, const Regions& regions, std::span<const glm::dvec3> positions);

/// n of Eq. 3.1, each bin's a_i taken as the mean area of its regions: the regions of 1 percent or more.
uint32_t equationCount(std::span<const double> regionAreas);

} // namespace xgc::bake
