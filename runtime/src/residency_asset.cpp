#include "residency.h"
#include <algorithm>

// What a patch needs. A patch q at a level of tier t lowers the domains that it shares, and so the lists by which its
// neighbours draw: all of them must have their pages of the tiers up to t. Rows are needed of q's own domains alone:
// all of the others' that lie in tier t have collapsed, unless a patch is finer there that needs them itself.
//
//     needs(q, t)  =  the pages of (p, t), for q itself and each p that shares a domain with it,
//                     and the pages of the domains of q in tier t
//
// So whether q may be at a tier depends on no other patch's level, and any choice of levels that each patch may have is
// a state that can be drawn. Rows that are not there are dead: their range names rows behind the pool's that are so at
// every level.

namespace xgc {
namespace {

using namespace format;

/// Turns counts (runs.firsts[i + 1]: items of run i) into runs with room for the items.
bool makeRoom(Runs& runs) {
    uint64_t total = 0;
    for (size_t i = 0; i < runs.firsts.size(); ++i) runs.firsts[i] = uint32_t(total += runs.firsts[i]);
    return total <= UINT32_MAX && runs.items.allocate(total);
}

/// Each page that (patch, tier) needs, once where `marks` has no `stamp` yet.
template <typename Visit>
void forNeeds(const StreamedAsset& a, uint32_t patch, uint32_t tier, FixedArray<uint32_t>& marks, uint32_t stamp,
              const Visit& visit) {
    const auto touch = [&](uint32_t page) {
        if (marks[page] == stamp) return;
        marks[page] = stamp;
        visit(page);
    };
    touch(a.pageOf(patch, tier));
    for (const uint32_t d : a.tables.domainsOf(patch)) {
        if (a.tables.domains[d].tier == tier) touch(a.rangePages[d]);
        for (const uint32_t p : a.tables.patchesOf(d)) touch(a.pageOf(p, tier));
    }
}

} // namespace

bool StreamedAsset::allocate() {
    const size_t patches = tables.patchCount(), entries = tables.patchPages.size(), pageCount = tables.pages.size();
    return contents.allocate(pageCount) && rangePages.allocate(tables.vertexRanges.size()) &&
           rangeRows.allocate(tables.vertexRanges.size()) && patchTiers.allocate(entries) &&
           pages.allocate(pageCount) && ranges.allocate(tables.vertexRanges.size()) && places.allocate(entries) &&
           tierCounts.allocate(patches) && finestLevels.allocate(patches) && stamps.allocate(patches) &&
           urgency.allocate(patches) && drawnTier.allocate(patches) && needs.firsts.allocate(entries + 1) &&
           dependents.firsts.allocate(pageCount + 1) && pageRanges.firsts.allocate(pageCount + 1) &&
           pagePatches.firsts.allocate(pageCount + 1);
}

bool StreamedAsset::listMembers() {
    for (uint32_t r = 0; r < rangePages.size(); ++r) ++pageRanges.firsts[rangePages[r] + 1];
    for (const PatchTier& tier : std::span(patchTiers.data(), patchTiers.size())) ++pagePatches.firsts[tier.page + 1];
    FixedArray<uint32_t> next;
    if (!makeRoom(pageRanges) || !makeRoom(pagePatches) || !next.allocate(pages.size())) return false;
    std::copy_n(pageRanges.firsts.data(), pages.size(), next.data());
    for (uint32_t r = 0; r < rangePages.size(); ++r) pageRanges.items[next[rangePages[r]]++] = r;
    std::copy_n(pagePatches.firsts.data(), pages.size(), next.data());
    for (uint32_t i = 0; i < patchTiers.size(); ++i) {
        pagePatches.items[next[patchTiers[i].page]++] = i / tables.tierCount();
    }
    return true;
}

bool StreamedAsset::findNeeds() {
    const uint32_t tierCount = tables.tierCount();
    FixedArray<uint32_t> marks, next;
    if (!marks.allocate(pages.size()) || !next.allocate(pages.size())) return false;
    uint32_t stamp = 0;
    const auto forEach = [&](const auto& visit) {
        for (uint32_t p = 0; p < tables.patchCount(); ++p) {
            for (uint32_t t = 0; t < tierCount; ++t) {
                const uint32_t entry = p * tierCount + t;
                forNeeds(*this, p, t, marks, ++stamp, [&](uint32_t page) { visit(entry, page); });
            }
        }
    };
    forEach([&](uint32_t entry, uint32_t page) {
        ++needs.firsts[entry + 1];
        ++dependents.firsts[page + 1];
    });
    if (!makeRoom(needs) || !makeRoom(dependents)) return false;
    std::copy_n(dependents.firsts.data(), pages.size(), next.data());
    uint32_t item = 0; // entries come in order
    forEach([&](uint32_t entry, uint32_t page) {
        needs.items[item++] = page;
        dependents.items[next[page]++] = entry / tierCount;
    });
    return true;
}

Status StreamedAsset::create(const AssetView& of, std::span<const uint8_t> collapseLevels, uint32_t firstDeadRow) {
    tables = of;
    deadRow = firstDeadRow;
    const Status noMemory = {StatusCode::outOfCapacity, "not enough memory for the asset's tables", 0};
    if (!allocate()) return noMemory;
    const PageMap map = {{contents.data(), contents.size()},
                         {rangePages.data(), rangePages.size()},
                         {rangeRows.data(), rangeRows.size()},
                         {patchTiers.data(), patchTiers.size()}};
    mapPages(tables, map);
    if (Status s = checkPageContents(tables, map); !s.ok()) return s;
    if (!listMembers() || !findNeeds()) return noMemory;
    for (const PageRecord& page : tables.pages) missingFirst += page.tier == 0;
    std::fill_n(finestLevels.data(), finestLevels.size(), uint8_t(tables.levelCount() - 1));
    for (size_t r = 0; r < ranges.size(); ++r) ranges[r] = {deadRow, tables.vertexRanges[r].count};
    residence = {{places.data(), places.size()},
                 {tierCounts.data(), tierCounts.size()},
                 {finestLevels.data(), finestLevels.size()},
                 {stamps.data(), stamps.size()}};
    view = tables;
    view.vertexRanges = {ranges.data(), ranges.size()};
    view.collapseLevels = collapseLevels;
    view.residence = &residence;
    return {};
}

void StreamedAsset::refresh(uint32_t page, bool rowsMoved) {
    const uint32_t tierCount = tables.tierCount();
    for (const uint32_t p : dependents.of(page)) {
        uint32_t readable = 0, usable = 0;
        while (readable < tierCount && isThere(pageOf(p, readable))) ++readable;
        const auto stays = [&](uint32_t need) { return pages[need].state == PageState::installed; };
        const auto has = [&](uint32_t tier) {
            const std::span<const uint32_t> need = needsOf(p, tier);
            return std::all_of(need.begin(), need.end(), stays);
        };
        while (usable + 1 < tierCount && has(usable + 1)) ++usable;
        tierCounts[p] = uint8_t(readable);
        finestLevels[p] = missingFirst > 0 ? uint8_t(tables.levelCount() - 1) : tables.tierLevels[usable];
        stamps[p] += rowsMoved;
    }
}

} // namespace xgc
