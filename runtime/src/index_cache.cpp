#include <xgc/index_cache.h>

#include "id_list.h"
#include "index_pack.h"
#include "key_table.h"
#include "range_allocator.h"
#include "state_key.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

// A range is an id: a key in the table, a run of the arena, and a count of holders. One that nobody holds passes
// through two lists, each oldest first, and can be had back from either by its key:
//
//   held --release--> resting --framesInFlight frames--> idle --somebody needs room--> unused
//     ^_____________________|_______________________________|
//
// A miss is built into private memory, since reading mapped memory back is slow: there its rows tell how many bytes an
// index takes, and from there it is written to staging once. Where something is full it is refused before anything
// changes; only what a full arena has to give up for it in vain is gone: a free run is long enough or not, and nothing
// moves.
//
// All arrays have their full size from `create` on.

namespace xgc {
namespace {

constexpr uint32_t kNone = format::kNone;
constexpr uint32_t kWord = 4; ///< bytes; the arena is handed out in words

struct Asset {
    const AssetView* view = nullptr; ///< null: the id is free
    uint32_t heldRanges = 0;
};

struct Range {
    uint32_t run = kNone; ///< in the arena; kNone: draws nothing, or is unused
    uint32_t indexCount = 0;
    uint32_t indexBytes = kWord;
    uint32_t vertexOffset = 0;
    uint32_t asset = 0;
    uint32_t holders = 0;
    uint64_t lastFrame = 0; ///< of its last release
    bool named = false;     ///< has a key: its asset is there
};

/// What an index list is of: one patch, or those of a material.
struct Source {
    const AssetView& asset;
    uint32_t id;
    uint32_t firstPatch;
    uint32_t patchEnd;
    uint32_t material; ///< kNone: any
    Levels levels;

    bool has(uint32_t patch) const { return material == kNone || asset.patches[patch].material == material; }
    bool isOnePatch() const { return patchEnd - firstPatch == 1; }
    uint64_t bytesAtMost() const;
};

/// An index list that was built, to be written.
struct Built {
    uint32_t indexCount = 0;
    uint32_t indexBytes = kWord;
    uint32_t firstRow = 0; ///< that index 0 stands for

    uint32_t words() const { return uint32_t((uint64_t(indexCount) * indexBytes + kWord - 1) / kWord); }
};

Status outOfCapacity(const char* message, uint64_t element) {
    return {StatusCode::outOfCapacity, message, element};
}

/// The bytes that its indices take at most, if the file says the truth.
uint64_t Source::bytesAtMost() const {
    uint64_t triangles = 0;
    for (uint32_t p = firstPatch; p < patchEnd; ++p) {
        if (has(p)) triangles += triangleBound(asset, p, levels);
    }
    return triangles * 3 * sizeof(uint32_t);
}

} // namespace

struct IndexCache::Impl : Allocated<IndexCache::Impl> {
    IndexCacheConfig config;
    FixedArray<Asset> assets;

    FixedArray<Range> ranges;
    KeyTable keys;
    RangeAllocator arena; ///< in words
    FixedArray<IdLink> links;
    IdList unused{links}, resting{links}, idle{links};
    uint32_t idleWords = 0; ///< of the arena, in idle ranges
    uint32_t rangeCount = 0, heldCount = 0;

    // Scratch of acquire.
    FixedArray<std::byte> key;
    FixedArray<uint32_t> representatives, indices;

    // The frame.
    uint64_t frame = 0;
    bool inFrame = false;
    std::span<std::byte> staging;
    uint32_t stagingUsed = 0;
    FixedArray<CopyRange> copies;
    uint32_t copyCount = 0;
    IndexCacheStats stats; ///< those since beginFrame

    bool allocate();
    const AssetView& view(uint32_t asset) const;
    uint32_t wordsOf(const Range& range) const { return range.run == kNone ? 0 : arena.count(range.run); }

    void hold(uint32_t id);
    void release(uint32_t id);
    void leaveList(uint32_t id);
    void ripen();
    uint32_t drop(uint32_t id);
    uint32_t evictOldest();
    void dropUnheld(uint32_t asset, IdList& list);

