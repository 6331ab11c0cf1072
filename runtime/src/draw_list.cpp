#include <xgc/draw_list.h>

#include "range_allocator.h"

#include <algorithm>
#include <cassert>
#include <new>

// Each patch of each instance has a slot: its level and its range in the index arena. `setLevels` lists the patches
// whose indices differ between the two states, builds them into staging, allocates their new ranges, and only when
// all of that succeeded swaps the ranges in. Old ranges wait in a queue until no frame in flight reads them:
//
//   arena   [ A.0 | A.1 | old A.2 |  free  | A.2 | B.0 | ... ]
//                            |__ reused framesInFlight frames later
//
// All arrays have their full size from `create` on.

namespace xgc {
namespace {

constexpr uint32_t kNoRange = RangeAllocator::kNoRange;

struct Instance {
    const AssetView* asset = nullptr; ///< null: the id is free
    int32_t vertexOffset = 0;
    uint32_t slotRange = kNoRange;
    uint32_t firstSlot = 0;
    bool drawn = false;         ///< has levels
    uint64_t deferredFrame = 0; ///< last frame that refused it
    uint32_t nextFree = format::kNone;
};

/// A patch of an instance.
struct Slot {
    uint32_t range = kNoRange; ///< kNoRange: nothing to draw
    uint32_t material = 0;
};

/// A patch on its way to a new range.
struct Rebuild {
    uint32_t patch;
    uint32_t range;
    uint32_t staging;
};

struct FreedRange {
    uint32_t range;
    uint64_t frame;
};

Status outOfCapacity(const char* message, uint64_t element) {
    return {StatusCode::outOfCapacity, message, element};
}

} // namespace

struct DrawList::Impl : Allocated<DrawList::Impl> {
    DrawListConfig config;

    FixedArray<Instance> instances;
    uint32_t instanceEnd = 0; ///< ids from here on were never used
    uint32_t freeInstance = format::kNone;

    RangeAllocator slotRanges;
    FixedArray<Slot> slots;
    FixedArray<uint8_t> slotLevels;

    RangeAllocator arena;
    FixedArray<FreedRange> freed; ///< a ring, oldest first
    size_t freedFirst = 0, freedCount = 0;

    // Scratch of setLevels.
    FixedArray<uint32_t> representatives;
    FixedArray<Rebuild> rebuilds;
    uint32_t rebuildCount = 0;
    FixedArray<uint64_t> patchMarks, domainMarks; ///< equal `call` where seen in it
    uint64_t call = 0;

    // The frame.
    uint64_t frame = 0;
    bool inFrame = false;
    bool drawsStale = false;
    std::span<uint32_t> staging;
    uint32_t stagingUsed = 0;
    FixedArray<CopyRange> copies;
    uint32_t copyCount = 0;
    FixedArray<DrawCommand> draws;
    FixedArray<DrawPatch> drawPatches;
    uint32_t drawCount = 0;
    FixedArray<DrawBatch> batches;
    uint32_t batchCount = 0;
    FixedArray<uint32_t> materialNext; ///< next draw of each material while sorting
    FrameStats stats;

