#include "residency.h"

#include "open.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

// A page's way:
//
//            request              answer, check
//   absent ----------> reading -----------------> installed ----------> retiring ----------> absent
//      ^                  |                           ^   another's slot    |   no longer drawn
//      +------------------+                           +---------------------+
//        failed: again later                             wanted after all
//
// The value of a page is the largest error that a patch shows for want of it. A page of a finer tier is never worth
// more than those of the coarser tiers that the same patch needs, so what is read comes in an order in which it is of
// use.

namespace xgc {
namespace {

using namespace format;

constexpr uint32_t kReading = 1, kArrived = 2, kFailed = 3;
/// A page takes another's place where it is worth so much more.
constexpr float kBetter = 1.1f;
/// What is out of sight counts so much of what it would in sight.
constexpr float kOutOfSight = 0.1f;

Status outOfCapacity(const char* message, uint64_t element) {
    return {StatusCode::outOfCapacity, message, element};
}

uint32_t stateOf(uint32_t word) {
    return word & 3;
}

} // namespace

PageLimits pageLimits(const AssetView& tables) {
    PageLimits limits;
    for (const PageRecord& page : tables.pages) {
        limits.bytes = std::max(limits.bytes, uint32_t(std::min<uint64_t>(page.rawBytes, UINT32_MAX)));
        for (const StreamRecord& s : tables.streams.subspan(page.firstStream, page.streamCount)) {
            if (s.kind == StreamKind::position) limits.rows = std::max(limits.rows, s.count);
        }
    }
    return limits;
}

// Set-up ------------------------------------------------------------------------------------------------------------

Residency::Residency() = default;
Residency::~Residency() = default;
Residency::Residency(Residency&&) noexcept = default;
Residency& Residency::operator=(Residency&&) noexcept = default;

Residency::Impl::~Impl() {
    for (uint32_t i = 0; i < assets.size(); ++i) delete assets[i].asset;
    if (pool) freeBytes(pool, size_t(slotCount * slotBytes), kAlignment);
}

bool Residency::Impl::allocate() {
    pool = static_cast<std::byte*>(allocateBytes(size_t(slotCount * slotBytes), kAlignment));
    return pool && assets.allocate(config.assetCapacity) && slots.allocate(slotCount) &&
           collapse.allocate((size_t(slotCount) + 1) * config.pageRows) && candidates.allocate(config.pageCapacity) &&
           victims.allocate(slotCount) && installed.allocate(slotCount);
}

Status Residency::create(const ResidencyConfig& config) {
    if (!config.reader.read || config.pageBytes == 0 || config.pageRows == 0 || config.framesInFlight == 0 ||
        config.assetCapacity == 0 || config.pageCapacity == 0)
        return {StatusCode::badArgument, "ResidencyConfig: a reader, and every capacity and framesInFlight at least 1"};
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (!impl) return outOfCapacity("ResidencyConfig: not enough memory; lower budgetBytes", 0);
    impl->config = config;
    impl->slotBytes = alignUp(config.pageBytes);
    const uint64_t cost = impl->slotBytes + config.pageRows; // and a collapse level a row
    const uint64_t count = std::min(config.budgetBytes / cost, uint64_t(UINT32_MAX) / config.pageRows - 1);
    if (count == 0) return outOfCapacity("ResidencyConfig: the budget holds no page: raise budgetBytes", cost);
    impl->slotCount = impl->freeSlots = uint32_t(count);
    impl->stats.slots = impl->slotCount;
    if (!impl->allocate()) return outOfCapacity("ResidencyConfig: not enough memory; lower budgetBytes", 0);
    impl_ = std::move(impl);
    return {};
}

StreamedAsset& Residency::Impl::at(uint32_t asset) const {
    assert(asset < assets.size() && assets[asset].asset && "no such asset");
    return *assets[asset].asset;
}

std::span<std::byte> Residency::Impl::memoryOf(uint32_t slot, uint64_t bytes) const {
    return {pool + slot * slotBytes, size_t(bytes)};
}

Status Residency::addAsset(const AssetView& tables, uint32_t& id) {
    Impl& r = *impl_;
    if (tables.tierCount() < 2)
        return {StatusCode::badArgument,
                "addAsset: the file has one page; open it with openAll, or bake it with --tiers"};
    uint32_t free = 0;
    while (free < r.assets.size() && r.assets[free].asset) ++free;
    if (free == r.assets.size())
        return outOfCapacity("too many assets: raise ResidencyConfig::assetCapacity", free + 1ull);
    const PageLimits limits = pageLimits(tables);
    if (limits.bytes > r.config.pageBytes)
        return outOfCapacity("a page is too large: raise ResidencyConfig::pageBytes", limits.bytes);
    if (limits.rows > r.config.pageRows)
        return outOfCapacity("a page has too many rows: raise ResidencyConfig::pageRows", limits.rows);
    if (tables.pages.size() > r.config.pageCapacity - r.pageCount)
        return outOfCapacity("too many pages: raise ResidencyConfig::pageCapacity", r.pageCount + tables.pages.size());
    std::unique_ptr<StreamedAsset> asset(new (std::nothrow) StreamedAsset);
    if (!asset) return outOfCapacity("not enough memory for the asset's tables", 0);
    if (Status s = asset->create(tables, {r.collapse.data(), r.collapse.size()}, r.slotCount * r.config.pageRows);
        !s.ok())
        return s;
    // One slot at least must be left to stream through.
    if (r.firstPages + asset->missingFirst + 1 > r.slotCount)
        return outOfCapacity("the first pages of all assets do not fit the budget: raise ResidencyConfig::budgetBytes",
                             (r.firstPages + asset->missingFirst + 1) * (r.slotBytes + r.config.pageRows));
    r.firstPages += asset->missingFirst;
    r.pageCount += uint32_t(tables.pages.size());
    r.assets[free].asset = asset.release();
    id = free;
    return {};
}

void Residency::removeAsset(uint32_t id) {
    Impl& r = *impl_;
    const StreamedAsset& asset = r.at(id);
    for (uint32_t i = 0; i < r.slotCount; ++i) {
        PoolSlot& slot = r.slots[i];
        if (!slot.taken || slot.asset != id) continue;
        slot.asset = kNone;
        // A reader may still write to it.
        if (stateOf(slot.word.load(std::memory_order_acquire)) != kReading) r.free(i);
    }
    for (const PageRecord& page : asset.tables.pages) r.firstPages -= page.tier == 0;
    r.pageCount -= uint32_t(asset.tables.pages.size());
    delete r.assets[id].asset;
    r.assets[id].asset = nullptr;
}

const AssetView& Residency::view(uint32_t asset) const {
    return impl_->at(asset).view;
}

bool Residency::ready(uint32_t asset) const {
    return impl_->at(asset).missingFirst == 0;
}

// What is wanted and drawn ------------------------------------------------------------------------------------------

void Residency::want(uint32_t asset, const Placement& placement, const View& view, float pixels,
                     std::span<const uint8_t> visible) {
    StreamedAsset& a = impl_->at(asset);
    for (uint32_t p = 0; p < a.tables.patchCount(); ++p) {
        const PatchRecord& patch = a.tables.patches[p];
        const glm::vec3 center(patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2]);
        const glm::vec3 way = placement.toWorld * glm::vec4(center, 1) - view.eye;
        const float squared = way.x * way.x + way.y * way.y + way.z * way.z;
        const float distance = std::max(std::sqrt(squared) - patch.sphereRadius * placement.maxScale, view.nearest);
        const float scale = view.pixelsPerUnit * placement.maxScale * a.tables.parts[patch.part].importance;
        const float near = view.orthographic ? scale : scale / std::max(distance, 1e-20f);
        const float urgency = near / std::max(pixels, 1e-6f) * (visible.empty() || visible[p] ? 1 : kOutOfSight);
        a.urgency[p] = std::max(a.urgency[p], std::min(urgency, std::numeric_limits<float>::max()));
    }
}