    Status acquire(std::span<const std::byte> name, const Source& source, uint32_t& range);
    Status roomInFrame(uint64_t bytes) const;
    std::span<const uint32_t> buildPatch(const Source& source, uint32_t patch);
    Built build(const Source& source);
    Status reserve(std::span<const std::byte> name, uint32_t hash, uint32_t words, uint32_t& id);
    uint32_t allocateRun(uint32_t words);
    uint32_t write(const Source& source, const Built& built);
    void addCopy(uint32_t offset, uint32_t run);
};

// Set-up ------------------------------------------------------------------------------------------------------------

bool IndexCache::Impl::allocate() {
    const uint32_t count = config.rangeCapacity;
    const bool done = assets.allocate(config.assetCapacity) && ranges.allocate(count) &&
                      keys.create(count, config.keyBytes) && arena.create(config.arenaBytes / kWord, count) &&
                      links.allocate(count) && key.allocate(stateKeyBytes(config.domainsPerPatchCapacity)) &&
                      representatives.allocate(config.slotCapacity) &&
                      indices.allocate(3 * size_t(config.faceCapacity)) && copies.allocate(config.copyCapacity);
    if (!done) return false;
    for (uint32_t id = 0; id < count; ++id) unused.append(id);
    return true;
}

IndexCache::IndexCache() = default;
IndexCache::~IndexCache() = default;
IndexCache::IndexCache(IndexCache&&) noexcept = default;
IndexCache& IndexCache::operator=(IndexCache&&) noexcept = default;

Status IndexCache::create(const IndexCacheConfig& config) {
    if (config.arenaBytes < kWord || config.rangeCapacity == 0 || config.keyBytes == 0 || config.assetCapacity == 0 ||
        config.slotCapacity == 0 || config.faceCapacity == 0 || config.patchCapacity == 0 || config.copyCapacity == 0 ||
        config.framesInFlight == 0) {
        return {StatusCode::badArgument, "IndexCacheConfig: every capacity and framesInFlight must be at least 1, and "
                                         "arenaBytes at least 4"};
    }
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (impl) impl->config = config;
    if (!impl || !impl->allocate()) {
        return outOfCapacity("IndexCacheConfig: not enough memory for these capacities; lower them", 0);
    }
    impl_ = std::move(impl);
    return {};
}

// Assets ------------------------------------------------------------------------------------------------------------

const AssetView& IndexCache::Impl::view(uint32_t asset) const {
    assert(asset < assets.size() && assets[asset].view && "no such asset");
    return *assets[asset].view;
}

Status IndexCache::addAsset(uint32_t id, const AssetView& asset) {
    assert(impl_ && asset.record);
    Impl& c = *impl_;
    if (id >= c.assets.size()) {
        return outOfCapacity("too many assets: raise IndexCacheConfig::assetCapacity", id + 1ull);
    }
    assert(!c.assets[id].view && "the id names an asset: removeAsset is missing");
    if (scratchCapacity(asset) > c.config.slotCapacity) {
        return outOfCapacity("a patch has too many slots: raise IndexCacheConfig::slotCapacity",
                             scratchCapacity(asset));
    }
    if (asset.record->maxPatchFaces > c.config.faceCapacity) {
        return outOfCapacity("a patch has too many faces: raise IndexCacheConfig::faceCapacity",
                             asset.record->maxPatchFaces);
    }
    if (asset.patchCount() > c.config.patchCapacity) {
        return outOfCapacity("the asset has too many patches: raise IndexCacheConfig::patchCapacity",
                             asset.patchCount());
    }
    uint32_t domains = 0;
    for (const format::PatchRecord& patch : asset.patches) domains = std::max(domains, patch.domainCount);
    if (domains > c.config.domainsPerPatchCapacity) {
        return outOfCapacity("a patch has too many domains: raise IndexCacheConfig::domainsPerPatchCapacity", domains);
    }
    c.assets[id] = {&asset, 0};
    return {};
}

/// Nothing finds the asset's ranges any more; those that no frame in flight reads go at once.
void IndexCache::Impl::dropUnheld(uint32_t asset, IdList& list) {
    for (uint32_t id = list.first(), next; id != IdList::kEnd; id = next) {
        next = list.next(id);
        Range& range = ranges[id];
        if (range.asset != asset || !range.named) continue;
        keys.remove(id);
        range.named = false;
        if (&list == &resting) continue;
        leaveList(id);
        drop(id);
    }
}

void IndexCache::removeAsset(uint32_t id) {
    assert(impl_);
    Impl& c = *impl_;
    (void)c.view(id);
    assert(c.assets[id].heldRanges == 0 && "ranges of the asset are held: release is missing");
    c.dropUnheld(id, c.resting);
    c.dropUnheld(id, c.idle);
    c.assets[id] = {};
}

uint32_t IndexCache::heldRanges(uint32_t asset) const {
    assert(impl_);
    (void)impl_->view(asset);
    return impl_->assets[asset].heldRanges;
}

// Ranges ------------------------------------------------------------------------------------------------------------

/// Takes a range that nobody holds out of its list.
void IndexCache::Impl::leaveList(uint32_t id) {
    const Range& range = ranges[id];
    if (frame - range.lastFrame < config.framesInFlight) return resting.remove(id);
    idle.remove(id);
    idleWords -= wordsOf(range);
}

void IndexCache::Impl::hold(uint32_t id) {
    Range& range = ranges[id];
    if (range.holders++ > 0) return;
    leaveList(id);
    ++assets[range.asset].heldRanges;
    ++heldCount;
}

void IndexCache::Impl::release(uint32_t id) {
    Range& range = ranges[id];
    if (--range.holders > 0) return;
    --assets[range.asset].heldRanges;
    --heldCount;
    range.lastFrame = frame;
    resting.append(id);
}

/// Lets those go on that no frame in flight reads any more.
void IndexCache::Impl::ripen() {
    while (!resting.empty()) {
        const uint32_t id = resting.first();
        const Range& range = ranges[id];
        if (frame - range.lastFrame < config.framesInFlight) return;
        resting.remove(id);
        if (range.named) {
            idle.append(id);
            idleWords += wordsOf(range);
        } else {
            drop(id);
        }
    }
}

/// Makes a range that is in no list and has no key unused. Returns the words of the free run where it was.
uint32_t IndexCache::Impl::drop(uint32_t id) {
    const uint32_t words = ranges[id].run == kNone ? 0 : arena.free(ranges[id].run);
    ranges[id] = Range{};
    --rangeCount;
    unused.append(id);
    return words;
}

uint32_t IndexCache::Impl::evictOldest() {
    const uint32_t id = idle.first();
    leaveList(id);
    keys.remove(id);
    ++stats.evictions;
    return drop(id);
}

bool IndexCache::isHeld(uint32_t range) const {
    return impl_ && range < impl_->ranges.size() && impl_->ranges[range].holders > 0;
}

void IndexCache::hold(uint32_t range) {
    assert(isHeld(range) && "no range that is held");
    impl_->hold(range);
}

void IndexCache::release(uint32_t range) {
    assert(isHeld(range) && "no range that is held");
    impl_->release(range);
}

IndexRange IndexCache::at(uint32_t range) const {
    assert(isHeld(range) && "no range that is held");
    const Range& r = impl_->ranges[range];
    const uint32_t words = r.run == kNone ? 0 : impl_->arena.offset(r.run);
    return {words * (kWord / r.indexBytes), r.indexCount, r.indexBytes, r.vertexOffset};
}

// A miss ------------------------------------------------------------------------------------------------------------

/// Refuses what is known to fail before it is built.
Status IndexCache::Impl::roomInFrame(uint64_t bytes) const {
    if (unused.empty() && idle.empty()) {
        return outOfCapacity("all ranges are held or in flight: ask again after framesInFlight frames, or raise "
                             "IndexCacheConfig::rangeCapacity",
                             config.rangeCapacity + 1ull);
    }
    if (bytes > staging.size()) {
        return outOfCapacity("the range needs more than all of the frame's staging memory: give beginFrame as many "
                             "bytes as element says, or ask for coarser levels first",
                             bytes);
    }
    if (bytes > staging.size() - stagingUsed) {
        return outOfCapacity("the frame's staging memory is full: ask again next frame, or give beginFrame more",
                             bytes);
    }
    if (bytes > 0 && copyCount == config.copyCapacity) {
        return outOfCapacity("too many copies in one frame: ask again next frame, or raise "
                             "IndexCacheConfig::copyCapacity",
                             copyCount + 1ull);
    }
    return {};
}

std::span<const uint32_t> IndexCache::Impl::buildPatch(const Source& source, uint32_t patch) {
    const uint32_t count =
        buildIndices(source.asset, patch, source.levels, {representatives.data(), representatives.size()},
                     {indices.data(), indices.size()});
    return {indices.data(), count};
}

/// Leaves the indices in scratch where the source is one patch.
Built IndexCache::Impl::build(const Source& source) {
    Built built;
    RowSpan rows;
    for (uint32_t p = source.firstPatch; p < source.patchEnd; ++p) {
        if (!source.has(p)) continue;
        const std::span<const uint32_t> list = buildPatch(source, p);
        built.indexCount += uint32_t(list.size());
        rows.add(list);
    }
    if (config.narrowIndices && rows.isNarrow()) {
        built.indexBytes = sizeof(uint16_t);
        built.firstRow = rows.first;
    }
    return built;
}

/// Evicts until a run is long enough; kNone where it never is.
uint32_t IndexCache::Impl::allocateRun(uint32_t words) {
    uint32_t run = arena.allocate(words);
    while (run == kNone && !idle.empty()) {
        if (evictOldest() >= words) run = arena.allocate(words);
    }
    return run;
}

/// Names an unused range and gives it a run of the arena.
Status IndexCache::Impl::reserve(std::span<const std::byte> name, uint32_t hash, uint32_t words, uint32_t& id) {
    const Status full = outOfCapacity("the index arena is full: ask again after framesInFlight frames, or raise "
                                      "IndexCacheConfig::arenaBytes",
                                      uint64_t(words) * kWord);
    if (words > arena.freeTotal() + idleWords) return full; // evict nothing in vain
    if (unused.empty()) evictOldest();
    id = unused.first();
    while (!keys.insert(id, name, hash)) {
        if (idle.empty()) {
            return outOfCapacity("no room for the names of states: ask again after framesInFlight frames, or raise "
                                 "IndexCacheConfig::keyBytes",
                                 config.keyBytes + uint64_t(name.size()));
        }
        evictOldest();
    }
    const uint32_t run = words > 0 ? allocateRun(words) : kNone;
    if (words > 0 && run == kNone) {
        keys.remove(id);
        return full;
    }
    unused.remove(id);
    ++rangeCount;
    ranges[id].run = run;
    ranges[id].named = true;
    return {};
}

/// Writes what was built to staging, from its offset there on, which is returned.
uint32_t IndexCache::Impl::write(const Source& source, const Built& built) {
    const uint32_t offset = stagingUsed;
    std::byte* out = staging.data() + offset;
    for (uint32_t p = source.firstPatch; p < source.patchEnd; ++p) {
        if (!source.has(p)) continue;
        const std::span<const uint32_t> list =
            source.isOnePatch() ? std::span<const uint32_t>(indices.data(), built.indexCount) : buildPatch(source, p);
        if (built.indexBytes == sizeof(uint16_t))
            packNarrow(list, built.firstRow, out);
        else if (!list.empty())
            std::memcpy(out, list.data(), list.size_bytes());
        out += list.size() * built.indexBytes;
    }
    stagingUsed = offset + built.words() * kWord;
    std::fill(out, staging.data() + stagingUsed, std::byte(0));
    return offset;
}

/// Appends a copy, or lengthens the last one where both ends meet.
void IndexCache::Impl::addCopy(uint32_t offset, uint32_t run) {
    const uint32_t to = arena.offset(run) * kWord, bytes = arena.count(run) * kWord;
    stats.uploadBytes += bytes;
    if (copyCount > 0) {
        CopyRange& last = copies[copyCount - 1];
        if (last.staging + last.bytes == offset && last.arena + last.bytes == to) {
            last.bytes += bytes;
            return;
        }
    }
    copies[copyCount++] = {offset, to, bytes};
}

Status IndexCache::Impl::acquire(std::span<const std::byte> name, const Source& source, uint32_t& range) {
    const uint32_t hash = KeyTable::hash(name);
    uint32_t id = keys.find(name, hash);
    if (id != KeyTable::kNone) {
        ++stats.hits;
        hold(id);
        range = id;
        return {};
    }
    Built built;
    Status status = roomInFrame(source.bytesAtMost());
    if (status.ok()) {
        built = build(source);
        status = roomInFrame(uint64_t(built.words()) * kWord); // the counts in a file may lie
    }
    if (status.ok()) status = reserve(name, hash, built.words(), id);
    if (!status.ok()) {
        ++stats.refusals;
        return status;
    }
    ++stats.misses;
    Range& r = ranges[id];
    r.indexCount = built.indexCount;
    r.indexBytes = built.indexBytes;
    r.vertexOffset = built.firstRow;
    r.asset = source.id;
    r.holders = 1;
    ++assets[source.id].heldRanges;
    ++heldCount;
    if (built.indexCount > 0) addCopy(write(source, built), r.run);
    range = id;
    return {};
}

Status IndexCache::acquire(uint32_t asset, uint32_t patch, Levels levels, uint32_t& range) {
    assert(impl_ && impl_->inFrame && "call beginFrame first");
    Impl& c = *impl_;
    const AssetView& view = c.view(asset);
    assert(patch < view.patchCount() && levels.size() == view.patchCount() && levels[patch] < view.levelCount());
    const size_t bytes = writePatchKey(asset, view, patch, levels, c.key.data());
    return c.acquire({c.key.data(), bytes}, {view, asset, patch, patch + 1, kNone, levels}, range);
}

uint64_t IndexCache::bytesNeeded(uint32_t asset, uint32_t patch, Levels levels) const {
    assert(impl_);
    Impl& c = *impl_;
    const AssetView& view = c.view(asset);
    const size_t bytes = writePatchKey(asset, view, patch, levels, c.key.data());
    const std::span<const std::byte> name(c.key.data(), bytes);
    if (c.keys.find(name, KeyTable::hash(name)) != KeyTable::kNone) return 0;
    return Source{view, asset, patch, patch + 1, kNone, levels}.bytesAtMost();
}

uint64_t IndexCache::freeStagingBytes() const {
    assert(impl_);
    return impl_->staging.size() - impl_->stagingUsed;
}

Status IndexCache::acquireWhole(uint32_t asset, uint32_t material, uint32_t number, Levels levels, uint32_t& range) {
    assert(impl_ && impl_->inFrame && "call beginFrame first");
    Impl& c = *impl_;
    const AssetView& view = c.view(asset);
    assert(material < view.record->materialCount && levels.size() == view.patchCount());
    const size_t bytes = writeWholeKey(asset, material, number, c.key.data());
    return c.acquire({c.key.data(), bytes}, {view, asset, 0, view.patchCount(), material, levels}, range);
}

// A frame -----------------------------------------------------------------------------------------------------------

void IndexCache::beginFrame(std::span<std::byte> staging) {
    assert(impl_ && !impl_->inFrame && "endFrame is missing");
    assert(staging.size() <= UINT32_MAX && reinterpret_cast<uintptr_t>(staging.data()) % kWord == 0);
    Impl& c = *impl_;
    ++c.frame;
    c.inFrame = true;
    c.staging = staging.first(staging.size() / kWord * kWord);
    c.stagingUsed = 0;
    c.copyCount = 0;
    c.stats = {};
    c.ripen();
}

void IndexCache::endFrame() {
    assert(impl_ && impl_->inFrame && "beginFrame is missing");
    impl_->inFrame = false;
    impl_->staging = {};
}

bool IndexCache::inFrame() const {
    return impl_ && impl_->inFrame;
}

std::span<const CopyRange> IndexCache::copies() const {
    return {impl_->copies.data(), impl_->copyCount};
}

IndexCacheStats IndexCache::stats() const {
    const Impl& c = *impl_;
    IndexCacheStats stats = c.stats;
    stats.ranges = c.rangeCount;
    stats.heldRanges = c.heldCount;
    stats.usedBytes = uint32_t(c.config.arenaBytes / kWord - c.arena.freeTotal()) * kWord;
    stats.largestFreeBytes = c.arena.longestFree() * kWord;
    return stats;
}

} // namespace xgc
