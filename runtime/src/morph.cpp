#include <xgc/morph.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cassert>

// A target is not always the parent: rows of one chain that collapse at one level, in domains of the same patches, are
// always on their way together, so each goes straight to where the chain leaves them.
//
//     v, level 4, domain {1}  ->  u, level 4, domain {1}  ->  w, level 3, domain {1, 2}
//     target(v) = target(u) = w
//
// It goes by patches and not by groups: the writer cuts domains into pieces, and rows of one position with other
// attributes may lie in another piece.

namespace xgc {
namespace {

constexpr uint32_t kMaxGroups = 1u << 24;

uint32_t slotParent(const AssetView& asset, const format::PatchRecord& patch, uint32_t slot) {
    return patch.flags & format::kWideSlots ? asset.parentsWide[size_t(patch.firstParent) + slot]
                                            : asset.parentsNarrow[size_t(patch.firstParent) + slot];
}

/// The row of a slot of a patch.
uint32_t rowOf(const AssetView& asset, uint32_t patch, uint32_t slot) {
    const std::span<const uint32_t> firsts = asset.domainSlotsOf(patch);
    const format::VertexRange interior = asset.interiorRange(patch);
    const uint32_t firstInterior = asset.patches[patch].slotCount - interior.count;
    if (slot >= firstInterior) return interior.first + slot - firstInterior;
    const size_t at = size_t(std::upper_bound(firsts.begin(), firsts.end(), slot) - firsts.begin()) - 1;
    return asset.domainRange(asset.domainsOf(patch)[at]).first + slot - firsts[at];
}

/// Rows of a range, whose first slot in the patch is `firstSlot`, with their parents as targets.
void listRange(const AssetView& asset, uint32_t patch, uint32_t group, uint32_t firstSlot, format::VertexRange range,
               std::span<MorphRow> out) {
    for (uint32_t k = 0; k < range.count; ++k) {
        const uint32_t row = range.first + k;
        const uint8_t level = asset.collapseLevels[row];
        const uint32_t parent =
            level == format::kNever ? row : rowOf(asset, patch, slotParent(asset, asset.patches[patch], firstSlot + k));
        out[row] = {parent, group | uint32_t(level) << 24};
    }
}

void listPatch(const AssetView& asset, uint32_t patch, std::span<MorphRow> out) {
    const std::span<const uint32_t> domains = asset.domainsOf(patch), slots = asset.domainSlotsOf(patch);
    for (size_t i = 0; i < domains.size(); ++i) {
        // All patches of a domain agree on its parents: the first one tells them.
        if (asset.patchesOf(domains[i])[0] != patch) continue;
        listRange(asset, patch, domains[i], slots[i], asset.domainRange(domains[i]), out);
    }
    const format::VertexRange interior = asset.interiorRange(patch);
    listRange(asset, patch, asset.record->domainCount + patch, asset.patches[patch].slotCount - interior.count,
              interior, out);
}

/// Patches of a group: those of the domain, or the one.
bool samePatches(const AssetView& asset, uint32_t a, uint32_t b) {
    if (a == b) return true;
    const uint32_t domains = asset.record->domainCount;
    if (a >= domains && b >= domains) return false;
    if (a >= domains) std::swap(a, b);
    const std::span<const uint32_t> some = asset.patchesOf(a);
    if (b >= domains) return some.size() == 1 && some[0] == b - domains;
    const std::span<const uint32_t> others = asset.patchesOf(b);
    return std::equal(some.begin(), some.end(), others.begin(), others.end());
}

/// How far a row is on its way: 0 before it starts, 1 where it has arrived.
float shareOf(const MorphRow& row, std::span<const float> lambdas) {
    return std::clamp(lambdas[row.group()] - (float(row.collapseLevel()) - 1), 0.0f, 1.0f);
}

/// Of a row between its place and its target's. The groups that its chain passes have no larger lambdas than its own,
/// so what collapses later stands still.
float speedOnTheWay(const AssetView& asset, std::span<const MorphRow> rows, uint32_t row) {
    const uint32_t level = rows[row].collapseLevel();
    float length = 0;
    uint32_t moving = 0;
    for (uint32_t at = row; rows[at].target != at && rows[at].collapseLevel() <= level; at = rows[at].target) {
        length += glm::length(asset.positions[at] - asset.positions[rows[at].target]);
        moving = std::min(moving + 1, kMorphRows - 1);
    }
    return length * float(moving);
}

} // namespace

Status morphRows(const AssetView& asset, std::span<MorphRow> out) {
    assert(out.size() >= asset.record->vertexCount);
    if (groupCount(asset) > kMaxGroups) {
        return {StatusCode::unsupported, "morphRows: more than 16,777,216 domains and patches", groupCount(asset)};
    }
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) listPatch(asset, patch, out);
    // Parents have lower rows, so theirs are done.
    for (uint32_t row = 0; row < asset.record->vertexCount; ++row) {
        MorphRow& own = out[row];
        const MorphRow& parent = out[own.target];
        const bool together = own.collapseLevel() != format::kNever && own.collapseLevel() == parent.collapseLevel() &&
                              samePatches(asset, own.group(), parent.group());
        if (together) own.target = parent.target;
    }
    return {};
}

void groupLambdas(const AssetView& asset, Levels levels, std::span<const float> fractions, std::span<float> out) {
    const uint32_t domains = asset.record->domainCount, patches = asset.patchCount();
    assert(levels.size() >= patches && (fractions.empty() || fractions.size() >= patches));
    assert(out.size() >= size_t(domains) + patches);
    for (uint32_t p = 0; p < patches; ++p) {
        assert(fractions.empty() || (fractions[p] >= 0 && fractions[p] <= kMaxFraction));
        out[domains + p] = float(levels[p]) + (fractions.empty() ? 0 : fractions[p]);
    }
    for (uint32_t d = 0; d < domains; ++d) {
        float least = format::kNever;
        for (const uint32_t patch : asset.patchesOf(d)) least = std::min(least, out[domains + patch]);
        out[d] = least;
    }
}

MorphBlend morph(std::span<const MorphRow> rows, std::span<const float> lambdas, uint32_t row) {
    MorphBlend blend;
    float rest = 1;
    const auto add = [&](float weight) {
        blend.rows[blend.count] = row;
        blend.weights[blend.count++] = weight;
    };
    for (;;) {
        const float share = shareOf(rows[row], lambdas);
        if (share <= 0) break;
        if (share < 1) {
            if (blend.count + 1 == kMorphRows) break;
            add(rest * (1 - share));
            rest *= share;
        }
        row = rows[row].target;
    }
    add(rest);
    return blend;
}

glm::vec3 morphedPosition(const AssetView& asset, std::span<const MorphRow> rows, std::span<const float> lambdas,
                          uint32_t row) {
    const MorphBlend blend = morph(rows, lambdas, row);
    glm::vec3 sum(0);
    for (uint32_t i = 0; i < blend.count; ++i) sum += blend.weights[i] * asset.positions[blend.rows[i]];
    return sum;
}

float morphSpeed(const AssetView& asset, std::span<const MorphRow> rows, uint32_t row) {
    // Where lambdas pass a whole level, what the row has become then goes on.
    const uint32_t level = rows[row].collapseLevel();
    float fastest = 0;
    for (uint32_t at = row; rows[at].target != at && rows[at].collapseLevel() <= level + 1; at = rows[at].target) {
        fastest = std::max(fastest, speedOnTheWay(asset, rows, at));
    }
    return fastest;
}

} // namespace xgc
