#pragma once

#include "memory.h"
#include "open.h"

#include <xgc/residency.h>

#include <atomic>

namespace xgc {

/// Runs of numbers, one behind the other: run i is items[firsts[i] .. firsts[i + 1]).
struct Runs {
    FixedArray<uint32_t> firsts, items;

    std::span<const uint32_t> of(size_t i) const { return {items.data() + firsts[i], firsts[i + 1] - firsts[i]}; }
};

enum class PageState : uint8_t {
    absent,
    reading,
    installed,
    retiring, ///< no selection may count on it; still drawn from
};

struct StreamedPage {
    PageState state = PageState::absent;
    bool givenUp = false;
    uint32_t failures = 0;
    uint32_t slot = format::kNone;
    uint64_t nextTry = 0;
    uint64_t lastDrawn = 0, lastWanted = 0; ///< frames
    float value = 0; ///< error without it, in multiples of the error asked for; 0: nobody wants it
};

/// An asset and how much of it is there.
struct StreamedAsset : Allocated<StreamedAsset> {
    AssetView tables;
    AssetView view;
    Residence residence;

    // Of the tables.
    FixedArray<PageContents> contents;
    FixedArray<uint32_t> rangePages, rangeRows;
    FixedArray<PatchTier> patchTiers;
    Runs needs;       ///< patch * tierCount + tier: pages that must be there for the patch to be at the tier
    Runs dependents;  ///< page: patches that need it
    Runs pageRanges;  ///< page: vertex ranges whose rows it has
    Runs pagePatches; ///< page: patches whose tier it has

    // What is there.
    FixedArray<StreamedPage> pages;
    FixedArray<format::VertexRange> ranges;
    FixedArray<PatchPlace> places;
    FixedArray<uint8_t> tierCounts, finestLevels;
    FixedArray<uint32_t> stamps;
    uint32_t missingFirst = 0; ///< pages of tier 0

    // Since the last update, a patch each.
    FixedArray<float> urgency; ///< multiples of the error asked for, for a unit of error of the mesh
    FixedArray<uint8_t> drawnTier;

    uint32_t deadRow = 0; ///< from here on rows of the pool are dead at every level

    /// `collapseLevels`: of the pool's rows, and behind them `firstDeadRow` and on.
    Status create(const AssetView& tables, std::span<const uint8_t> collapseLevels, uint32_t firstDeadRow);
    uint32_t pageOf(uint32_t patch, uint32_t tier) const {
        return tables.patchPages[size_t(patch) * tables.tierCount() + tier];
    }
    bool isThere(uint32_t page) const {
        return pages[page].state == PageState::installed || pages[page].state == PageState::retiring;
    }
    std::span<const uint32_t> needsOf(uint32_t patch, uint32_t tier) const {
        return needs.of(size_t(patch) * tables.tierCount() + tier);
    }
    /// Brings what depends on a page up to what is there.
    void refresh(uint32_t page, bool rowsMoved);

private:
    bool allocate();
    bool findNeeds();
    bool listMembers();
};

/// visit(record, bytes) for each stream of a page, of its bytes as they lie uncompressed.
template <typename Visit>
void forStreams(const AssetView& tables, uint32_t page, std::span<const std::byte> bytes, const Visit& visit) {
    const format::PageRecord& record = tables.pages[page];
    uint64_t at = 0;
    for (const format::StreamRecord& s : tables.streams.subspan(record.firstStream, record.streamCount)) {
        at = alignUp(at);
        visit(s, bytes.subspan(size_t(at), size_t(s.rawBytes)));
        at += s.rawBytes;
    }
}

/// Checks a page's bytes and enters it. `collapse`: of the slot's rows, which begin at `firstRow`. On failure nothing
/// is entered.
Status installPage(StreamedAsset& asset, uint32_t page, std::span<const std::byte> bytes, uint32_t firstRow,
                   std::span<uint8_t> collapse);
/// The reverse.
void removePage(StreamedAsset& asset, uint32_t page);

struct PoolSlot {
    /// Generation * 4 + state: 0 with the core, 1 with the reader, 2 answered, 3 failed.
    std::atomic<uint32_t> word{0};
    uint32_t asset = format::kNone;
    uint32_t page = 0;
    uint64_t since = 0; ///< frame of the request
    bool taken = false;
    bool late = false;
};

struct Residency::Impl : Allocated<Residency::Impl> {
    static constexpr uint32_t kMostErrors = 64;

    ResidencyConfig config;
    struct Handle {
        StreamedAsset* asset = nullptr;
    };
    FixedArray<Handle> assets;
    std::byte* pool = nullptr;
    uint32_t slotCount = 0, freeSlots = 0;
    uint64_t slotBytes = 0;
    FixedArray<PoolSlot> slots;
    FixedArray<uint8_t> collapse; ///< a row each, and as many as a page may have that are dead
    struct Candidate {
        uint32_t asset, page;
        float value;
        uint64_t lastWanted;
    };
    FixedArray<Candidate> candidates, victims;
    uint32_t candidateCount = 0, victimCount = 0;
    FixedArray<InstalledPage> installed;
    uint32_t installedCount = 0;
    std::array<PageError, kMostErrors> errors;
    uint32_t errorCount = 0;
    uint32_t pageCount = 0;  ///< of all assets
    uint32_t firstPages = 0; ///< of tier 0, of all assets
    uint64_t frame = 0;
    ResidencyStats stats;

    ~Impl();
    bool allocate();
    StreamedAsset& at(uint32_t asset) const;
    std::span<std::byte> memoryOf(uint32_t slot, uint64_t bytes) const;

    void noteDrawn();
    void answer();
    void arrive(uint32_t slot);
    void fail(uint32_t asset, uint32_t page, const Status& status, bool forGood);
    void report(uint32_t asset, uint32_t page, const Status& status);
    void free(uint32_t slot);
    void freeRetired();
    void value();
    void listCandidates();
    void listVictims();
    void fetch();
    void request(const Candidate& wanted, uint32_t slot);
    uint32_t freeSlot() const;
    void retire(uint32_t asset, uint32_t page);
};

} // namespace xgc