void Residency::want(const Scene& scene, const Selection& selection, const SelectionDesc& desc) {
    for (uint32_t id = 0; id < scene.instanceEnd(); ++id) {
        if (!scene.hasInstance(id)) continue;
        const AssetView* view = scene.asset(scene.assetOf(id)).asset;
        for (uint32_t asset = 0; asset < impl_->assets.size(); ++asset) {
            if (!impl_->assets[asset].asset || view != &impl_->assets[asset].asset->view) continue;
            const InstanceKind kind = selection.kind(id);
            const float pixels = kind == InstanceKind::culled ? desc.pixels / kOutOfSight : desc.pixels;
            want(asset, scene.placement(id), desc.view, std::max(pixels, selection.stats().pixels),
                 kind == InstanceKind::mixed ? selection.visible(id) : std::span<const uint8_t>());
        }
    }
}

void Residency::drawn(uint32_t asset, Levels levels) {
    StreamedAsset& a = impl_->at(asset);
    assert(levels.size() == a.tables.patchCount());
    for (uint32_t p = 0; p < levels.size(); ++p) {
        a.drawnTier[p] = std::max(a.drawnTier[p], uint8_t(a.tables.tierOf(levels[p])));
    }
}

void Residency::drawn(const Scene& scene, const DrawList& draws) {
    for (uint32_t id = 0; id < scene.instanceEnd(); ++id) {
        if (!scene.hasInstance(id) || draws.kind(id) != InstanceKind::mixed) continue; // whole ones are of tier 0
        const AssetView* view = scene.asset(scene.assetOf(id)).asset;
        for (uint32_t asset = 0; asset < impl_->assets.size(); ++asset) {
            if (impl_->assets[asset].asset && view == &impl_->assets[asset].asset->view) drawn(asset, draws.levels(id));
        }
    }
}

