#pragma once

#include <xgc/asset.h>

namespace xgc {

/// A state of one asset: the level of each patch, `patchCount` entries below `levelCount`.
using Levels = std::span<const uint8_t>;

/// Level of a domain in a state: the least over its patches.
uint32_t domainLevel(const AssetView& asset, uint32_t domain, Levels levels);

/// Most indices that `buildIndices` can write for the patch in a state; within a small factor of what it
/// writes where the patch and its neighbours are at like levels, and exact where all are at level 0. It
/// does not rise where no level falls.
uint32_t indexCapacity(const AssetView& asset, uint32_t patch, Levels levels);

/// Triangles of a patch with all patches at one level.
uint32_t uniformTriangles(const AssetView& asset, uint32_t patch, uint32_t level);

/// Most triangles of a patch in a state: those that it has with all patches at the finest level among its groups. Exact
/// where all are at one level, and does not rise where no level falls. Files without patchFaceCounts give a coarser
/// bound, and uniformTriangles the same.
uint32_t triangleBound(const AssetView& asset, uint32_t patch, Levels levels);

/// Scratch entries that `buildIndices` needs for any patch of the asset.
inline uint32_t scratchCapacity(const AssetView& asset) {
    return asset.record->maxPatchSlots;
}

/// Writes the triangle list of a patch in a state: vertex rows of the asset, three a triangle, none
/// degenerate, front faces counter-clockwise. Patches that are built in one state meet without
/// cracks. Returns the number of indices written.
///
/// `scratch`: scratchCapacity entries, overwritten; one per thread. `out`: at least
/// `indexCapacity(asset, patch, levels)` entries; the rest of it may be overwritten up to that
/// capacity. No allocation.
uint32_t buildIndices(const AssetView& asset, uint32_t patch, Levels levels, std::span<uint32_t> scratch,
                      std::span<uint32_t> out);

/// True where the triangles of `patch` differ, or may differ, between two states: a vertex of its interior or of a
/// domain that it shares collapses between the two levels. A patch whose level repeats the surface of another level
/// needs no rebuild: its triangles are the same, if perhaps in another order.
bool needsRebuild(const AssetView& asset, uint32_t patch, Levels before, Levels after);

// The two halves of needsRebuild, for callers that know which patches changed level.

/// True where the patch's own vertices differ between two of its levels.
bool patchDiffers(const AssetView& asset, uint32_t patch, uint32_t before, uint32_t after);
/// True where vertices of the domain differ between two states: then all its patches need a rebuild.
bool domainDiffers(const AssetView& asset, uint32_t domain, Levels before, Levels after);

} // namespace xgc