    bool allocate();
    Instance& at(uint32_t id);
    void freeLater(uint32_t range);
    void releaseOld();
    void mark(uint32_t patch);
    uint32_t listRebuilds(const Instance& instance, Levels after);
    Status buildRebuilds(const Instance& instance, Levels after);
    void commit(Instance& instance, Levels after);
    void addCopy(const Rebuild& built);
    void countMaterials();
    void fillDraws();
    void addDraw(uint32_t id, uint32_t patch);
};

// Set-up ------------------------------------------------------------------------------------------------------------

bool DrawList::Impl::allocate() {
    // Ranges live: drawn, new before the swap, and freed in each frame that may still be in flight. No range is
    // shorter than a triangle.
    const uint64_t patches = config.patchCapacity;
    const auto ranges =
        uint32_t(std::min<uint64_t>(patches * (uint64_t(config.framesInFlight) + 2), config.indexCapacity / 3 + 1));
    return instances.allocate(config.instanceCapacity) &&
           slotRanges.create(config.patchCapacity, config.instanceCapacity) && slots.allocate(patches) &&
           slotLevels.allocate(patches) && arena.create(config.indexCapacity, ranges) && freed.allocate(ranges) &&
           representatives.allocate(config.slotCapacity) && rebuilds.allocate(patches) &&
           patchMarks.allocate(patches) && domainMarks.allocate(config.domainCapacity) && copies.allocate(patches) &&
           draws.allocate(patches) && drawPatches.allocate(patches) && batches.allocate(config.materialCapacity) &&
           materialNext.allocate(config.materialCapacity);
}

DrawList::DrawList() = default;
DrawList::~DrawList() = default;
DrawList::DrawList(DrawList&&) noexcept = default;
DrawList& DrawList::operator=(DrawList&&) noexcept = default;

Status DrawList::create(const DrawListConfig& config) {
    if (config.instanceCapacity == 0 || config.patchCapacity == 0 || config.materialCapacity == 0 ||
        config.slotCapacity == 0 || config.indexCapacity == 0 || config.framesInFlight == 0) {
        return {StatusCode::badArgument, "DrawListConfig: every capacity and framesInFlight must be at least 1"};
    }
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (impl) impl->config = config;
    if (!impl || !impl->allocate()) {
        return outOfCapacity("DrawListConfig: not enough memory for these capacities; lower them", 0);
    }
    impl_ = std::move(impl);
    return {};
}

// Instances ---------------------------------------------------------------------------------------------------------

Instance& DrawList::Impl::at(uint32_t id) {
    assert(id < instanceEnd && instances[id].asset && "no such instance");
    return instances[id];
}

Status DrawList::addInstance(const InstanceDesc& desc, uint32_t& id) {
    assert(impl_ && desc.asset && desc.asset->record);
    Impl& d = *impl_;
    const AssetView& asset = *desc.asset;
    const format::AssetRecord& record = *asset.record;
    if (d.freeInstance == format::kNone && d.instanceEnd == d.config.instanceCapacity) {
        return outOfCapacity("too many instances: raise DrawListConfig::instanceCapacity", d.instanceEnd + 1ull);
    }
    if (scratchCapacity(asset) > d.config.slotCapacity) {
        return outOfCapacity("a patch has too many slots: raise DrawListConfig::slotCapacity", scratchCapacity(asset));
    }
    if (record.domainCount > d.config.domainCapacity) {
        return outOfCapacity("the asset has too many domains: raise DrawListConfig::domainCapacity",
                             record.domainCount);
    }
    const uint64_t materialEnd = uint64_t(desc.firstMaterial) + record.materialCount;
    if (materialEnd > d.config.materialCapacity) {
        return outOfCapacity("too many materials: raise DrawListConfig::materialCapacity", materialEnd);
    }
    const uint32_t slotRange = record.patchCount ? d.slotRanges.allocate(record.patchCount) : kNoRange;
    if (record.patchCount && slotRange == kNoRange) {
        return outOfCapacity("too many patches: raise DrawListConfig::patchCapacity", record.patchCount);
    }

    id = d.freeInstance != format::kNone ? d.freeInstance : d.instanceEnd++;
    d.freeInstance = d.instances[id].nextFree;
    Instance& instance = d.instances[id] = Instance{};
    instance.asset = desc.asset;
    instance.vertexOffset = desc.vertexOffset;
    instance.slotRange = slotRange;
    instance.firstSlot = slotRange == kNoRange ? 0 : d.slotRanges.offset(slotRange);
    for (uint32_t p = 0; p < record.patchCount; ++p) {
        d.slots[instance.firstSlot + p] = {kNoRange, desc.firstMaterial + asset.patches[p].material};
    }
    return {};
}

void DrawList::removeInstance(uint32_t id) {
    assert(impl_);
    Impl& d = *impl_;
    Instance& instance = d.at(id);
    for (uint32_t p = 0; p < instance.asset->patchCount(); ++p) {
        const uint32_t range = d.slots[instance.firstSlot + p].range;
        if (range != kNoRange) d.freeLater(range);
    }
    if (instance.slotRange != kNoRange) d.slotRanges.free(instance.slotRange);
    d.drawsStale |= instance.drawn;
    instance = Instance{};
    instance.nextFree = d.freeInstance;
    d.freeInstance = id;
}

Levels DrawList::levels(uint32_t id) const {
    assert(impl_);
    const Instance& instance = impl_->at(id);
    if (!instance.drawn) return {};
    return {impl_->slotLevels.data() + instance.firstSlot, instance.asset->patchCount()};
}

// Old ranges --------------------------------------------------------------------------------------------------------

void DrawList::Impl::freeLater(uint32_t range) {
    assert(freedCount < freed.size());
    freed[(freedFirst + freedCount++) % freed.size()] = {range, frame};
}

void DrawList::Impl::releaseOld() {
    for (; freedCount > 0 && frame - freed[freedFirst].frame >= config.framesInFlight; --freedCount) {
        arena.free(freed[freedFirst].range);
        freedFirst = (freedFirst + 1) % freed.size();
    }
}

// A change of levels ------------------------------------------------------------------------------------------------

void DrawList::Impl::mark(uint32_t patch) {
    if (patchMarks[patch] == call) return;
    patchMarks[patch] = call;
    rebuilds[rebuildCount++] = {patch, kNoRange, 0};
}

/// Lists the patches whose indices differ between the instance's state and `after`: those whose own vertices
/// changed, and all that share a domain that changed. Only domains of changed patches are looked at, each once.
/// Returns the number of patches whose level differs.
uint32_t DrawList::Impl::listRebuilds(const Instance& instance, Levels after) {
    const AssetView& asset = *instance.asset;
    ++call;
    rebuildCount = 0;
    if (!instance.drawn) {
        for (uint32_t p = 0; p < asset.patchCount(); ++p) mark(p);
        return asset.patchCount();
    }
    const Levels before{slotLevels.data() + instance.firstSlot, asset.patchCount()};
    uint32_t changed = 0;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        if (before[p] == after[p]) continue;
        ++changed;
        if (patchDiffers(asset, p, before[p], after[p])) mark(p);
        for (const uint32_t domain : asset.domainsOf(p)) {
            if (domainMarks[domain] == call) continue;
            domainMarks[domain] = call;
            if (!domainDiffers(asset, domain, before, after)) continue;
            for (const uint32_t sharer : asset.patchesOf(domain)) mark(sharer);
        }
    }
    return changed;
}

