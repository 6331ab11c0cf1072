#include "draw_list.h"

#include <xgc/morph.h>

#include <algorithm>
#include <cassert>
#include <utility>

// What a view draws, instance by instance, and the ranges that it holds for that in the index cache:
//
//   whole   one range a material of (asset, state), held once for all instances in that state
//   mixed   one range a patch that is shown; whole ones too where their asset is too large to be built at once
//
// A change of a mixed instance is a plan: levels to go to, and the patches whose ranges differ there. A plan whose
// ranges fit what is left of the frame's staging is bound as a whole; else one of the most urgent changes alone, found
// by halving. Where not even the patches that must be shown fit at the levels that they have, the instance stays whole,
// in its last state or in the asset's coarsest, and what fits of the plan is built ahead: the cache keeps it.

namespace xgc {
namespace {

Status outOfCapacity(const char* message, uint64_t element) {
    return {StatusCode::outOfCapacity, message, element};
}

} // namespace

// Set-up ------------------------------------------------------------------------------------------------------------

DrawList::DrawList() = default;
DrawList::~DrawList() = default;
DrawList::DrawList(DrawList&&) noexcept = default;
DrawList& DrawList::operator=(DrawList&&) noexcept = default;

bool DrawList::Impl::allocate() {
    const size_t slots = config.scene.patchCapacity, patches = config.scene.assetPatchCapacity;
    const size_t states = size_t(config.scene.assetCapacity) * kMaxWholeStates;
    const size_t drawCapacity = slots + config.wholeRangeCapacity;
    return instances.allocate(config.scene.instanceCapacity) && slotRanges.allocate(slots) &&
           slotLevels.allocate(slots) && slotFractions.allocate(slots) && wholeStates.allocate(states) &&
           assetsInSight.allocate(config.scene.assetCapacity) &&
           wholeHandles.create(config.wholeRangeCapacity, config.wholeRangeCapacity) &&
           wholeRanges.allocate(config.wholeRangeCapacity) && planLevels.allocate(patches) &&
           wholeLevels.allocate(patches) && heldLevels.allocate(patches) && allShown.allocate(patches) &&
           changes.allocate(patches) && rebinds.allocate(patches) && patchMarks.allocate(patches) &&
           domainMarks.allocate(config.domainCapacity) && draws.allocate(drawCapacity) &&
           sources.allocate(drawCapacity) && batches.allocate(2 * size_t(config.materialCapacity)) &&
           batchNext.allocate(2 * size_t(config.materialCapacity)) &&
           drawInstances.allocate(config.scene.instanceCapacity) && activeStates.allocate(config.wholeRangeCapacity);
}

Status DrawList::create(const DrawListConfig& config) {
    if (config.materialCapacity == 0 || config.wholeRangeCapacity == 0 || config.domainCapacity == 0 ||
        config.scene.instanceCapacity == 0) {
        return {StatusCode::badArgument, "DrawListConfig: every capacity must be at least 1", 0};
    }
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (impl) impl->config = config;
    if (!impl || !impl->allocate()) {
        return outOfCapacity("DrawListConfig: not enough memory for these capacities; lower them", 0);
    }
    std::fill_n(impl->slotRanges.data(), impl->slotRanges.size(), kNoRange);
    std::fill_n(impl->allShown.data(), impl->allShown.size(), uint8_t(1));
    impl_ = std::move(impl);
    return {};
}

// Whole assets ------------------------------------------------------------------------------------------------------

/// One more holder of a state of an asset. False, and nothing is held, where the cache refuses.
bool DrawList::Impl::holdWhole(uint32_t asset, uint32_t state) {
    WholeState& held = heldState(asset, state);
    if (held.holders > 0) {
        ++held.holders;
        return true;
    }
    const auto materials = uint32_t(view(asset).materials.size());
    const uint32_t handle = wholeHandles.allocate(materials);
    if (handle == RangeAllocator::kNoRange) {
        refusal = outOfCapacity("too many states of whole assets: raise DrawListConfig::wholeRangeCapacity", materials);
        return false;
    }
    uint32_t* ranges = wholeRanges.data() + wholeHandles.offset(handle);
    const std::span<uint8_t> levels(heldLevels.data(), view(asset).patchCount());
    scene->wholeLevels(asset, state, levels);
    for (uint32_t m = 0; m < materials; ++m) {
        const Status status = cache->acquireWhole(asset, m, state, levels, ranges[m]);
        if (status.ok()) continue;
        while (m-- > 0) cache->release(ranges[m]);
        wholeHandles.free(handle);
        refusal = status;
        return false;
    }
    held = {.holders = 1, .handle = handle, .firstRange = wholeHandles.offset(handle)};
    for (const uint8_t level : levels) held.finestLevel = std::min<uint32_t>(held.finestLevel, level);
    return true;
}

void DrawList::Impl::releaseWhole(uint32_t asset, uint32_t state, IndexCache& from) {
    WholeState& held = heldState(asset, state);
    assert(held.holders > 0);
    if (--held.holders > 0) return;
    for (uint32_t i = 0; i < wholeHandles.count(held.handle); ++i) from.release(wholeRanges[held.firstRange + i]);
    wholeHandles.free(held.handle);
    held = {};
}

// Instances ---------------------------------------------------------------------------------------------------------

/// Lets go of all that an instance holds: it is drawn no more.
void DrawList::Impl::release(DrawnInstance& own, IndexCache& from) {
    if (own.kind == InstanceKind::whole) releaseWhole(own.asset, own.wholeState, from);
    if (own.kind == InstanceKind::mixed) {
        for (uint32_t slot = own.firstSlot; slot < own.firstSlot + own.patchCount; ++slot) {
            if (slotRanges[slot] != kNoRange) from.release(slotRanges[slot]);
            slotRanges[slot] = kNoRange;
        }
    }
    stale |= own.kind != InstanceKind::culled;
    own.kind = InstanceKind::culled;
}

/// Lets go of what instances held that left the scene, before others take their slots.
void DrawList::Impl::dropGone() {
    for (uint32_t id = 0; id < scene->instanceEnd; ++id) {
        DrawnInstance& own = instances[id];
        const uint32_t generation = scene->instances[id].generation;
        if (own.generation == generation) continue;
        release(own, *cache);
        own = {.generation = generation};
        if (generation % 2 == 0) continue;
        const SceneInstance& instance = scene->instances[id];
        own.asset = instance.asset;
        own.firstSlot = instance.firstSlot;
        own.patchCount = view(instance.asset).patchCount();
    }
}

/// False, with the setting's name, where an asset is past what the list was created for.
bool DrawList::Impl::holds(uint32_t asset) {
    const AssetDesc& desc = scene->assets[asset].desc;
    const uint64_t materialEnd = desc.firstMaterial + uint64_t(desc.asset->materials.size());
    if (desc.asset->record->domainCount > config.domainCapacity) {
        refusal = outOfCapacity("an asset has too many domains: raise DrawListConfig::domainCapacity",
                                desc.asset->record->domainCount);
    } else if (materialEnd > config.materialCapacity) {
        refusal = outOfCapacity("too many materials: raise DrawListConfig::materialCapacity", materialEnd);
    } else {
        return true;
    }
    return false;
}

void DrawList::Impl::follow(uint32_t id) {
    DrawnInstance& own = instances[id];
    const InstanceKind kind = selection->kind(id);
    own.late = own.morphs = false;
    if (kind == InstanceKind::culled) return release(own, *cache);
    if (!holds(own.asset)) {
        own.late = true;
        ++stats.deferredInstances;
        return;
    }
    if (!assetsInSight[own.asset]) assetsInSight[own.asset] = holdWhole(own.asset, coarsestState(own.asset));
    own.late = kind == InstanceKind::whole ? !followWhole(own, selection->wholeState(id))
                                           : !followMixed(own, selection->levels(id), selection->visible(id));
    if (own.kind == InstanceKind::mixed && kind == InstanceKind::mixed) followFractions(own, id);
    stats.instances += own.kind != InstanceKind::culled;
    stats.deferredInstances += own.late;
}

/// The lambdas next to the selected ones that the drawn levels hold.
void DrawList::Impl::followFractions(DrawnInstance& own, uint32_t id) {
    const Levels target = selection->levels(id);
    const std::span<const float> wanted = selection->fractions(id);
    own.morphs = !wanted.empty();
    for (uint32_t p = 0; p < wanted.size(); ++p) {
        const uint32_t slot = own.firstSlot + p;
        const float ahead = float(target[p]) + wanted[p] - float(slotLevels[slot]);
        slotFractions[slot] = std::clamp(ahead, 0.0f, kMaxFraction);
    }
}

/// True where the instance stands as selected now.
bool DrawList::Impl::followWhole(DrawnInstance& own, uint32_t state) {
    if (scene->trianglesOf(own.asset, state) > config.wholeTriangles && state < coarsestState(own.asset)) {
        // Too large to be built at once.
        const std::span<uint8_t> levels(wholeLevels.data(), own.patchCount);
        scene->wholeLevels(own.asset, state, levels);
        return followMixed(own, levels, {allShown.data(), own.patchCount});
    }
    if (becomeWhole(own, state)) return true;
    if (own.kind != InstanceKind::whole) becomeCoarsest(own);
    return false;
}

/// False, and nothing changes, where the cache refuses.
bool DrawList::Impl::becomeWhole(DrawnInstance& own, uint32_t state) {
    if (own.kind == InstanceKind::whole && own.wholeState == state) return true;
    if (!holdWhole(own.asset, state)) return false;
    release(own, *cache);
    own.kind = InstanceKind::whole;
    own.wholeState = uint8_t(state);
    stale = true;
    return true;
}

/// The last resort, whose ranges are held already.
void DrawList::Impl::becomeCoarsest(DrawnInstance& own) {
    if (!becomeWhole(own, coarsestState(own.asset))) release(own, *cache);
}

// A mixed instance --------------------------------------------------------------------------------------------------

bool DrawList::Impl::stands(const DrawnInstance& own, Levels target, std::span<const uint8_t> shown) const {
    if (own.kind != InstanceKind::mixed) return false;
    for (uint32_t p = 0; p < own.patchCount; ++p) {
        const uint32_t slot = own.firstSlot + p;
        if (slotLevels[slot] != target[p] || (slotRanges[slot] != kNoRange) != bool(shown[p])) return false;
    }
    return true;
}

/// True where the instance stands as selected now.
bool DrawList::Impl::followMixed(DrawnInstance& own, Levels target, std::span<const uint8_t> shown) {
    if (stands(own, target, shown)) return true;
    if (own.kind != InstanceKind::mixed) {
        // Where it starts from. Until a plan is bound it stays as it is.
        const uint32_t state = own.kind == InstanceKind::whole ? own.wholeState : coarsestState(own.asset);
        scene->wholeLevels(own.asset, state, {slotLevels.data() + own.firstSlot, own.patchCount});
    }
    listChanges(own, target);
    uint32_t count = changeCount;
    bool bound = goTo(own, target, shown, count);
    while (!bound && count > 0) bound = goTo(own, target, shown, count /= 2);
    if (!bound || count < std::min(changeCount, 1u)) buildAhead(own, target, shown);
    // Where not even what must be shown has room.
    if (!bound && own.kind != InstanceKind::whole) becomeCoarsest(own);
    return stands(own, target, shown);
}

/// Patches that are to change their level, those first that are the most levels too coarse.
void DrawList::Impl::listChanges(const DrawnInstance& own, Levels target) {
    const uint8_t* now = slotLevels.data() + own.firstSlot;
    changeCount = 0;
    for (uint32_t p = 0; p < own.patchCount; ++p) {
        if (now[p] != target[p]) changes[changeCount++] = p;
    }
    const auto urgency = [&](uint32_t p) { return int(now[p]) - int(target[p]); };
    std::sort(changes.data(), changes.data() + changeCount,
              [&](uint32_t a, uint32_t b) { return urgency(a) != urgency(b) ? urgency(a) > urgency(b) : a < b; });
}

/// Makes the first `count` changes, and shows what is to be shown. False, and nothing changes, where that does not fit.
bool DrawList::Impl::goTo(DrawnInstance& own, Levels target, std::span<const uint8_t> shown, uint32_t count) {
    std::copy_n(slotLevels.data() + own.firstSlot, own.patchCount, planLevels.data());
    for (uint32_t i = 0; i < count; ++i) planLevels[changes[i]] = target[changes[i]];
    const Levels after{planLevels.data(), own.patchCount};
    listRebinds(own, after, shown);
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < rebindCount; ++i) bytes += cache->bytesNeeded(own.asset, rebinds[i].patch, after);
    if (bytes > cache->freeStagingBytes()) {
        refusal = outOfCapacity("a change does not fit the frame's staging memory: it comes in pieces, or give "
                                "IndexCache::beginFrame as many bytes as element says",
                                bytes);
        return false;
    }
    return bind(own, after, shown);
}

