#include <xgc/indices.h>

#include "rows.h"

#include <algorithm>
#include <cassert>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

// A patch is drawn in two steps. First every slot that the faces name gets its representative: the slots of each
// domain, in the file's order, then those of the interior. A parent always has a lower slot, and the rows alive at a
// level are a prefix of each range, so one pass forward resolves all chains:
//
//   slots  [ domain a      | domain b   | interior               ]
//   alive  [ #####.....    | ###....    | ##########............ ]     # : itself   . : rep[parent]
//
// Then faces are gathered through `rep`, from one of the patch's lists: each holds what the patch draws with all
// patches at the list's level. A state in which no group of the patch is finer than that only merges more of those
// vertices, so it draws the faces of the list that do not become degenerate. The coarsest such list is the shortest:
//
//   lists  [ level 0                              | level 7      | level 12 ]
//   least level of the groups: 9                    this one
//
// The interior slots that a list names are those alive at its level, so the pass forward ends there. Where nothing
// has collapsed since that level, all faces of the list are drawn and the interior's rows follow its slots.

namespace xgc {
namespace {

/// Representatives of the slots of a range, the first of which is `firstSlot`. `parents`: theirs.
template <typename Slot>
void resolve(const Slot* parents, uint32_t firstSlot, uint32_t alive, format::VertexRange range, uint32_t* rep) {
    uint32_t* own = rep + firstSlot;
    for (size_t k = 0; k < alive; ++k) own[k] = range.first + uint32_t(k);
    for (size_t k = alive; k < range.count; ++k) own[k] = rep[parents[k]];
}

/// A face list and where it starts among the faces of its patch.
struct ListedFaces {
    uint32_t level = 0;
    uint32_t first = 0;
    uint32_t count = 0;
};

/// The coarsest list that serves groups at `least` and coarser.
ListedFaces listFor(const AssetView& asset, uint32_t patch, uint32_t least) {
    const std::span<const format::FaceList> lists = asset.listsOf(patch);
    ListedFaces found{0, 0, lists[0].faceCount};
    for (size_t i = 1; i < lists.size() && lists[i].level <= least; ++i) {
        found = {lists[i].level, found.first + found.count, lists[i].faceCount};
    }
    return found;
}

/// Faces of the lists before it that are of the same tier.
uint32_t facesBefore(const AssetView& asset, uint32_t patch, const ListedFaces& list) {
    uint32_t count = 0;
    for (const format::FaceList& other : asset.listsOf(patch)) {
        if (other.level >= list.level) break;
        if (asset.tierOf(other.level) == asset.tierOf(list.level)) count += other.faceCount;
    }
    return count;
}

/// The finest level among the patch's own and those of its domains.
uint32_t finestGroup(const AssetView& asset, uint32_t patch, Levels levels) {
    uint32_t least = levels[patch];
    for (const uint32_t domain : asset.domainsOf(patch)) least = std::min(least, domainLevel(asset, domain, levels));
    return least;
}

/// What is known of a patch's domains once they are resolved.
struct DomainStates {
    uint32_t slotCount = 0;
    uint32_t leastLevel = format::kNever;
    uint32_t coarsestMoved = 0; ///< largest level of those with rows that are not drawn as themselves
};

template <typename Slot>
DomainStates resolveDomains(const AssetView& asset, uint32_t patch, Levels levels, const Slot* parents, uint32_t* rep) {
    DomainStates states;
    const uint32_t own = levels[patch]; // no domain of the patch is coarser
    for (const uint32_t domain : asset.domainsOf(patch)) {
        const format::VertexRange range = asset.domainRange(domain);
        const uint32_t level = own == 0 ? 0 : domainLevel(asset, domain, levels);
        const uint32_t alive = level == 0 ? range.count : aliveCount(asset, range, level);
        resolve(parents + states.slotCount, states.slotCount, alive, range, rep);
        states.slotCount += range.count;
        states.leastLevel = std::min(states.leastLevel, level);
        if (alive < range.count) states.coarsestMoved = std::max(states.coarsestMoved, level);
    }
    return states;
}

#ifdef __SSE2__

/// Corners that are written at once.
constexpr size_t kBlock = 16;

/// Writes a block of slots as rows where all are interior slots, `shift` below their rows; else leaves it.
bool emitInterior(const uint16_t* slots, uint32_t firstInterior, uint32_t shift, uint32_t* out) {
    // SSE2 subtracts with saturation but does not compare unsigned numbers: below the first one a slot leaves a rest.
    const __m128i first = _mm_set1_epi16(int16_t(firstInterior)), added = _mm_set1_epi32(int32_t(shift));
    const __m128i zero = _mm_setzero_si128();
    const auto* in = reinterpret_cast<const __m128i*>(slots);
    const __m128i a = _mm_loadu_si128(in), b = _mm_loadu_si128(in + 1);
    const __m128i below = _mm_or_si128(_mm_subs_epu16(first, a), _mm_subs_epu16(first, b));
    if (_mm_movemask_epi8(_mm_cmpeq_epi8(below, zero)) != 0xffff) return false;
    auto* to = reinterpret_cast<__m128i*>(out);
    _mm_storeu_si128(to, _mm_add_epi32(_mm_unpacklo_epi16(a, zero), added));
    _mm_storeu_si128(to + 1, _mm_add_epi32(_mm_unpackhi_epi16(a, zero), added));
    _mm_storeu_si128(to + 2, _mm_add_epi32(_mm_unpacklo_epi16(b, zero), added));
    _mm_storeu_si128(to + 3, _mm_add_epi32(_mm_unpackhi_epi16(b, zero), added));
    return true;
}

#endif

/// Emits all corners, of which no interior slot is dead. Most blocks of corners are of interior slots alone.
void emitAll(const uint16_t* corners, size_t count, uint32_t firstInterior, uint32_t shift, const uint32_t* rep,
             uint32_t* out) {
    size_t i = 0;
#ifdef __SSE2__
    for (; i + kBlock <= count && firstInterior <= UINT16_MAX; i += kBlock) {
        if (emitInterior(corners + i, firstInterior, shift, out + i)) continue;
        for (size_t k = i; k < i + kBlock; ++k) out[k] = rep[corners[k]];
    }
#endif
    for (; i < count; ++i) out[i] = rep[corners[i]];
    (void)firstInterior, (void)shift; // where there is no SSE2
}

void emitAll(const uint32_t* corners, size_t count, uint32_t, uint32_t, const uint32_t* rep, uint32_t* out) {
    for (size_t i = 0; i < count; ++i) out[i] = rep[corners[i]];
}

/// Emits the faces that are not degenerate.
template <typename Slot>
uint32_t emitSolid(const Slot* corners, size_t faceCount, const uint32_t* rep, uint32_t* out) {
    uint32_t* end = out;
    for (size_t f = 0; f < faceCount; ++f) {
        const uint32_t a = rep[corners[3 * f]], b = rep[corners[3 * f + 1]], c = rep[corners[3 * f + 2]];
        end[0] = a;
        end[1] = b;
        end[2] = c;
        // By arithmetic: compilers make a branch of a choice, and nothing predicts this one.
        end += 3 * (uint32_t(a != b) & uint32_t(b != c) & uint32_t(c != a));
    }
    return uint32_t(end - out);
}

template <typename Slot>
uint32_t build(const AssetView& asset, uint32_t patch, Levels levels, const Slot* parents, const Slot* corners,
               uint32_t* rep, uint32_t* out) {
    const DomainStates domains = resolveDomains(asset, patch, levels, parents, rep);
    const uint32_t level = levels[patch], firstInterior = domains.slotCount;
    const ListedFaces list = listFor(asset, patch, std::min(level, domains.leastLevel));

    const format::VertexRange interior = asset.interiorRange(patch);
    const uint32_t named = aliveCount(asset, interior, list.level), alive = aliveCount(asset, interior, level);
    resolve(parents + firstInterior, firstInterior, alive, {interior.first, named}, rep);

    corners += 3 * size_t(list.first);
    if (alive < named || domains.coarsestMoved > list.level) return emitSolid(corners, list.count, rep, out);
    emitAll(corners, 3 * size_t(list.count), firstInterior, interior.first - firstInterior, rep, out);
    return 3 * list.count;
}

/// A patch of a streamed asset, tier by tier, as far as it is there: no state that it allows names more.
template <typename Slot>
uint32_t buildResident(const AssetView& asset, uint32_t patch, Levels levels, uint32_t* rep, uint32_t* out) {
    const uint32_t tierCount = asset.tierCount(), tiers = asset.residence->tierCounts[patch];
    const format::PatchRecord& record = asset.patches[patch];
    const PatchPlace* places = asset.residence->places.data() + size_t(patch) * tierCount;
    const std::span<const uint32_t> domains = asset.domainsOf(patch), firsts = asset.domainSlotsOf(patch);
    const auto parentsOf = [&](uint32_t tier, uint32_t slot) {
        return reinterpret_cast<const Slot*>(places[tier].parents) + (slot - places[tier].firstSlot);
    };
    uint32_t least = levels[patch];
    for (size_t i = 0; i < domains.size(); ++i) {
        const uint32_t level = domainLevel(asset, domains[i], levels), tier = asset.domains[domains[i]].tier;
        least = std::min(least, level);
        if (tier >= tiers) continue;
        const format::VertexRange range = asset.domainRange(domains[i]);
        resolve(parentsOf(tier, firsts[i]), firsts[i], aliveCount(asset, range, level), range, rep);
    }
    const ListedFaces list = listFor(asset, patch, least);
    const uint32_t tier = asset.tierOf(list.level);
    assert(tier < tiers && "a level finer than AssetView::finestLevel");
    if (tier >= tiers || list.count == 0) return 0;
    const format::VertexRange interior = asset.interiorRange(patch);
    if (tiers == tierCount && interior.count > 0) {
        const uint32_t named = aliveCount(asset, interior, list.level), first = record.slotCount - interior.count;
        resolve(parentsOf(tierCount - 1, first), first, aliveCount(asset, interior, levels[patch]),
                {interior.first, named}, rep);
    }
    const Slot* corners = reinterpret_cast<const Slot*>(places[tier].corners);
    return emitSolid(corners + 3 * size_t(facesBefore(asset, patch, list)), list.count, rep, out);
}

} // namespace

uint32_t domainLevel(const AssetView& asset, uint32_t domain, Levels levels) {
    uint32_t level = format::kNever;
    for (const uint32_t patch : asset.patchesOf(domain)) level = std::min<uint32_t>(level, levels[patch]);
    return level;
}

uint32_t uniformTriangles(const AssetView& asset, uint32_t patch, uint32_t level) {
    if (asset.patchFaceCounts.empty()) return listFor(asset, patch, level).count;
    return asset.patchFaceCounts[size_t(patch) * asset.levelCount() + level];
}

uint32_t triangleBound(const AssetView& asset, uint32_t patch, Levels levels) {
    return uniformTriangles(asset, patch, finestGroup(asset, patch, levels));
}

uint32_t indexCapacity(const AssetView& asset, uint32_t patch, Levels levels) {
    return 3 * listFor(asset, patch, finestGroup(asset, patch, levels)).count;
}

uint32_t buildIndices(const AssetView& asset, uint32_t patch, Levels levels, std::span<uint32_t> scratch,
                      std::span<uint32_t> out) {
    const format::PatchRecord& record = asset.patches[patch];
    assert(levels.size() >= asset.patchCount());
    assert(scratch.size() >= record.slotCount);
    assert(out.size() >= indexCapacity(asset, patch, levels));
    if (asset.residence) {
        return record.flags & format::kWideSlots
                   ? buildResident<uint32_t>(asset, patch, levels, scratch.data(), out.data())
                   : buildResident<uint16_t>(asset, patch, levels, scratch.data(), out.data());
    }
    if (record.flags & format::kWideSlots) {
        return build(asset, patch, levels, asset.parentsWide.data() + record.firstParent,
                     asset.cornersWide.data() + record.firstCorner, scratch.data(), out.data());
    }
    return build(asset, patch, levels, asset.parentsNarrow.data() + record.firstParent,
                 asset.cornersNarrow.data() + record.firstCorner, scratch.data(), out.data());
}

bool patchDiffers(const AssetView& asset, uint32_t patch, uint32_t before, uint32_t after) {
    const format::VertexRange range = asset.interiorRange(patch);
    return before != after && aliveCount(asset, range, before) != aliveCount(asset, range, after);
}

bool domainDiffers(const AssetView& asset, uint32_t domain, Levels before, Levels after) {
    const uint32_t was = domainLevel(asset, domain, before), is = domainLevel(asset, domain, after);
    const format::VertexRange range = asset.domainRange(domain);
    return was != is && aliveCount(asset, range, was) != aliveCount(asset, range, is);
}

bool needsRebuild(const AssetView& asset, uint32_t patch, Levels before, Levels after) {
    if (patchDiffers(asset, patch, before[patch], after[patch])) return true;
    const auto differs = [&](uint32_t domain) { return domainDiffers(asset, domain, before, after); };
    const std::span<const uint32_t> domains = asset.domainsOf(patch);
    return std::any_of(domains.begin(), domains.end(), differs);
}

} // namespace xgc
