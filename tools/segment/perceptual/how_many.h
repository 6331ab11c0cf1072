#pragma once

#include "region_merge.h"

#include <span>
#include <vector>

namespace xgc::bake {

/// How many regions a component falls into by itself: the merges stop before the first that is dear, as seen from the
/// dearest of all. From `islands` (no merge is left out) up.
uint32_t naturalCount(std::span<const Merge> merges, uint32_t islands);

/// Shares `wanted` regions out to components, each with its merges in order and its islands: those that are dearest to
/// lose stay. Fewer than the islands cannot be had.
std::vector<uint32_t> countsFor(uint32_t wanted, std::span<const std::span<const Merge>> merges,
                                std::span<const uint32_t> islands);

} // namespace xgc::bake
