#include "bake/layout.h"

#include <algorithm>
#include <array>

// A patch numbers its vertices by slots: the rows of its domains in their order, then those of its interior.

namespace xgc::bake::layout {
namespace {

/// Rows of one patch at a time to its slots.
class SlotMap {
public:
    SlotMap(const Hierarchy& h, const Domains& domains, const Rows& rows)
        : h_(h), domains_(domains), rows_(rows), firstSlot_(rows.ranges.size(), 0) {}

    /// Returns the slot count; appends the first slot of each domain.
    uint32_t enter(uint32_t patch, std::vector<uint32_t>& patchSlots) {
        uint32_t slot = 0;
        for (const uint32_t d : domains_.ofPatch[patch]) {
            patchSlots.push_back(slot);
            firstSlot_[d] = slot;
            slot += rows_.ranges[d].count;
        }
        const size_t interior = domains_.sets.size() + patch;
        firstSlot_[interior] = slot;
        return slot + rows_.ranges[interior].count;
    }
    uint32_t slotOf(uint32_t wedge) const {
        const uint32_t group = domains_.groupOf[h_.wedgePosition[wedge]];
        return firstSlot_[group] + rows_.rowOf[wedge] - rows_.ranges[group].first;
    }

private:
    const Hierarchy& h_;
    const Domains& domains_;
    const Rows& rows_;
    std::vector<uint32_t> firstSlot_;
};

template <typename Slot>
void appendParents(const Hierarchy& h, const Rows& rows, format::VertexRange range, const SlotMap& map,
                   std::vector<Slot>& parents) {
    for (uint32_t row = range.first; row < range.first + range.count; ++row) {
        const uint32_t wedge = rows.wedgeOf[row];
        const uint32_t parent = h.wedgeParent[wedge];
        parents.push_back(Slot(map.slotOf(parent == kNone ? wedge : parent)));
    }
}

template <typename Slot>
void appendCorners(const glm::uvec3& triangle, const SlotMap& map, std::vector<Slot>& corners) {
    // From the lowest slot on, so that codecs need not tell where a face starts.
    std::array<uint32_t, 3> face{};
    for (int k = 0; k < 3; ++k) face[k] = map.slotOf(triangle[k]);
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    for (const uint32_t slot : face) corners.push_back(Slot(slot));
}

template <typename Slot>
void appendPatch(const Hierarchy& h, const Domains& domains, const Faces& faces, const Rows& rows, uint32_t patch,
                 const SlotMap& map, std::vector<Slot>& parents, std::vector<Slot>& corners) {
    for (const uint32_t d : domains.ofPatch[patch]) appendParents(h, rows, rows.ranges[d], map, parents);
    appendParents(h, rows, rows.ranges[domains.sets.size() + patch], map, parents);
    for (const FacesOfLevel& list : faces.lists[patch]) {
        for (const glm::uvec3& triangle : list.triangles) appendCorners(triangle, map, corners);
    }
}

} // namespace

Slots numberSlots(const Hierarchy& h, const Domains& domains, const Faces& faces, const Rows& rows) {
    Slots slots;
    SlotMap map(h, domains, rows);
    for (uint32_t p = 0; p < h.patches.size(); ++p) {
        Slots::PatchRun run;
        run.slotCount = map.enter(p, slots.patchSlots);
        run.wide = run.slotCount > 65536;
        run.firstParent = uint32_t(run.wide ? slots.parentsWide.size() : slots.parentsNarrow.size());
        run.firstCorner = uint32_t(run.wide ? slots.cornersWide.size() : slots.cornersNarrow.size());
        if (run.wide) {
            appendPatch(h, domains, faces, rows, p, map, slots.parentsWide, slots.cornersWide);
        } else {
            appendPatch(h, domains, faces, rows, p, map, slots.parentsNarrow, slots.cornersNarrow);
        }
        slots.patches.push_back(run);
    }
    return slots;
}

} // namespace xgc::bake::layout
