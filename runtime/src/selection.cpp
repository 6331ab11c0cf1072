#include "selection.h"

#include "continuous_level.h"

#include <cassert>
#include <cmath>

// An update looks at each instance once (without a budget), on any thread:
//
//   enter        forget what an earlier instance of this id left
//   decideWhole  far and unsteered: one state for all of it; near: a level each patch; in the belt between: as it was
//   cull         instance, then patches where it crosses the frustum
//   choose       levels by the policy, then controls, reference and cones
//
// The belt. An instance turns whole at its outer edge and mixed at its inner one, and its mixed patches only refine
// in it and a step around it: so going out and in again costs each patch one change of level, not one for itself
// and one for the instance.
//
//   eye | mixed, free | mixed, only refining       | whole
//       ------------- c(1-h) ------- c ----------- c/(1-h)^2 ---> distance, in radii; c: wholeBeyond, h: hysteresis
//                       whole again here ^

namespace xgc {
namespace {

bool beyond(float radii, const Standing& at) {
    return reaches(radii * (at.scale * at.radius), at.distanceSquared);
}

} // namespace

// Set-up ------------------------------------------------------------------------------------------------------------

Selection::Selection() = default;
Selection::~Selection() = default;
Selection::Selection(Selection&&) noexcept = default;
Selection& Selection::operator=(Selection&&) noexcept = default;

bool Selection::Impl::allocate() {
    return instances.allocate(config.instanceCapacity) && wanted.allocate(config.patchCapacity) &&
           levels.allocate(config.patchCapacity) && visible.allocate(config.patchCapacity) &&
           fractions.allocate(config.patchCapacity) && keptFrom.allocate(config.patchCapacity) &&
           keptBefore.allocate(config.patchCapacity) &&
           chunks.allocate((size_t(config.instanceCapacity) + kChunk - 1) / kChunk);
}

Status Selection::create(const SceneConfig& config) {
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (impl) impl->config = config;
    if (!impl || !impl->allocate()) {
        return {StatusCode::outOfCapacity, "SceneConfig: not enough memory for a selection of these capacities", 0};
    }
    impl_ = std::move(impl);
    return {};
}

/// But for the eye, and what is culled.
bool asksForTheSame(const SelectionDesc& a, const SelectionDesc& b) {
    return a.policy == b.policy && a.pixels == b.pixels && a.hysteresis == b.hysteresis &&
           a.triangleBudget == b.triangleBudget && a.view.orthographic == b.view.orthographic &&
           a.view.pixelsPerUnit == b.view.pixelsPerUnit && a.view.nearest == b.view.nearest;
}

void Selection::Impl::begin(const Scene& of, const SelectionDesc& wish) {
    const bool same = scene == &of.impl() && asksForTheSame(desc, wish);
    if (!same) ++epoch;
    steadyPolicy = same && wish.policy == Policy::errorPixels && !wish.view.orthographic && wish.triangleBudget == 0;
    scene = &of.impl();
    desc = wish;
    assert(scene->config.instanceCapacity <= config.instanceCapacity && "a selection for a smaller scene");
    assert(scene->config.patchCapacity <= config.patchCapacity && "a selection for a smaller scene");
    assert(desc.view.pixelsPerUnit >= 0 && desc.pixels >= 0 && desc.contributionPixels >= 0);
    assert(desc.hysteresis >= 0 && desc.hysteresis < 1);
    assert(std::is_sorted(desc.bands.begin(), desc.bands.end()));
    assert(desc.triangleBudget == 0 || desc.policy == Policy::errorPixels);
    assert(!desc.morph || (desc.hysteresis == 0 && desc.triangleBudget == 0));
    assert(!desc.morph || desc.morphRate > 0);
    assert((!desc.reference || desc.reference->impl_->scene == scene) && "update the reference first");
    policy = levelPolicy(desc, desc.pixels);
    stats = {.triangleBudget = desc.triangleBudget};
}

// One instance ------------------------------------------------------------------------------------------------------

Selection::Impl::Subject Selection::Impl::subject(uint32_t id) {
    const SceneInstance& instance = scene->instances[id];
    const SceneAsset& stored = scene->assets[instance.asset];
    const AssetView& asset = *stored.desc.asset;
    const size_t count = asset.patchCount();
    const auto slots = [&](FixedArray<uint8_t>& all) { return std::span(all.data() + instance.firstSlot, count); };
    Subject s{.instance = instance,
              .stored = stored,
              .asset = asset,
              .own = instances[id],
              .patches = {scene->patches.data() + stored.firstPatch, count},
              .controls = {},
              .posed = {},
              .morphWeights = {},
              .wanted = slots(wanted),
              .levels = slots(levels),
              .visible = slots(visible),
              .fractions = {fractions.data() + instance.firstSlot, count}};
    if (instance.posed) {
        s.posed = {scene->posed.data() + instance.firstSlot, count};
        s.morphWeights = {scene->morphWeights.data() + instance.firstWeight, instance.weightCount};
    }
    if (instance.steered()) s.controls = {scene->controls.data() + instance.firstControl, asset.parts.size()};
    if (desc.reference) {
        const Impl& reference = *desc.reference->impl_;
        if (reference.instances[id].generation == instance.generation) {
            s.reference = &reference;
            s.referenceOwn = &reference.instances[id];
        }
    }
    return s;
}

LevelTest Selection::Impl::Subject::wholeTest(const LevelPolicy& by, const Scene::Impl& in) const {
    const Sphere sphere = sphereOf(*asset.record);
    // The errors have the parts' importance in them.
    return {by, in.errorsOf(instance.asset), 1, sphere.radius, standingFor(by, instance.placement, sphere)};
}

void Selection::Impl::enter(uint32_t id) {
    ViewInstance& own = instances[id];
    const uint32_t generation = scene->instances[id].generation;
    if (own.generation != generation) own = {.generation = generation};
}

void Selection::Impl::decideWhole(const Subject& s) {
    const float keep = 1 - desc.hysteresis, inner = desc.wholeBeyond, outer = inner / (keep * keep);
    const bool was = s.own.whole;
    s.own.whole = s.own.inBelt = false;
    // What was out of sight takes its levels at once.
    s.own.morphs = s.own.morphs && desc.morph && s.own.kind == InstanceKind::mixed;
    if (desc.morph || !s.posed.empty() || desc.policy != Policy::errorPixels) {
        // Nothing is whole: whole states go by errors, and by those of the unposed asset.
    } else if (s.controls.empty() && s.referenceOwn) {
        s.own.whole = s.referenceOwn->whole;
        s.own.inBelt = s.referenceOwn->inBelt;
    } else if (s.controls.empty() && !desc.view.orthographic) {
        const Standing at = standing(s.instance.placement, desc.view, sphereOf(*s.asset.record));
        s.own.whole = beyond(was ? inner : outer, at);
        s.own.inBelt = !s.own.whole && beyond(inner * keep, at);
    }
    if (s.own.whole && s.stored.firstWhole > 0) {
        const LevelTest test = s.wholeTest(policy, *scene);
        s.own.whole = s.stored.firstWhole < test.levelCount() && test.fits(s.stored.firstWhole, policy.middle);
    }
    if (s.own.whole && !was) s.own.wholeState = uint8_t(kNoLevel);
    if (!s.own.whole && (was || s.own.fresh)) s.own.keptEpoch = 0;
    if (!s.own.whole && was && s.own.wholeState != kNoLevel) {
        scene->wholeLevels(s.instance.asset, s.own.wholeState, s.wanted);
    } else if (!s.own.whole && (was || s.own.fresh)) {
        std::fill(s.wanted.begin(), s.wanted.end(), uint8_t(kNoLevel));
    }
    s.own.fresh = false;
}

// Culling -----------------------------------------------------------------------------------------------------------

/// Writes the instance's kind and, where it is mixed, which patches are in the frustum and large enough.
void Selection::Impl::cull(const Subject& s) {
    const Placement& placement = s.instance.placement;
    const Sphere bounds = s.bounds();
    const Sphere inWorld{placement.toWorld * glm::vec4(bounds.center, 1), bounds.radius * placement.maxScale};
    const bool minding = desc.contributionPixels > 0;
    const auto small = [&](const Sphere& sphere) {
        if (!minding) return false;
        const Standing at = standing(placement, desc.view, sphere);
        return tooSmall(desc.contributionPixels, desc.view.pixelsPerUnit, desc.view.orthographic, at);
    };
    const Side side = sideOf(desc.frustum, inWorld);
    s.own.kind = s.own.whole ? InstanceKind::whole : InstanceKind::mixed;
    if (!s.instance.visible || side == Side::outside || small(bounds)) s.own.kind = InstanceKind::culled;
    if (s.own.kind != InstanceKind::mixed) return;
    const Frustum frustum = side == Side::across ? toMeshSpace(desc.frustum, placement.toWorld) : Frustum{};
    if (frustum.planeCount == 0 && !minding && s.controls.empty()) {
        std::fill(s.visible.begin(), s.visible.end(), uint8_t(1));
        return;
    }
    for (size_t p = 0; p < s.patches.size(); ++p) {
        const Sphere sphere = s.patchBounds(uint32_t(p));
        const bool out = sideOf(frustum, sphere) == Side::outside;
        s.visible[p] = !out && !small(sphere) && !s.hidden(uint32_t(p));
    }
}

// Levels ------------------------------------------------------------------------------------------------------------

/// What a patch has in the reference; where it is culled there, what it would have.
uint32_t Selection::Impl::levelThere(const Subject& s, uint32_t patch, uint32_t hint) const {
    const uint32_t slot = s.instance.firstSlot + patch;
    if (s.referenceOwn->kind == InstanceKind::mixed && s.reference->visible[slot]) return s.reference->levels[slot];
    const LevelTest test = s.patchTest(s.reference->policy, patch);
    return s.controlled(patch, test.coarsest(s.reference->policy.tight, hint));
}

/// No coarser than the reference allows.
uint32_t Selection::Impl::withReference(const Subject& s, uint32_t patch, uint32_t level) const {
    if (!s.reference) return level;
    return std::min(level, levelThere(s, patch, level) + desc.coarserThanReference);
}

float Selection::Impl::continuousWithReference(const Subject& s, uint32_t patch, float lambda) const {
    if (!s.reference) return lambda;
    const uint32_t slot = s.instance.firstSlot + patch;
    const bool morphs = s.referenceOwn->kind == InstanceKind::mixed && s.referenceOwn->morphs;
    const float there = morphs ? float(s.reference->levels[slot]) + s.reference->fractions[slot]
                               : float(levelThere(s, patch, uint32_t(lambda)));
    return std::min(lambda, there + float(desc.coarserThanReference));
}

void Selection::Impl::chooseWhole(const Subject& s, ChunkCount& count) {
    uint32_t level = s.wholeTest(policy, *scene).next(s.own.wholeState);
    if (s.reference && s.referenceOwn->wholeState != kNoLevel) {
        level = std::min<uint32_t>(level, s.referenceOwn->wholeState + desc.coarserThanReference);
    }
    s.own.wholeState = uint8_t(std::max(level, s.stored.firstWhole));
    if (s.own.kind == InstanceKind::whole) ++count.stats.wholeInstances;
}

void Selection::Impl::chooseMixed(const Subject& s, ChunkCount& count) {
    s.own.keptEpoch = 0;
    const MeshEye eye = s.eye(desc);
    const uint32_t coarsest = s.asset.levelCount() - 1;
    const bool mayCoarsen = !s.own.inBelt || desc.triangleBudget > 0;
    count.stats.consideredPatches += uint32_t(s.patches.size());
    uint32_t culled = 0, changed = 0;
    for (uint32_t p = 0; p < s.patches.size(); ++p) {
        uint32_t level = coarsest;
        if (s.visible[p]) {
            const uint32_t own = s.patchTest(policy, p).next(s.wanted[p], mayCoarsen);
            s.wanted[p] = uint8_t(own);
            level = std::max(withReference(s, p, s.controlled(p, own)), s.asset.finestLevel(p));
            // Its cone holds at coneLevel and finer ones alone.
            if (level <= s.patches[p].coneLevel && turnedAway(eye, s.patches[p])) {
                s.visible[p] = 0;
                level = std::min(s.patches[p].coneLevel, coarsest);
            }
        }
        culled += !s.visible[p];
        changed += s.levels[p] != level;
        s.levels[p] = uint8_t(level);
    }
    count.stats.culledPatches += culled;
    count.stats.changedPatches += changed;
}

/// The continuous level of a patch; one that glides comes nearer to it, by no more than the rate.
float Selection::Impl::nextLambda(const Subject& s, uint32_t patch, bool glides) const {
    float lambda = continuousLevel(s.patchTest(policy, patch));
    if (!s.controls.empty()) lambda = steered(s.controls[s.patches[patch].part], lambda, s.asset.levelCount());
    lambda = continuousWithReference(s, patch, lambda);
    const float before = s.lambda(patch);
    if (glides) lambda = std::clamp(lambda, before - desc.morphRate, before + desc.morphRate);
    return std::max(lambda, float(s.asset.finestLevel(patch)));
}

void Selection::Impl::chooseContinuous(const Subject& s, ChunkCount& count) {
    const MeshEye eye = s.eye(desc);
    const bool glides = s.own.morphs;
    s.own.keptEpoch = 0;
    s.own.morphs = true;
    count.stats.consideredPatches += uint32_t(s.patches.size());
    for (uint32_t p = 0; p < s.patches.size(); ++p) {
        const uint8_t before = s.levels[p];
        // Of what is culled too: the boundaries that it shares with what is seen go by it.
        const float lambda = nextLambda(s, p, glides);
        s.levels[p] = s.wanted[p] = uint8_t(lambda);
        s.fractions[p] = std::min(lambda - float(s.levels[p]), kMaxFraction);
        const bool inCone = lambda <= float(s.patches[p].coneLevel);
        if (s.visible[p] && inCone && turnedAway(eye, s.patches[p])) s.visible[p] = 0;
        count.stats.culledPatches += !s.visible[p];
        count.stats.changedPatches += before != s.levels[p];
    }
}

void Selection::Impl::choose(uint32_t id, ChunkCount& count) {
    const Subject s = subject(id);
    // A culled one too: it is what references and the way back go by.
    if (s.own.whole) chooseWhole(s, count);
    if (s.own.kind == InstanceKind::mixed && desc.morph) {
        chooseContinuous(s, count);
    } else if (s.own.kind == InstanceKind::mixed && isSteady(s)) {
        chooseSteady(s, count);
    } else if (s.own.kind == InstanceKind::mixed) {
        chooseMixed(s, count);
    }
    count.stats.visibleInstances += s.own.kind != InstanceKind::culled;
}

void Selection::update(const Scene& scene, const SelectionDesc& desc) {
    assert(impl_ && "create is missing");
    Impl& d = *impl_;
    d.begin(scene, desc);
    const auto look = [&d](uint32_t id) {
        d.enter(id);
        const Impl::Subject s = d.subject(id);
        d.decideWhole(s);
        d.cull(s);
    };
    if (desc.triangleBudget > 0) {
        d.forInstances([&](uint32_t id, ChunkCount&) { look(id); });
        d.meetBudget();
    } else {
        d.forInstances([&](uint32_t id, ChunkCount& count) {
            look(id);
            d.choose(id, count);
        });
    }
    const uint32_t chunkCount = (d.scene->instanceEnd + Impl::kChunk - 1) / Impl::kChunk;
    for (uint32_t chunk = 0; chunk < chunkCount; ++chunk) {
        const SelectionStats& part = d.chunks[chunk].stats;
        d.stats.visibleInstances += part.visibleInstances;
        d.stats.wholeInstances += part.wholeInstances;
        d.stats.consideredPatches += part.consideredPatches;
        d.stats.culledPatches += part.culledPatches;
        d.stats.changedPatches += part.changedPatches;
    }
    d.stats.pixels = d.policy.loose.pixels;
}

void Selection::set(const Scene& scene, uint32_t id, Levels levels, std::span<const float> own) {
    assert(impl_ && scene.hasInstance(id));
    Impl& d = *impl_;
    d.scene = &scene.impl();
    d.desc.reference = nullptr;
    d.enter(id);
    const Impl::Subject s = d.subject(id);
    assert(levels.size() == s.asset.patchCount());
    assert(std::all_of(levels.begin(), levels.end(), [&](uint8_t l) { return l < s.asset.levelCount(); }));
    s.own.kind = s.instance.visible ? InstanceKind::mixed : InstanceKind::culled;
    s.own.whole = false;
    s.own.fresh = false;
    s.own.keptEpoch = 0;
    s.own.morphs = !own.empty();
    assert(own.empty() || own.size() == levels.size());
    std::copy(own.begin(), own.end(), s.fractions.begin());
    for (uint32_t p = 0; p < levels.size(); ++p) {
        s.levels[p] = uint8_t(std::max<uint32_t>(levels[p], s.asset.finestLevel(p)));
        if (s.levels[p] != levels[p] && !own.empty()) s.fractions[p] = 0;
    }
    std::copy(levels.begin(), levels.end(), s.wanted.begin());
    for (uint32_t p = 0; p < levels.size(); ++p) s.visible[p] = !s.hidden(p);
}

// What was chosen ---------------------------------------------------------------------------------------------------

InstanceKind Selection::kind(uint32_t id) const {
    return impl_->scene && impl_->instances[id].generation == impl_->scene->at(id).generation
               ? impl_->instances[id].kind
               : InstanceKind::culled;
}

uint32_t Selection::wholeState(uint32_t id) const {
    assert(kind(id) == InstanceKind::whole);
    return impl_->instances[id].wholeState;
}

Levels Selection::levels(uint32_t id) const {
    assert(kind(id) == InstanceKind::mixed);
    const SceneInstance& instance = impl_->scene->at(id);
    return {impl_->levels.data() + instance.firstSlot, impl_->scene->assetAt(instance.asset).desc.asset->patchCount()};
}

std::span<const uint8_t> Selection::visible(uint32_t id) const {
    assert(kind(id) == InstanceKind::mixed);
    const SceneInstance& instance = impl_->scene->at(id);
    return {impl_->visible.data() + instance.firstSlot, impl_->scene->assetAt(instance.asset).desc.asset->patchCount()};
}

std::span<const float> Selection::fractions(uint32_t id) const {
    assert(kind(id) == InstanceKind::mixed);
    if (!impl_->instances[id].morphs) return {};
    const SceneInstance& instance = impl_->scene->at(id);
    return {impl_->fractions.data() + instance.firstSlot,
            impl_->scene->assetAt(instance.asset).desc.asset->patchCount()};
}

const SelectionStats& Selection::stats() const {
    return impl_->stats;
}

} // namespace xgc
