#include <xgc/indices.h>

#include <algorithm>
#include <cassert>

// A patch is drawn in two steps. First every slot gets its representative: the slots of each domain, widest first,
// then those of the interior. A parent always has a lower slot, and the rows alive at a level are a prefix of
// each range, so one pass forward resolves all chains:
//
//   slots  [ domain a      | domain b   | interior               ]
//   alive  [ #####.....    | ###....    | ##########............ ]     # : itself   . : rep[parent]
//
// Then faces are gathered through `rep`. They lie in bands of falling death level, so those that can be drawn are
// a prefix too; only the band that holds the level itself mixes dead and living faces and tests death bytes:
//
//   faces  [ band 0  | band 1  | band 2  | band 3 ]
//            alive     alive     death?    dead
//
// Faces that may touch a boundary can be degenerate before their death level (a domain's level differs from the
// patch's), so they are always tested.

namespace xgc {
namespace {

/// Rows of a range that are alive at a level: collapse levels fall within it.
uint32_t aliveCount(const AssetView& asset, format::VertexRange range, uint32_t level) {
    const uint8_t* first = asset.collapseLevels.data() + range.first;
    return uint32_t(std::partition_point(first, first + range.count, [&](uint8_t c) { return c > level; }) - first);
}

template <typename Slot>
void resolve(const Slot* parents, uint32_t firstSlot, uint32_t alive, format::VertexRange range, uint32_t* rep) {
    for (uint32_t k = 0; k < alive; ++k) rep[firstSlot + k] = range.first + k;
    for (uint32_t k = alive; k < range.count; ++k) rep[firstSlot + k] = rep[parents[firstSlot + k]];
}

/// Emits faces without a test.
template <typename Slot>
uint32_t* emitAll(const Slot* corners, uint32_t first, uint32_t last, const uint32_t* rep, uint32_t* out) {
    for (uint32_t i = 3 * first; i < 3 * last; ++i) *out++ = rep[corners[i]];
    return out;
}

/// Emits the faces that are alive by their death byte.
template <typename Slot>
uint32_t* emitLiving(const Slot* corners, const uint8_t* deaths, uint32_t first, uint32_t last, uint32_t level,
                     const uint32_t* rep, uint32_t* out) {
    for (uint32_t f = first; f < last; ++f) {
        out[0] = rep[corners[3 * f]];
        out[1] = rep[corners[3 * f + 1]];
        out[2] = rep[corners[3 * f + 2]];
        out += deaths[f] > level ? 3 : 0;
    }
    return out;
}

/// Emits the faces that are not degenerate.
template <typename Slot>
uint32_t* emitSolid(const Slot* corners, uint32_t first, uint32_t last, const uint32_t* rep, uint32_t* out) {
    for (uint32_t f = first; f < last; ++f) {
        const uint32_t a = rep[corners[3 * f]], b = rep[corners[3 * f + 1]], c = rep[corners[3 * f + 2]];
        out[0] = a;
        out[1] = b;
        out[2] = c;
        const bool solid = (a != b) & (b != c) & (c != a);
        out += solid ? 3 : 0;
    }
    return out;
}

/// Ends of the runs of faces that are wholly alive, and that hold all living ones, at a level.
struct LivingRuns {
    format::BandEnd whole{};
    format::BandEnd some{};
};

LivingRuns livingRuns(const AssetView& asset, uint32_t patch, uint32_t level) {
    const format::BandEnd* ends = asset.patchBands.data() + size_t(patch) * asset.record->bandCount;
    LivingRuns runs;
    uint32_t band = 0;
    for (; band < asset.record->bandCount && asset.bands[band] > level; ++band) runs.whole = ends[band];
    runs.some = band < asset.record->bandCount ? ends[band] : runs.whole;
    return runs;
}

template <typename Slot>
uint32_t build(const AssetView& asset, uint32_t patch, Levels levels, const Slot* parents, const Slot* corners,
               uint32_t* rep, uint32_t* out) {
    const format::PatchRecord& record = asset.patches[patch];
    uint32_t slot = 0;
    for (const uint32_t domain : asset.domainsOf(patch)) {
        const format::VertexRange range = asset.domainRange(domain);
        resolve(parents, slot, aliveCount(asset, range, domainLevel(asset, domain, levels)), range, rep);
        slot += range.count;
    }
    const uint32_t level = levels[patch];
    const format::VertexRange interior = asset.interiorRange(patch);
    resolve(parents, slot, aliveCount(asset, interior, level), interior, rep);

    const LivingRuns runs = livingRuns(asset, patch, level);
    const uint8_t* deaths = asset.deaths.data() + record.firstFace;
    uint32_t* end = emitAll(corners, 0, runs.whole.interior, rep, out);
    end = emitLiving(corners, deaths, runs.whole.interior, runs.some.interior, level, rep, end);
    const uint32_t boundary = record.interiorFaceCount;
    end = emitSolid(corners, boundary, boundary + runs.some.boundary, rep, end);
    return uint32_t(end - out);
}

} // namespace

uint32_t domainLevel(const AssetView& asset, uint32_t domain, Levels levels) {
    uint32_t level = format::kNever;
    for (const uint32_t patch : asset.patchesOf(domain)) level = std::min<uint32_t>(level, levels[patch]);
    return level;
}

uint32_t indexCapacity(const AssetView& asset, uint32_t patch, uint32_t level) {
    const LivingRuns runs = livingRuns(asset, patch, level);
    return 3 * (runs.some.interior + runs.some.boundary);
}

uint32_t buildIndices(const AssetView& asset, uint32_t patch, Levels levels, std::span<uint32_t> scratch,
                      std::span<uint32_t> out) {
    const format::PatchRecord& record = asset.patches[patch];
    assert(levels.size() >= asset.patchCount());
    assert(scratch.size() >= record.slotCount);
    assert(out.size() >= indexCapacity(asset, patch, levels[patch]));
    if (record.flags & format::kWideSlots) {
        return build(asset, patch, levels, asset.parentsWide.data() + record.firstParent,
                     asset.cornersWide.data() + record.firstCorner, scratch.data(), out.data());
    }
    return build(asset, patch, levels, asset.parentsNarrow.data() + record.firstParent,
                 asset.cornersNarrow.data() + record.firstCorner, scratch.data(), out.data());
}

bool patchDiffers(const AssetView& asset, uint32_t patch, uint32_t before, uint32_t after) {
    const auto [low, high] = std::minmax(before, after);
    if (low == high) return false;
    const format::VertexRange range = asset.interiorRange(patch);
    if (aliveCount(asset, range, low) != aliveCount(asset, range, high)) return true;
    // The same vertices: the same faces, unless a death byte says otherwise.
    const auto diesBetween = [low = low, high = high](uint8_t death) { return death > low && death <= high; };
    const LivingRuns fine = livingRuns(asset, patch, low), coarse = livingRuns(asset, patch, high);
    const uint8_t* deaths = asset.deaths.data() + asset.patches[patch].firstFace;
    const uint8_t* boundary = deaths + asset.patches[patch].interiorFaceCount;
    return std::any_of(deaths + coarse.whole.interior, deaths + fine.some.interior, diesBetween) ||
           std::any_of(boundary + coarse.some.boundary, boundary + fine.some.boundary, diesBetween);
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