/// Builds the listed patches into staging and gives them ranges. Where something is full, nothing has changed.
Status DrawList::Impl::buildRebuilds(const Instance& instance, Levels after) {
    const AssetView& asset = *instance.asset;
    uint64_t needed = 0;
    for (uint32_t i = 0; i < rebuildCount; ++i) {
        needed += indexCapacity(asset, rebuilds[i].patch, after);
    }
    if (needed > staging.size() - stagingUsed) {
        return needed > staging.size()
                   ? outOfCapacity("the change needs more indices than all of the frame's staging memory: give "
                                   "beginFrame as many as element says, or ask for coarser levels first",
                                   needed)
                   : outOfCapacity("the frame's staging memory is full: ask again next frame, or give beginFrame more",
                                   needed);
    }
    if (rebuildCount > copies.size() - copyCount) {
        return outOfCapacity("more copies than patches in one frame: set an instance once a frame, or raise "
                             "DrawListConfig::patchCapacity",
                             uint64_t(copyCount) + rebuildCount);
    }

    uint32_t used = stagingUsed;
    for (uint32_t i = 0; i < rebuildCount; ++i) {
        Rebuild& r = rebuilds[i];
        r.staging = used;
        const uint32_t count = buildIndices(asset, r.patch, after, {representatives.data(), representatives.size()},
                                            staging.subspan(used));
        if (count == 0) continue;
        r.range = arena.allocate(count);
        if (r.range == kNoRange) {
            for (uint32_t k = 0; k < i; ++k) {
                if (rebuilds[k].range != kNoRange) arena.free(rebuilds[k].range);
            }
            return outOfCapacity("the index arena is full: ask again after framesInFlight frames, or raise "
                                 "DrawListConfig::indexCapacity",
                                 needed);
        }
        used += count;
    }
    stagingUsed = used;
    return {};
}

/// Appends a copy, or lengthens the last one where both ends meet.
void DrawList::Impl::addCopy(const Rebuild& built) {
    const uint32_t offset = arena.offset(built.range), count = arena.count(built.range);
    stats.uploadBytes += count * uint32_t(sizeof(uint32_t));
    if (copyCount > 0) {
        CopyRange& last = copies[copyCount - 1];
        if (last.staging + last.count == built.staging && last.arena + last.count == offset) {
            last.count += count;
            return;
        }
    }
    copies[copyCount++] = {built.staging, offset, count};
}

void DrawList::Impl::commit(Instance& instance, Levels after) {
    for (uint32_t i = 0; i < rebuildCount; ++i) {
        const Rebuild& r = rebuilds[i];
        Slot& slot = slots[instance.firstSlot + r.patch];
        if (slot.range != kNoRange) freeLater(slot.range);
        slot.range = r.range;
        if (r.range != kNoRange) addCopy(r);
    }
    std::copy_n(after.data(), instance.asset->patchCount(), slotLevels.data() + instance.firstSlot);
    instance.drawn = true;
    drawsStale |= rebuildCount > 0;
}