/// Turns what was drawn since the last update into frames of pages.
void Residency::Impl::noteDrawn() {
    for (uint32_t id = 0; id < assets.size(); ++id) {
        if (!assets[id].asset) continue;
        StreamedAsset& a = *assets[id].asset;
        for (uint32_t p = 0; p < a.tables.patchCount(); ++p) {
            for (uint32_t t = 1; t <= a.drawnTier[p]; ++t) {
                for (const uint32_t page : a.needsOf(p, t)) a.pages[page].lastDrawn = frame;
            }
            a.drawnTier[p] = 0;
        }
    }
}

// Answers -----------------------------------------------------------------------------------------------------------

void Residency::complete(uint64_t ticket, bool ok) {
    const uint32_t index = uint32_t(ticket), generation = uint32_t(ticket >> 32);
    if (index >= impl_->slotCount) return;
    uint32_t expected = generation * 4 + kReading;
    impl_->slots[index].word.compare_exchange_strong(expected, generation * 4 + (ok ? kArrived : kFailed),
                                                     std::memory_order_acq_rel);
}

void Residency::Impl::report(uint32_t asset, uint32_t page, const Status& status) {
    const StreamedPage& of = assets[asset].asset->pages[page];
    if (errorCount < kMostErrors) errors[errorCount++] = {asset, page, status, of.failures, of.givenUp};
}

void Residency::Impl::fail(uint32_t asset, uint32_t page, const Status& status, bool forGood) {
    StreamedPage& of = assets[asset].asset->pages[page];
    of.state = PageState::absent;
    of.slot = kNone;
    ++of.failures;
    ++stats.failures;
    of.givenUp = forGood || of.failures > config.retries;
    of.nextTry = frame + (uint64_t(config.retryFrames) << std::min(of.failures - 1, 20u));
    stats.givenUpPages += of.givenUp;
    report(asset, page, status);
}

void Residency::Impl::free(uint32_t index) {
    PoolSlot& slot = slots[index];
    slot.taken = false;
    slot.asset = kNone;
    slot.word.store((slot.word.load(std::memory_order_relaxed) / 4 + 1) * 4, std::memory_order_relaxed);
    ++freeSlots;
}

