#include "open.h"
#include "rows.h"

#include <algorithm>
#include <cmath>

// What makes the tables of vertices safe to follow without a test, and one genealogy for all patches:
//
// - collapse levels fall within each vertex range, so the rows alive at a level are a prefix;
// - a parent has a lower slot than its child (or the child's own, in rows that never collapse), so one pass
//   forward resolves all chains;
// - a parent lies in a domain that includes the child's (in the same group, a lower slot cannot collapse earlier);
// - all patches of a domain agree on the parents of its rows: the first patch of the domain tells them.
//
// Slots of a patch are numbered range by range, its domains rising and then its interior; `Slots` turns a slot
// back into its range and row by binary search.

namespace xgc {
namespace {

using namespace format;

/// Vertex row of a slot, and its range: the n-th domain of the patch, or the domain count for its interior.
struct Place {
    uint32_t range;
    uint32_t row;
};

class Slots {
public:
    Slots(const AssetView& view, uint32_t patch)
        : view_(view), record_(view.patches[patch]), domains_(view.domainsOf(patch)),
          firsts_(view.domainSlotsOf(patch)), interior_(view.interiorRange(patch)),
          firstInterior_(record_.slotCount - interior_.count) {}

    uint32_t rangeCount() const { return uint32_t(domains_.size()) + 1; }
    uint32_t domain(uint32_t range) const { return domains_[range]; }
    bool isInterior(uint32_t range) const { return range == domains_.size(); }
    VertexRange rows(uint32_t range) const {
        return isInterior(range) ? interior_ : view_.domainRange(domains_[range]);
    }
    uint32_t firstSlot(uint32_t range) const { return isInterior(range) ? firstInterior_ : firsts_[range]; }
    uint32_t parent(uint32_t slot) const {
        return record_.flags & kWideSlots ? view_.parentsWide[record_.firstParent + size_t(slot)]
                                          : view_.parentsNarrow[record_.firstParent + size_t(slot)];
    }
    /// `hint`: a range to try first.
    Place place(uint32_t slot, uint32_t hint) const {
        if (slot - firstSlot(hint) < rows(hint).count) return {hint, rows(hint).first + (slot - firstSlot(hint))};
        if (slot >= firstInterior_) return {uint32_t(domains_.size()), interior_.first + (slot - firstInterior_)};
        const auto after = std::upper_bound(firsts_.begin(), firsts_.end(), slot);
        const auto range = uint32_t(after - firsts_.begin()) - 1;
        return {range, view_.domainRange(domains_[range]).first + (slot - firsts_[range])};
    }
    uint32_t rangeOf(uint32_t domain) const {
        return uint32_t(std::lower_bound(domains_.begin(), domains_.end(), domain) - domains_.begin());
    }

private:
    const AssetView& view_;
    const PatchRecord& record_;
    std::span<const uint32_t> domains_;
    std::span<const uint32_t> firsts_;
    VertexRange interior_;
    uint32_t firstInterior_;
};

Status checkPositions(const AssetView& v) {
    for (size_t i = 0; i < v.positions.size(); ++i) {
        const glm::vec3& p = v.positions[i];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return corrupt("vertex row with a position that is not finite", i);
    }
    return {};
}

Status checkLevels(const AssetView& v) {
    for (const VertexRange& range : v.vertexRanges) {
        uint8_t before = kNever;
        for (uint32_t row = range.first; row < range.first + range.count; ++row) {
            const uint8_t level = v.collapseLevels[row];
            if (level == 0 || (level >= v.record->levelCount && level != kNever))
                return corrupt("vertex row with a collapse level out of range", row);
            if (level > before) return corrupt("vertex row whose collapse level does not fall", row);
            before = level;
        }
    }
    for (size_t row = 0; row < v.birthLevels.size(); ++row) {
        if (v.birthLevels[row] >= v.record->levelCount || v.birthLevels[row] > v.collapseLevels[row])
            return corrupt("vertex row with a birth level out of range", row);
    }
    return {};
}

bool includes(std::span<const uint32_t> wide, std::span<const uint32_t> narrow) {
    return std::all_of(narrow.begin(), narrow.end(),
                       [&](uint32_t p) { return std::binary_search(wide.begin(), wide.end(), p); });
}

/// A parent against its child, told by the first patch of the child's domain (or by the patch of an interior).
Status checkStep(const AssetView& v, const Slots& slots, Place child, Place parent) {
    const uint8_t level = v.collapseLevels[child.row];
    if (!v.birthLevels.empty() && v.birthLevels[parent.row] > level)
        return corrupt("vertex row whose parent is born after it collapses", child.row);
    // A domain of the patch holds the patch, so the interior's set is included in any of them.
    if (parent.range != child.range && !slots.isInterior(child.range) &&
        !includes(v.patchesOf(slots.domain(parent.range)), v.patchesOf(slots.domain(child.range))))
        return corrupt("vertex row whose parent has no wider domain", child.row);
    return {};
}

/// The rows of one range of a patch. `teller`: the slots of the first patch of the domain.
Status checkParents(const AssetView& v, const Slots& slots, uint32_t range, const Slots& teller, bool isTeller) {
    const VertexRange rows = slots.rows(range);
    const uint32_t first = slots.firstSlot(range);
    const uint32_t tellerRange = isTeller ? range : teller.rangeOf(slots.domain(range));
    uint32_t hint = range, tellerHint = tellerRange;
    for (uint32_t k = 0; k < rows.count; ++k) {
        const uint32_t slot = first + k, parentSlot = slots.parent(slot);
        const Place child = {range, rows.first + k};
        const bool isRoot = v.collapseLevels[child.row] == kNever;
        if (parentSlot > slot || (parentSlot == slot) != isRoot)
            return corrupt("vertex row with a wrong parent slot", child.row);
        if (isRoot) continue;
        const Place parent = slots.place(parentSlot, parentSlot >= first ? range : hint);
        hint = parent.range;
        if (isTeller) {
            if (Status s = checkStep(v, slots, child, parent); !s.ok()) return s;
            continue;
        }
        const Place told = teller.place(teller.parent(teller.firstSlot(tellerRange) + k), tellerHint);
        tellerHint = told.range;
        if (told.row != parent.row) return corrupt("vertex row on whose parent two patches differ", child.row);
    }
    return {};
}

Status checkGenealogy(const AssetView& v) {
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        const Slots slots(v, p);
        for (uint32_t range = 0; range < slots.rangeCount(); ++range) {
            const uint32_t first = slots.isInterior(range) ? p : v.patchesOf(slots.domain(range)).front();
            if (Status s = checkParents(v, slots, range, Slots(v, first), first == p); !s.ok()) return s;
        }
    }
    return {};
}

/// Each list names slots of domains, and of the interior those alive at its level alone.
template <typename Slot>
bool cornersInRange(const AssetView& v, uint32_t p, std::span<const Slot> corners) {
    const VertexRange interior = v.interiorRange(p);
    const uint32_t firstInterior = v.patches[p].slotCount - interior.count;
    for (const FaceList& list : v.listsOf(p)) {
        const size_t count = 3 * size_t(list.faceCount);
        Slot largest = 0;
        for (const Slot c : corners.first(count)) largest = std::max(largest, c);
        if (count > 0 && largest >= firstInterior + aliveCount(v, interior, list.level)) return false;
        corners = corners.subspan(count);
    }
    return true;
}

Status checkCorners(const AssetView& v) {
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        const PatchRecord& patch = v.patches[p];
        const size_t count = 3 * size_t(patch.listedFaceCount);
        const bool inRange = patch.flags & kWideSlots
                                 ? cornersInRange(v, p, v.cornersWide.subspan(patch.firstCorner, count))
                                 : cornersInRange(v, p, v.cornersNarrow.subspan(patch.firstCorner, count));
        if (!inRange) return corrupt("patch with a corner past the slots of its list", p);
    }
    return {};
}

} // namespace

Status checkPage(const AssetView& view) {
    for (Status (*check)(const AssetView&) : {checkPositions, checkLevels, checkGenealogy, checkCorners}) {
        if (Status s = check(view); !s.ok()) return s;
    }
    return checkSkinRows(view, {view.vertexStreams.data(), view.vertexStreamCount}, view.record->vertexCount);
}

} // namespace xgc
