#pragma once

#include <xgc/indices.h>

#include <array>

namespace xgc {

// Geomorphs: levels that change continuously, without a pop and without a crack.
//
// Each patch has a lambda: a level and a fraction of the way to the next one. A group of rows (a domain, or the
// interior of a patch) has the least lambda of its patches, and what is drawn is the index lists of the levels, with
// every row w at
//
//     P(w) = mix(position(w), P(target(w)), clamp(lambda(group(w)) - (collapseLevel(w) - 1), 0, 1))
//
// where `target` is the row into which w collapses. So P is a continuous function of all lambdas, at whole ones it is
// the surface of the state, and it is one function of the row for all patches: no state, and no way between two, can
// open a crack. All attributes blend by the same weights.

/// A row as a vertex shader sees it: 8 bytes that a renderer uploads once.
struct MorphRow {
    uint32_t target;        ///< row that it goes to; itself where it never collapses
    uint32_t groupAndLevel; ///< group, and in the upper 8 bits its collapse level (format::kNever: never)

    uint32_t group() const { return groupAndLevel & 0xffffffu; }
    uint32_t collapseLevel() const { return groupAndLevel >> 24; }
};
static_assert(sizeof(MorphRow) == 8);

/// Largest fraction of a lambda: a float holds any level beside it.
inline constexpr float kMaxFraction = 1 - 1.0f / 16384;
/// Most rows that a vertex is blended of; baked models need three. Where as many nested domains as that are on their
/// way at once, the chain ends at the last: still without a crack.
inline constexpr uint32_t kMorphRows = 4;

/// Groups of an asset: its domains, then the interiors of its patches.
inline uint32_t groupCount(const AssetView& asset) {
    return asset.record->domainCount + asset.patchCount();
}

/// A MorphRow each row of the asset. `out`: at least vertexCount entries, untouched where it fails: an asset of more
/// than 16,777,216 groups is unsupported. One pass; no allocation.
Status morphRows(const AssetView& asset, std::span<MorphRow> out);

/// The lambda of each group from the level and the fraction of each patch: what a renderer uploads each frame for each
/// instance that morphs. `fractions`: one a patch, 0 to kMaxFraction; none: all are 0. `out`: at least groupCount
/// entries. No allocation.
void groupLambdas(const AssetView& asset, Levels levels, std::span<const float> fractions, std::span<float> out);

/// The rows that a row is blended of: `count` of them with weights that add up to 1.
struct MorphBlend {
    std::array<uint32_t, kMorphRows> rows;
    std::array<float, kMorphRows> weights;
    uint32_t count = 0;
};

/// P of a row: what the vertex shader does, row by row. `rows`: of morphRows; `lambdas`: of groupLambdas. Any row has
/// one, drawn or not: one that has collapsed is where it went to.
MorphBlend morph(std::span<const MorphRow> rows, std::span<const float> lambdas, uint32_t row);
glm::vec3 morphedPosition(const AssetView& asset, std::span<const MorphRow> rows, std::span<const float> lambdas,
                          uint32_t row);

/// The most that a drawn row moves, mesh units, for each level by which the lambdas of patches change, in steps of at
/// most one: the length of the way that it may be on, once for each row of the way that may move at the same time. 0
/// where it never collapses.
float morphSpeed(const AssetView& asset, std::span<const MorphRow> rows, uint32_t row);

} // namespace xgc