void DrawList::Impl::mark(uint32_t patch, std::span<const uint8_t> shown) {
    if (patchMarks[patch] == plan || !shown[patch]) return;
    patchMarks[patch] = plan;
    rebinds[rebindCount++] = {patch, kNoRange};
}

/// Lists the shown patches that have no range, or another one in the plan: those whose own vertices change, and all
/// that share a domain that does. Only domains of changed patches are looked at, each once.
void DrawList::Impl::listRebinds(const DrawnInstance& own, Levels after, std::span<const uint8_t> shown) {
    const AssetView& asset = view(own.asset);
    const Levels before{slotLevels.data() + own.firstSlot, own.patchCount};
    ++plan;
    rebindCount = 0;
    for (uint32_t p = 0; p < own.patchCount; ++p) {
        if (own.kind != InstanceKind::mixed || slotRanges[own.firstSlot + p] == kNoRange) mark(p, shown);
        if (before[p] == after[p] || own.kind != InstanceKind::mixed) continue;
        if (patchDiffers(asset, p, before[p], after[p])) mark(p, shown);
        for (const uint32_t domain : asset.domainsOf(p)) {
            if (domainMarks[domain] == plan) continue;
            domainMarks[domain] = plan;
            if (!domainDiffers(asset, domain, before, after)) continue;
            for (const uint32_t sharer : asset.patchesOf(domain)) mark(sharer, shown);
        }
    }
}

