#pragma once

#include <xgc/asset.h>

namespace xgc {

/// Joins parts, the least distinct first, until `wanted` groups are left: coarser parts without a new bake.
///
/// `groupOfPart`: parts.size() entries, all written: groups count from 0, in order of their lowest parts. Returns how
/// many there are: `wanted` or, where the asset's merges do not go so far (parts of separate pieces stay apart, and
/// files need not have merges), more. Each coarser grouping is made of groups of the finer ones. `wanted` counts from
/// 1; more than there are parts joins none. No allocation.
uint32_t mergedParts(const AssetView& asset, uint32_t wanted, std::span<uint32_t> groupOfPart);

/// The part of a stable id or of a name; format::kNone where the asset has none. Linear in the number of parts.
uint32_t findPart(const AssetView& asset, uint64_t stableId);
uint32_t findPart(const AssetView& asset, std::string_view name);

} // namespace xgc
