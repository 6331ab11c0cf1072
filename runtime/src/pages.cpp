#include <xgc/pages.h>

#include "open.h"

#include <algorithm>
#include <cassert>

namespace xgc {
namespace {

using namespace format;

void mapRows(const AssetView& v, const PageMap& map) {
    const uint32_t tierCount = v.tierCount(), domainCount = v.record->domainCount;
    for (uint32_t range = 0; range < v.vertexRanges.size(); ++range) {
        const bool isDomain = range < domainCount;
        const uint32_t patch = isDomain ? v.patchesOf(range).front() : range - domainCount;
        const uint32_t tier = isDomain ? v.domains[range].tier : tierCount - 1;
        const uint32_t page = v.patchPages[size_t(patch) * tierCount + tier];
        map.rangePages[range] = page;
        map.rangeRows[range] = map.pages[page].rows;
        map.pages[page].rows += v.vertexRanges[range].count;
    }
}

/// Slots of a patch are tier by tier, as its domains are; its interior is last.
void countSlots(const AssetView& v, uint32_t patch, std::span<PatchTier> tiers) {
    const auto count = [&](uint32_t tier, uint32_t slots) { tiers[tier].slotCount += slots; };
    for (const uint32_t d : v.domainsOf(patch)) count(v.domains[d].tier, v.domainRange(d).count);
    count(uint32_t(tiers.size()) - 1, v.interiorRange(patch).count);
    uint32_t slot = 0;
    for (PatchTier& tier : tiers) {
        tier.firstSlot = slot;
        slot += tier.slotCount;
    }
}

/// Lists are the finest first, so those of a tier lie before those of the coarser ones.
void countFaces(const AssetView& v, uint32_t patch, std::span<PatchTier> tiers) {
    const std::span<const FaceList> lists = v.listsOf(patch);
    for (uint32_t i = 0; i < lists.size() && lists[i].level != kNever; ++i) {
        PatchTier& tier = tiers[v.tierOf(lists[i].level)];
        if (tier.listCount++ == 0) tier.firstList = i;
        tier.faceCount += lists[i].faceCount;
    }
}

} // namespace

void mapPages(const AssetView& v, const PageMap& map) {
    assert(map.pages.size() == v.pages.size() && map.patchTiers.size() == v.patchPages.size());
    assert(map.rangePages.size() == v.vertexRanges.size() && map.rangeRows.size() == v.vertexRanges.size());
    std::fill(map.pages.begin(), map.pages.end(), PageContents{});
    mapRows(v, map);
    for (uint32_t p = 0; p < v.patchCount(); ++p) {
        const std::span<PatchTier> tiers = map.patchTiers.subspan(size_t(p) * v.tierCount(), v.tierCount());
        std::fill(tiers.begin(), tiers.end(), PatchTier{});
        countSlots(v, p, tiers);
        countFaces(v, p, tiers);
        const bool wide = v.patches[p].flags & kWideSlots;
        for (uint32_t t = 0; t < tiers.size(); ++t) {
            tiers[t].page = v.patchPages[size_t(p) * v.tierCount() + t];
            PageContents& page = map.pages[tiers[t].page];
            uint64_t &slots = wide ? page.wideSlots : page.narrowSlots,
                     &faces = wide ? page.wideFaces : page.narrowFaces;
            tiers[t].firstParent = uint32_t(slots);
            tiers[t].firstFace = uint32_t(faces);
            slots += tiers[t].slotCount;
            faces += tiers[t].faceCount;
        }
    }
}

Status checkPageContents(const AssetView& v, const PageMap& map) {
    for (size_t i = 0; i < v.pages.size(); ++i) {
        const PageContents& has = map.pages[i];
        uint64_t positions = 0, collapses = 0, narrowSlots = 0, wideSlots = 0, narrowCorners = 0, wideCorners = 0;
        for (const StreamRecord& s : v.streams.subspan(v.pages[i].firstStream, v.pages[i].streamCount)) {
            const bool single = s.kind == StreamKind::position || s.kind == StreamKind::collapseLevel ||
                                s.kind == StreamKind::birthLevel ||
                                (s.kind >= StreamKind::parentNarrow && s.kind <= StreamKind::cornerWide);
            if (single && s.set != 0) return corrupt("page with two streams of a kind that comes once", i);
            if (s.kind < StreamKind::parentNarrow && s.count != has.rows)
                return corrupt("page with a stream of another count than its vertex rows", i);
            if (s.kind == StreamKind::position) positions = s.count;
            if (s.kind == StreamKind::collapseLevel) collapses = s.count;
            if (s.kind == StreamKind::parentNarrow) narrowSlots = s.count;
            if (s.kind == StreamKind::parentWide) wideSlots = s.count;
            if (s.kind == StreamKind::cornerNarrow) narrowCorners = s.count;
            if (s.kind == StreamKind::cornerWide) wideCorners = s.count;
        }
        if (positions != has.rows || collapses != has.rows)
            return corrupt("page without a position and a collapse level for each of its rows", i);
        if (narrowSlots != has.narrowSlots || wideSlots != has.wideSlots)
            return corrupt("page without a parent for each of its slots", i);
        if (narrowCorners != 3 * has.narrowFaces || wideCorners != 3 * has.wideFaces)
            return corrupt("page without three corners for each of its faces", i);
    }
    return {};
}

} // namespace xgc