/// Goes to the plan's levels with the ranges of `rebinds`. False, and nothing changes, where the cache refuses one.
bool DrawList::Impl::bind(DrawnInstance& own, Levels after, std::span<const uint8_t> shown) {
    for (uint32_t i = 0; i < rebindCount; ++i) {
        const Status status = cache->acquire(own.asset, rebinds[i].patch, after, rebinds[i].range);
        if (status.ok()) continue;
        refusal = status;
        while (i-- > 0) cache->release(rebinds[i].range);
        return false;
    }
    if (own.kind == InstanceKind::whole) releaseWhole(own.asset, own.wholeState, *cache);
    const bool wasMixed = own.kind == InstanceKind::mixed;
    own.kind = InstanceKind::mixed;
    for (uint32_t i = 0; i < rebindCount; ++i) {
        uint32_t& range = slotRanges[own.firstSlot + rebinds[i].patch];
        if (range != kNoRange) cache->release(range);
        range = rebinds[i].range;
    }
    for (uint32_t p = 0; p < own.patchCount; ++p) {
        const uint32_t slot = own.firstSlot + p;
        stats.changedPatches += wasMixed && slotLevels[slot] != after[p];
        slotLevels[slot] = after[p];
        if (shown[p] || slotRanges[slot] == kNoRange) continue;
        cache->release(slotRanges[slot]);
        slotRanges[slot] = kNoRange;
    }
    stats.reboundPatches += rebindCount;
    stale = true;
    return true;
}