void Residency::Impl::arrive(uint32_t index) {
    PoolSlot& slot = slots[index];
    const uint32_t asset = slot.asset, page = slot.page;
    StreamedAsset& a = *assets[asset].asset;
    const uint64_t bytes = a.tables.pages[page].rawBytes;
    const uint32_t firstRow = index * config.pageRows;
    const Status status =
        installPage(a, page, memoryOf(index, bytes), firstRow, {collapse.data() + firstRow, config.pageRows});
    if (!status.ok()) {
        free(index);
        return fail(asset, page, status, status.code != StatusCode::badChecksum);
    }
    slot.word.store(slot.word.load(std::memory_order_relaxed) / 4 * 4, std::memory_order_relaxed);
    a.pages[page].failures = 0;
    a.pages[page].lastDrawn = frame; // a renderer's copy of it is on its way
    ++stats.installs;
    ++stats.residentPages;
    stats.residentBytes += bytes;
    installed[installedCount++] = {asset, page, firstRow, a.contents[page].rows};
}

/// Takes what the reader has answered, as much as an update may install.
void Residency::Impl::answer() {
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < slotCount; ++i) {
        PoolSlot& slot = slots[i];
        const uint32_t state = slot.taken ? stateOf(slot.word.load(std::memory_order_acquire)) : 0;
        if (state == 0) continue;
        if (slot.asset == kNone) { // removed meanwhile
            if (state != kReading) free(i);
            continue;
        }
        if (state == kArrived) {
            const uint64_t own = assets[slot.asset].asset->tables.pages[slot.page].rawBytes;
            if (bytes > 0 && bytes + own > config.installBytes) continue;
            bytes += own;
            arrive(i);
        } else if (state == kFailed) {
            const uint32_t asset = slot.asset, page = slot.page;
            free(i);
            fail(
                asset, page,
                {StatusCode::truncated, "the reader could not read the page: it is asked again; see to the file", page},
                false);
        } else if (!slot.late && frame - slot.since > config.patienceFrames) {
            slot.late = true;
            report(slot.asset, slot.page,
                   {StatusCode::truncated,
                    "the reader has not answered for patienceFrames: its memory waits for it; "
                    "answer each request, as failed if need be",
                    slot.page});
        }
    }
}

void Residency::retry(uint32_t asset) {
    StreamedAsset& a = impl_->at(asset);
    for (uint32_t i = 0; i < a.pages.size(); ++i) {
        impl_->stats.givenUpPages -= a.pages[i].givenUp;
        a.pages[i].givenUp = false;
        a.pages[i].failures = 0;
        a.pages[i].nextTry = 0;
    }
}

// What goes and what comes ------------------------------------------------------------------------------------------

void Residency::Impl::retire(uint32_t asset, uint32_t page) {
    StreamedAsset& a = *assets[asset].asset;
    a.pages[page].state = PageState::retiring;
    a.refresh(page, false);
}

void Residency::Impl::freeRetired() {
    for (uint32_t i = 0; i < slotCount; ++i) {
        PoolSlot& slot = slots[i];
        if (!slot.taken || slot.asset == kNone) continue;
        StreamedAsset& a = *assets[slot.asset].asset;
        StreamedPage& page = a.pages[slot.page];
        if (page.state != PageState::retiring || frame - page.lastDrawn < config.framesInFlight) continue;
        removePage(a, slot.page);
        page.slot = kNone;
        ++stats.evictions;
        --stats.residentPages;
        stats.residentBytes -= a.tables.pages[slot.page].rawBytes;
        free(i);
    }
}

void Residency::Impl::value() {
    stats.wantedPages = 0;
    stats.worstMissing = 0;
    for (uint32_t id = 0; id < assets.size(); ++id) {
        if (!assets[id].asset) continue;
        StreamedAsset& a = *assets[id].asset;
        for (uint32_t i = 0; i < a.pages.size(); ++i) a.pages[i].value = 0;
        for (uint32_t p = 0; p < a.tables.patchCount(); ++p) {
            for (uint32_t t = 1; t < a.tables.tierCount(); ++t) {
                const float error = a.tables.error(p, a.tables.tierLevels[t - 1]) * a.urgency[p];
                if (!(error > 1)) break;
                for (const uint32_t page : a.needsOf(p, t)) {
                    a.pages[page].value = std::max(a.pages[page].value, error);
                    a.pages[page].lastWanted = frame;
                }
            }
            a.urgency[p] = 0;
        }
    }
}