Status DrawList::setLevels(uint32_t id, Levels levels) {
    assert(impl_ && impl_->inFrame && "call beginFrame first");
    Impl& d = *impl_;
    Instance& instance = d.at(id);
    assert(levels.size() == instance.asset->patchCount());
    assert(std::all_of(levels.begin(), levels.end(), [&](uint8_t l) { return l < instance.asset->levelCount(); }));

    const uint32_t changed = d.listRebuilds(instance, levels);
    const Status status = d.buildRebuilds(instance, levels);
    const bool wasDeferred = instance.deferredFrame == d.frame;
    if (!status.ok()) {
        d.stats.deferredInstances += wasDeferred ? 0 : 1;
        instance.deferredFrame = d.frame;
        return status;
    }
    d.stats.deferredInstances -= wasDeferred ? 1 : 0;
    instance.deferredFrame = 0;
    d.stats.patchesChanged += changed;
    d.stats.patchesRebuilt += d.rebuildCount;
    d.commit(instance, levels);
    return {};
}

// A frame -----------------------------------------------------------------------------------------------------------

void DrawList::beginFrame(std::span<uint32_t> staging) {
    assert(impl_ && !impl_->inFrame && "endFrame is missing");
    assert(staging.size() <= UINT32_MAX);
    Impl& d = *impl_;
    ++d.frame;
    d.inFrame = true;
    d.staging = staging;
    d.stagingUsed = 0;
    d.copyCount = 0;
    const uint32_t triangles = d.stats.triangles;
    d.stats = {};
    d.stats.triangles = triangles;
    d.releaseOld();
}

/// Counts the draws of each material, gives each a batch, and leaves where its first draw goes in materialNext.
void DrawList::Impl::countMaterials() {
    std::fill_n(materialNext.data(), materialNext.size(), 0u);
    for (uint32_t id = 0; id < instanceEnd; ++id) {
        const Instance& instance = instances[id];
        if (!instance.drawn) continue;
        const Slot* first = slots.data() + instance.firstSlot;
        for (uint32_t p = 0; p < instance.asset->patchCount(); ++p) {
            if (first[p].range != kNoRange) ++materialNext[first[p].material];
        }
    }
    drawCount = 0;
    batchCount = 0;
    for (uint32_t material = 0; material < materialNext.size(); ++material) {
        const uint32_t count = materialNext[material];
        materialNext[material] = drawCount;
        if (count > 0) batches[batchCount++] = {material, drawCount, count};
        drawCount += count;
    }
}

void DrawList::Impl::addDraw(uint32_t id, uint32_t patch) {
    const Instance& instance = instances[id];
    const Slot& slot = slots[instance.firstSlot + patch];
    if (slot.range == kNoRange) return;
    const uint32_t draw = materialNext[slot.material]++;
    const uint32_t count = arena.count(slot.range);
    draws[draw] = {count, 1, arena.offset(slot.range), instance.vertexOffset, id};
    drawPatches[draw] = {id, patch};
    stats.triangles += count / 3;
}

void DrawList::Impl::fillDraws() {
    stats.triangles = 0;
    for (uint32_t id = 0; id < instanceEnd; ++id) {
        if (!instances[id].drawn) continue;
        for (uint32_t p = 0; p < instances[id].asset->patchCount(); ++p) addDraw(id, p);
    }
}

void DrawList::endFrame() {
    assert(impl_ && impl_->inFrame && "beginFrame is missing");
    Impl& d = *impl_;
    d.inFrame = false;
    d.staging = {};
    if (!d.drawsStale) return;
    d.drawsStale = false;
    d.countMaterials();
    d.fillDraws();
}

std::span<const CopyRange> DrawList::copies() const {
    return {impl_->copies.data(), impl_->copyCount};
}
std::span<const DrawCommand> DrawList::draws() const {
    return {impl_->draws.data(), impl_->drawCount};
}
std::span<const DrawPatch> DrawList::drawPatches() const {
    return {impl_->drawPatches.data(), impl_->drawCount};
}
std::span<const DrawBatch> DrawList::batches() const {
    return {impl_->batches.data(), impl_->batchCount};
}
const FrameStats& DrawList::stats() const {
    return impl_->stats;
}

} // namespace xgc