/// Builds of a plan what fits the frame, for the cache to keep: a change that is larger than a frame's staging comes
/// to be in the end.
void DrawList::Impl::buildAhead(const DrawnInstance& own, Levels after, std::span<const uint8_t> shown) {
    listRebinds(own, after, shown);
    for (uint32_t i = 0; i < rebindCount; ++i) {
        const Status status = cache->acquire(own.asset, rebinds[i].patch, after, rebinds[i].range);
        if (!status.ok()) {
            refusal = status;
            return;
        }
        cache->release(rebinds[i].range);
    }
}

// A frame -----------------------------------------------------------------------------------------------------------

/// Under a budget a late instance may be finer than was selected: such ones go to their coarsest state until the
/// frame holds it.
void DrawList::Impl::keepBudget() {
    const uint64_t budget = selection->stats().triangleBudget;
    if (budget == 0 || stats.deferredInstances == 0) return;
    for (uint32_t id = 0; id < scene->instanceEnd && stats.triangles > budget; ++id) {
        if (!instances[id].late || instances[id].kind == InstanceKind::culled) continue;
        becomeCoarsest(instances[id]);
        listDraws();
    }
}

void DrawList::update(const Scene& scene, const Selection& selection, IndexCache& cache) {
    assert(impl_ && "create is missing");
    Impl& d = *impl_;
    d.scene = &scene.impl();
    d.selection = &selection;
    d.cache = &cache;
    d.stats = {.triangles = d.stats.triangles};
    d.refusal = {};
    d.dropGone();
    for (uint32_t id = 0; id < d.scene->instanceEnd; ++id) {
        if (scene.hasInstance(id)) d.follow(id);
    }
    if (d.stale) d.listDraws();
    d.keepBudget();
}