void Residency::Impl::listCandidates() {
    candidateCount = 0;
    for (uint32_t id = 0; id < assets.size(); ++id) {
        if (!assets[id].asset) continue;
        const StreamedAsset& a = *assets[id].asset;
        for (uint32_t i = 0; i < a.pages.size(); ++i) {
            const StreamedPage& page = a.pages[i];
            const bool first = a.tables.pages[i].tier == 0;
            if (page.state == PageState::installed || (!first && page.value <= 1)) continue;
            stats.wantedPages += page.state != PageState::retiring;
            stats.worstMissing = std::max(stats.worstMissing, page.value);
            if (page.state == PageState::reading || page.givenUp || page.nextTry > frame) continue;
            const float value = first ? std::numeric_limits<float>::infinity() : page.value;
            candidates[candidateCount++] = {id, i, value, 0};
        }
    }
    const auto before = [&](const Candidate& x, const Candidate& y) {
        const uint32_t s = assets[x.asset].asset->tables.pages[x.page].tier,
                       t = assets[y.asset].asset->tables.pages[y.page].tier;
        if (x.value != y.value) return x.value > y.value;
        return s != t ? s < t : x.asset != y.asset ? x.asset < y.asset : x.page < y.page;
    };
    // No more can be asked for than the pool holds.
    const uint32_t most = std::min(candidateCount, slotCount);
    std::partial_sort(candidates.data(), candidates.data() + most, candidates.data() + candidateCount, before);
    candidateCount = most;
}

/// What may give its slot, the least wanted first.
void Residency::Impl::listVictims() {
    victimCount = 0;
    for (uint32_t i = 0; i < slotCount; ++i) {
        const PoolSlot& slot = slots[i];
        if (!slot.taken || slot.asset == kNone) continue;
        const StreamedAsset& a = *assets[slot.asset].asset;
        const StreamedPage& page = a.pages[slot.page];
        if (page.state != PageState::installed || a.tables.pages[slot.page].tier == 0) continue;
        victims[victimCount++] = {slot.asset, slot.page, page.value, page.lastWanted};
    }
    const auto tier = [&](const Candidate& c) { return assets[c.asset].asset->tables.pages[c.page].tier; };
    std::sort(victims.data(), victims.data() + victimCount, [&](const Candidate& x, const Candidate& y) {
        if (x.value != y.value) return x.value < y.value;
        if (x.lastWanted != y.lastWanted) return x.lastWanted < y.lastWanted;
        if (tier(x) != tier(y)) return tier(x) > tier(y);
        return x.asset != y.asset ? x.asset < y.asset : x.page < y.page;
    });
}

uint32_t Residency::Impl::freeSlot() const {
    uint32_t i = 0;
    while (slots[i].taken) ++i;
    return i;
}

void Residency::Impl::request(const Candidate& wanted, uint32_t index) {
    StreamedAsset& a = *assets[wanted.asset].asset;
    const PageRecord& record = a.tables.pages[wanted.page];
    PoolSlot& slot = slots[index];
    slot.taken = true;
    slot.late = false;
    slot.asset = wanted.asset;
    slot.page = wanted.page;
    slot.since = frame;
    const uint32_t generation = slot.word.load(std::memory_order_relaxed) / 4 + 1;
    slot.word.store(generation * 4 + kReading, std::memory_order_release);
    --freeSlots;
    a.pages[wanted.page].state = PageState::reading;
    a.pages[wanted.page].slot = index;
    stats.readBytes += record.storedBytes;
    const uint64_t ticket = uint64_t(generation & 0x3fffffff) << 32 | index;
    config.reader.read(config.reader.user, {ticket, wanted.asset, wanted.page, record.offset, record.storedBytes,
                                            memoryOf(index, record.rawBytes)});
}

