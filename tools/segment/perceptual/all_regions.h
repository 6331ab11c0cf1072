#pragma once

#include "analysed_mesh.h"

namespace xgc::bake {

uint32_t totalOf(const RegionsOfAll& regions);

/// As many regions as each component falls into by itself.
RegionsOfAll naturalRegions(const AnalysedMesh& at);

/// `wanted` in all, where islands and superfacets allow.
RegionsOfAll cutToTotal(const AnalysedMesh& at, uint32_t wanted);

/// Unions of regions, or regions within them: about `wanted` in all.
RegionsOfAll refine(const AnalysedMesh& at, const RegionsOfAll& regions, uint32_t wanted);

} // namespace xgc::bake
