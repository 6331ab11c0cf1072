#include "residency.h"

#include "open.h"
#include "rows.h"
#include "xxh64.h"

#include <algorithm>
#include <array>
#include <cmath>

// What a page must be for its arrays to be followed without a test, as openAll has it for a whole file: collapse levels
// that fall within each range, parents with lower slots, corners within the slots of their list. A row is its own
// parent exactly where it never collapses, and such rows lie in tier 0. There, parents and the rows of their slots may
// come in different pages, so that is looked at for each patch when the last of its pages of that tier comes.

namespace xgc {
namespace {

using namespace format;

/// The streams of a page that the core reads, and its positions.
struct Streams {
    std::span<const std::byte> positions, collapse, births, narrowParents, wideParents, narrowCorners, wideCorners;
};

Streams streamsOf(const AssetView& v, uint32_t page, std::span<const std::byte> bytes) {
    Streams out;
    forStreams(v, page, bytes, [&](const StreamRecord& s, std::span<const std::byte> elements) {
        if (s.kind == StreamKind::position) out.positions = elements;
        if (s.kind == StreamKind::collapseLevel) out.collapse = elements;
        if (s.kind == StreamKind::birthLevel) out.births = elements;
        if (s.kind == StreamKind::parentNarrow) out.narrowParents = elements;
        if (s.kind == StreamKind::parentWide) out.wideParents = elements;
        if (s.kind == StreamKind::cornerNarrow) out.narrowCorners = elements;
        if (s.kind == StreamKind::cornerWide) out.wideCorners = elements;
    });
    return out;
}

template <typename T>
const T* as(std::span<const std::byte> bytes) {
    return reinterpret_cast<const T*>(bytes.data());
}

Status checkRows(const StreamedAsset& a, uint32_t page, const Streams& streams) {
    const float* position = as<float>(streams.positions);
    for (size_t i = 0; i < 3 * size_t(a.contents[page].rows); ++i) {
        if (!std::isfinite(position[i])) return corrupt("page with a position that is not finite", page);
    }
    const uint8_t* levels = as<uint8_t>(streams.collapse);
    for (const uint32_t r : a.pageRanges.of(page)) {
        uint8_t before = kNever;
        for (uint32_t i = 0; i < a.tables.vertexRanges[r].count; ++i) {
            const uint8_t level = levels[size_t(a.rangeRows[r]) + i];
            const bool known = level < a.tables.levelCount() || (level == kNever && a.tables.pages[page].tier == 0);
            if (level == 0 || !known || level > before)
                return corrupt("page with collapse levels that do not fall or are out of range", page);
            before = level;
        }
    }
    return {};
}

/// Slots that a list may name: those of the tiers up to its own, of the interior those alive at its level.
uint32_t slotEnd(const StreamedAsset& a, uint32_t p, uint32_t tier, uint32_t level, const Streams& streams) {
    const PatchTier& t = a.patchTiers[size_t(p) * a.tables.tierCount() + tier];
    const uint32_t end = t.firstSlot + t.slotCount;
    if (tier + 1 < a.tables.tierCount()) return end;
    const size_t range = size_t(a.tables.record->domainCount) + p;
    const uint32_t count = a.tables.vertexRanges[range].count;
    const uint8_t* first = as<uint8_t>(streams.collapse) + a.rangeRows[range];
    const auto alive = std::partition_point(first, first + count, [&](uint8_t c) { return c > level; }) - first;
    return end - count + uint32_t(alive);
}

template <typename Slot>
Status checkPatch(const StreamedAsset& a, uint32_t page, uint32_t p, const Slot* parents, const Slot* corners,
                  const Streams& streams) {
    const uint32_t tier = a.tables.pages[page].tier;
    const PatchTier& t = a.patchTiers[size_t(p) * a.tables.tierCount() + tier];
    for (uint32_t i = 0; i < t.slotCount; ++i) {
        const Slot parent = parents[t.firstParent + size_t(i)];
        if (tier == 0 ? parent > t.firstSlot + i : parent >= t.firstSlot + i)
            return corrupt("page with a parent behind its child", page);
    }
    corners += 3 * size_t(t.firstFace);
    for (uint32_t i = t.firstList; i < t.firstList + t.listCount; ++i) {
        const FaceList& list = a.tables.listsOf(p)[i];
        const uint32_t end = slotEnd(a, p, tier, list.level, streams);
        const size_t count = 3 * size_t(list.faceCount);
        if (std::any_of(corners, corners + count, [&](Slot c) { return c >= end; }))
            return corrupt("page with a corner past the slots of its list", page);
        corners += count;
    }
    return {};
}

/// As checkSkinRows does for a whole file.
Status checkJoints(const StreamedAsset& a, uint32_t page, std::span<const std::byte> bytes) {
    if (a.tables.joints.empty() || a.contents[page].rows == 0) return {};
    std::array<VertexStream, AssetView::kMaxVertexStreams> streams;
    uint32_t count = 0;
    forStreams(a.tables, page, bytes, [&](const StreamRecord& s, std::span<const std::byte> elements) {
        const bool ofSkin = s.kind == StreamKind::joints || s.kind == StreamKind::weights;
        if (ofSkin && count < streams.size()) streams[count++] = {s.kind, s.format, s.set, s.stride, s.count, elements};
    });
    Status status = checkSkinRows(a.tables, {streams.data(), count}, a.contents[page].rows);
    status.element = page;
    return status;
}

bool isWide(const StreamedAsset& a, uint32_t p) {
    return a.tables.patches[p].flags & kWideSlots;
}

Status checkPatches(const StreamedAsset& a, uint32_t page, const Streams& s) {
    for (const uint32_t p : a.pagePatches.of(page)) {
        const Status status =
            isWide(a, p) ? checkPatch(a, page, p, as<uint32_t>(s.wideParents), as<uint32_t>(s.wideCorners), s)
                         : checkPatch(a, page, p, as<uint16_t>(s.narrowParents), as<uint16_t>(s.narrowCorners), s);
        if (!status.ok()) return status;
    }
    return {};
}

Status check(const StreamedAsset& a, uint32_t page, std::span<const std::byte> bytes, const Streams& streams) {
    const PageRecord& record = a.tables.pages[page];
    const std::span<const StreamRecord> records = a.tables.streams.subspan(record.firstStream, record.streamCount);
    const bool coded =
        std::any_of(records.begin(), records.end(), [](const StreamRecord& s) { return s.codec != Codec::none; });
    // The checksum of what was compressed is decodePage's to test.
    if (!coded && xxh64(bytes) != record.checksum)
        return {StatusCode::badChecksum, "the page was altered on its way: it is read again; else copy the file again",
                page};
    if (Status s = checkRows(a, page, streams); !s.ok()) return s;
    if (Status s = checkJoints(a, page, bytes); !s.ok()) return s;
    return checkPatches(a, page, streams);
}

template <typename Slot>
bool rootsFit(const StreamedAsset& a, uint32_t firstSlot, VertexRange range, const PatchPlace& place) {
    const Slot* parents = reinterpret_cast<const Slot*>(place.parents) + firstSlot; // tier 0 has the first slots
    for (uint32_t k = 0; k < range.count; ++k) {
        const bool isRoot = a.view.collapseLevels[size_t(range.first) + k] == kNever;
        if ((parents[k] == firstSlot + k) != isRoot) return false;
    }
    return true;
}

/// In tier 0, of which all pages are there that the patch reads.
bool rootsFit(const StreamedAsset& a, uint32_t p) {
    const PatchPlace& place = a.places[size_t(p) * a.tables.tierCount()];
    const std::span<const uint32_t> domains = a.tables.domainsOf(p), firsts = a.tables.domainSlotsOf(p);
    for (size_t i = 0; i < domains.size(); ++i) {
        if (a.tables.domains[domains[i]].tier > 0) break; // they never fall
        const VertexRange range = a.ranges[domains[i]];
        const bool fits = isWide(a, p) ? rootsFit<uint32_t>(a, firsts[i], range, place)
                                       : rootsFit<uint16_t>(a, firsts[i], range, place);
        if (!fits) return false;
    }
    return true;
}

/// All that the patch reads in tier 0 is there.
bool isFirstThere(const StreamedAsset& a, uint32_t p) {
    const std::span<const uint32_t> needs = a.needsOf(p, 0);
    return std::all_of(needs.begin(), needs.end(), [&](uint32_t page) { return a.isThere(page); });
}

void enter(StreamedAsset& a, uint32_t page, const Streams& streams, uint32_t firstRow, std::span<uint8_t> collapse) {
    std::copy_n(as<uint8_t>(streams.collapse), a.contents[page].rows, collapse.data());
    for (const uint32_t r : a.pageRanges.of(page)) {
        a.ranges[r] = {firstRow + a.rangeRows[r], a.tables.vertexRanges[r].count};
    }
    const uint32_t tier = a.tables.pages[page].tier;
    for (const uint32_t p : a.pagePatches.of(page)) {
        const size_t entry = size_t(p) * a.tables.tierCount() + tier;
        const PatchTier& t = a.patchTiers[entry];
        const size_t stride = isWide(a, p) ? 4 : 2;
        const std::span<const std::byte> parents = isWide(a, p) ? streams.wideParents : streams.narrowParents;
        const std::span<const std::byte> corners = isWide(a, p) ? streams.wideCorners : streams.narrowCorners;
        a.places[entry] = {parents.data() + t.firstParent * stride, corners.data() + 3 * size_t(t.firstFace) * stride,
                           t.firstSlot};
    }
}

void leave(StreamedAsset& a, uint32_t page) {
    for (const uint32_t r : a.pageRanges.of(page)) a.ranges[r].first = a.deadRow;
    for (const uint32_t p : a.pagePatches.of(page)) {
        a.places[size_t(p) * a.tables.tierCount() + a.tables.pages[page].tier] = {};
    }
    a.pages[page].state = PageState::absent;
}

} // namespace

Status installPage(StreamedAsset& a, uint32_t page, std::span<const std::byte> bytes, uint32_t firstRow,
                   std::span<uint8_t> collapse) {
    const Streams streams = streamsOf(a.tables, page, bytes);
    if (Status s = check(a, page, bytes, streams); !s.ok()) return s;
    enter(a, page, streams, firstRow, collapse);
    a.pages[page].state = PageState::installed;
    const uint32_t tier = a.tables.pages[page].tier;
    for (const uint32_t p : a.dependents.of(page)) {
        if (tier > 0 || !isFirstThere(a, p) || rootsFit(a, p)) continue;
        leave(a, page);
        return corrupt("page with a wrong parent: bake the file again", page);
    }
    const bool ready = tier == 0 && --a.missingFirst == 0;
    a.refresh(page, true);
    for (uint32_t i = 0; ready && i < a.pages.size(); ++i) a.refresh(i, false);
    return {};
}

void removePage(StreamedAsset& a, uint32_t page) {
    leave(a, page);
    a.refresh(page, true);
}

} // namespace xgc