void Residency::Impl::fetch() {
    uint64_t reading = 0;
    uint32_t retiring = 0, waiting = 0, victim = 0;
    for (uint32_t i = 0; i < slotCount; ++i) {
        if (!slots[i].taken || slots[i].asset == kNone) continue;
        const StreamedAsset& a = *assets[slots[i].asset].asset;
        const PageState state = a.pages[slots[i].page].state;
        if (state == PageState::reading && !slots[i].late) reading += a.tables.pages[slots[i].page].rawBytes;
        retiring += state == PageState::retiring;
    }
    listVictims();
    for (uint32_t i = 0; i < candidateCount; ++i) {
        const Candidate& wanted = candidates[i];
        StreamedAsset& a = *assets[wanted.asset].asset;
        StreamedPage& page = a.pages[wanted.page];
        if (page.state == PageState::retiring) {
            // Back, but for those whose slots others wait for.
            if (waiting >= retiring) continue;
            page.state = PageState::installed;
            a.refresh(wanted.page, false);
            --retiring;
            continue;
        }
        const uint64_t bytes = a.tables.pages[wanted.page].rawBytes;
        if (reading > 0 && reading + bytes > config.readBytes) break;
        reading += bytes;
        if (freeSlots > 0) {
            request(wanted, freeSlot());
            continue;
        }
        if (++waiting <= retiring) continue;
        if (victim == victimCount || !(victims[victim].value * kBetter < wanted.value)) break;
        retire(victims[victim].asset, victims[victim].page);
        ++victim;
        ++retiring;
    }
}

void Residency::update() {
    Impl& r = *impl_;
    r.installedCount = r.errorCount = 0;
    r.noteDrawn();
    ++r.frame;
    r.answer();
    r.value();
    r.freeRetired();
    r.listCandidates();
    r.fetch();
    // What nobody draws goes, and comes, at once.
    r.freeRetired();
}

// What is there -----------------------------------------------------------------------------------------------------

std::span<const InstalledPage> Residency::installed() const {
    return {impl_->installed.data(), impl_->installedCount};
}

std::span<const PageError> Residency::errors() const {
    return {impl_->errors.data(), impl_->errorCount};
}

ResidencyStats Residency::stats() const {
    ResidencyStats stats = impl_->stats;
    for (uint32_t i = 0; i < impl_->slotCount; ++i) {
        const PoolSlot& slot = impl_->slots[i];
        stats.readingPages += slot.taken && stateOf(slot.word.load(std::memory_order_relaxed)) != 0;
    }
    return stats;
}

const ResidencyConfig& Residency::config() const {
    return impl_->config;
}

std::span<const std::byte> Residency::bytes(uint32_t asset, uint32_t page) const {
    const StreamedAsset& a = impl_->at(asset);
    if (!a.isThere(page)) return {};
    return impl_->memoryOf(a.pages[page].slot, a.tables.pages[page].rawBytes);
}

std::span<const std::byte> Residency::rows(uint32_t asset, uint32_t page, StreamKind kind, uint32_t set) const {
    const std::span<const std::byte> all = bytes(asset, page);
    if (all.empty()) return {};
    std::span<const std::byte> found;
    forStreams(impl_->at(asset).tables, page, all, [&](const StreamRecord& s, std::span<const std::byte> elements) {
        if (s.kind == kind && s.set == set) found = elements;
    });
    return found;
}

const std::byte* Residency::row(uint32_t asset, StreamKind kind, uint32_t set, uint32_t row) const {
    const uint32_t index = row / impl_->config.pageRows, local = row % impl_->config.pageRows;
    if (index >= impl_->slotCount || !impl_->slots[index].taken || impl_->slots[index].asset != asset) return nullptr;
    const uint32_t page = impl_->slots[index].page, count = impl_->at(asset).contents[page].rows;
    const std::span<const std::byte> stream = rows(asset, page, kind, set);
    return stream.empty() || local >= count ? nullptr : stream.data() + stream.size() / count * local;
}

} // namespace xgc