void DrawList::forgetAsset(uint32_t asset, IndexCache& cache) {
    assert(impl_);
    Impl& d = *impl_;
    for (uint32_t id = 0; id < d.instances.size(); ++id) {
        if (d.instances[id].asset != asset) continue;
        d.release(d.instances[id], cache);
        d.instances[id] = {};
    }
    if (!d.assetsInSight[asset]) return;
    for (uint32_t state = 0; state < kMaxWholeStates; ++state) {
        if (d.heldState(asset, state).holders > 0) d.releaseWhole(asset, state, cache);
    }
    d.assetsInSight[asset] = 0;
    d.stale = true;
}

void DrawList::clear(IndexCache& cache) {
    for (uint32_t asset = 0; asset < impl_->assetsInSight.size(); ++asset) forgetAsset(asset, cache);
    impl_->drawCount = impl_->batchCount = impl_->drawInstanceCount = 0;
}

// What is drawn -----------------------------------------------------------------------------------------------------

std::span<const DrawCommand> DrawList::draws() const {
    return {impl_->draws.data(), impl_->drawCount};
}
std::span<const DrawSource> DrawList::sources() const {
    return {impl_->sources.data(), impl_->drawCount};
}
std::span<const DrawBatch> DrawList::batches() const {
    return {impl_->batches.data(), impl_->batchCount};
}
std::span<const uint32_t> DrawList::drawInstances() const {
    return {impl_->drawInstances.data(), impl_->drawInstanceCount};
}
const DrawStats& DrawList::stats() const {
    return impl_->stats;
}
const Status& DrawList::refusal() const {
    return impl_->refusal;
}
InstanceKind DrawList::kind(uint32_t id) const {
    return impl_->instances[id].kind;
}
uint32_t DrawList::wholeState(uint32_t id) const {
    assert(kind(id) == InstanceKind::whole);
    return impl_->instances[id].wholeState;
}
Levels DrawList::levels(uint32_t id) const {
    assert(kind(id) == InstanceKind::mixed);
    return {impl_->slotLevels.data() + impl_->instances[id].firstSlot, impl_->instances[id].patchCount};
}
std::span<const float> DrawList::fractions(uint32_t id) const {
    assert(kind(id) == InstanceKind::mixed);
    if (!impl_->instances[id].morphs) return {};
    return {impl_->slotFractions.data() + impl_->instances[id].firstSlot, impl_->instances[id].patchCount};
}

} // namespace xgc
