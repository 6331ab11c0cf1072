#include "scene.h"

#include <xgc/indices.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace xgc {
namespace {

Status outOfCapacity(const char* message, uint64_t element) {
    return {StatusCode::outOfCapacity, message, element};
}

PatchBounds boundsOf(const AssetView& asset, const format::PatchRecord& patch) {
    PatchBounds out{};
    out.sphere = {patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2], patch.sphereRadius};
    out.coneAxis = {patch.coneAxis[0], patch.coneAxis[1], patch.coneAxis[2]};
    const bool doubleSided = asset.materials[patch.material].flags & format::kDoubleSided;
    const bool cone = patch.coneCosine > 0 && !doubleSided;
    out.coneSine = cone ? std::sqrt(std::max(0.0f, 1 - patch.coneCosine * patch.coneCosine)) : 2;
    out.coneLevel = patch.coneLevel;
    out.part = patch.part;
    out.importance = asset.parts[patch.part].importance;
    return out;
}

} // namespace

// Set-up ------------------------------------------------------------------------------------------------------------

Scene::Scene() = default;
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

bool Scene::Impl::allocate() {
    return assets.allocate(config.assetCapacity) &&
           patchRanges.create(config.assetPatchCapacity, config.assetCapacity) &&
           patches.allocate(config.assetPatchCapacity) && lanes.allocate(config.assetPatchCapacity) &&
           wholeErrors.allocate(size_t(config.assetCapacity) * kMaxWholeStates) &&
           wholeTriangles.allocate(wholeErrors.size()) && levelScratch.allocate(config.assetPatchCapacity) &&
           instances.allocate(config.instanceCapacity) &&
           slotRanges.create(config.patchCapacity, config.instanceCapacity) &&
           controlRanges.create(config.steeredPartCapacity, config.instanceCapacity) &&
           controls.allocate(config.steeredPartCapacity) && posed.allocate(config.patchCapacity) &&
           weightRanges.create(config.morphWeightCapacity, config.instanceCapacity) &&
           morphWeights.allocate(config.morphWeightCapacity);
}

Status Scene::create(const SceneConfig& config) {
    if (config.assetCapacity == 0 || config.instanceCapacity == 0 || config.assetPatchCapacity == 0 ||
        config.patchCapacity == 0) {
        return {StatusCode::badArgument, "SceneConfig: every capacity but steeredPartCapacity must be at least 1", 0};
    }
    std::unique_ptr<Impl> impl(new (std::nothrow) Impl);
    if (impl) impl->config = config;
    if (!impl || !impl->allocate()) {
        return outOfCapacity("SceneConfig: not enough memory for these capacities; lower them", 0);
    }
    for (uint32_t id = config.assetCapacity; id-- > 0;) {
        impl->assets[id].nextFree = impl->freeAsset;
        impl->freeAsset = id;
    }
    impl_ = std::move(impl);
    return {};
}

const SceneConfig& Scene::config() const {
    return impl_->config;
}

// Assets ------------------------------------------------------------------------------------------------------------

const SceneAsset& Scene::Impl::assetAt(uint32_t id) const {
    assert(id < assets.size() && assets[id].desc.asset && "no such asset");
    return assets[id];
}

void Scene::Impl::fillTables(uint32_t id) {
    const SceneAsset& stored = assets[id];
    const AssetView& asset = *stored.desc.asset;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        patches[stored.firstPatch + p] = boundsOf(asset, asset.patches[p]);
        lanes.set(stored.firstPatch + p, patches[stored.firstPatch + p]);
    }
    fillWholeErrors(id);
    const std::span<uint8_t> levels(levelScratch.data(), asset.patchCount());
    assets[id].firstWhole = 0;
    for (uint32_t state = 0; state < stored.wholeStateCount; ++state) {
        wholeLevels(id, state, levels);
        uint32_t triangles = 0;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) triangles += triangleBound(asset, p, levels);
        wholeTriangles[size_t(id) * kMaxWholeStates + state] = triangles;
        // Of a streamed asset, states in which it needs its first pages alone.
        const auto streamed = [&](uint8_t level) { return asset.residence && asset.tierOf(level) > 0; };
        if (std::any_of(levels.begin(), levels.end(), streamed)) assets[id].firstWhole = state + 1;
    }
}

void Scene::Impl::fillWholeErrors(uint32_t id) {
    SceneAsset& stored = assets[id];
    const AssetView& asset = *stored.desc.asset;
    float least = std::numeric_limits<float>::infinity(), largest = 0;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        for (uint32_t level = 0; level < asset.levelCount(); ++level) {
            const float error = asset.error(p, level) * patches[stored.firstPatch + p].importance;
            if (error > 0) least = std::min(least, error);
            largest = std::max(largest, error);
        }
    }
    constexpr float kStep = 1.18920712f; // an octave in four
    constexpr float kRange = 1.0f / (1 << 30);
    float* errors = wholeErrors.data() + size_t(id) * kMaxWholeStates;
    uint32_t count = 0;
    errors[count++] = 0;
    for (float error = std::max(least, largest * kRange); error < largest && count + 1 < kMaxWholeStates;
         error *= kStep) {
        errors[count++] = error;
    }
    if (largest > 0) errors[count++] = largest;
    stored.wholeStateCount = count;
}

void Scene::Impl::wholeLevels(uint32_t id, uint32_t state, std::span<uint8_t> levels) const {
    const SceneAsset& stored = assets[id];
    const AssetView& asset = *stored.desc.asset;
    const float largest = errorsOf(id)[state];
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        const float importance = patches[stored.firstPatch + p].importance;
        uint32_t level = 0;
        while (level + 1 < asset.levelCount() && asset.error(p, level + 1) * importance <= largest) ++level;
        levels[p] = uint8_t(level);
    }
}

uint32_t Scene::wholeStateCount(uint32_t asset) const {
    return impl_->assetAt(asset).wholeStateCount;
}

float Scene::wholeError(uint32_t asset, uint32_t state) const {
    assert(state < impl_->assetAt(asset).wholeStateCount);
    return impl_->errorsOf(asset)[state];
}

void Scene::wholeLevels(uint32_t asset, uint32_t state, std::span<uint8_t> levels) const {
    assert(state < impl_->assetAt(asset).wholeStateCount);
    assert(levels.size() == impl_->assetAt(asset).desc.asset->patchCount());
    impl_->wholeLevels(asset, state, levels);
}

uint32_t Scene::wholeTriangles(uint32_t asset, uint32_t state) const {
    assert(state < impl_->assetAt(asset).wholeStateCount);
    return impl_->trianglesOf(asset, state);
}

Status Scene::addAsset(const AssetDesc& desc, uint32_t& id) {
    assert(impl_ && desc.asset && desc.asset->record);
    Impl& d = *impl_;
    const uint32_t patchCount = desc.asset->patchCount();
    if (d.freeAsset == format::kNone) {
        return outOfCapacity("too many assets: raise SceneConfig::assetCapacity", d.config.assetCapacity + 1ull);
    }
    const uint32_t range = patchCount ? d.patchRanges.allocate(patchCount) : format::kNone;
    if (patchCount && range == format::kNone) {
        return outOfCapacity("the assets have too many patches: raise SceneConfig::assetPatchCapacity", patchCount);
    }
    id = d.freeAsset;
    d.freeAsset = d.assets[id].nextFree;
    d.assets[id] = {.desc = desc, .patchRange = range};
    d.assets[id].firstPatch = patchCount ? d.patchRanges.offset(range) : 0;
    d.fillTables(id);
    return {};
}

void Scene::removeAsset(uint32_t id) {
    assert(impl_);
    Impl& d = *impl_;
    [[maybe_unused]] const SceneAsset& asset = d.assetAt(id);
    assert(asset.instanceCount == 0 && "remove its instances first");
    if (asset.patchRange != format::kNone) d.patchRanges.free(asset.patchRange);
    d.assets[id] = {.nextFree = d.freeAsset};
    d.freeAsset = id;
}

const AssetDesc& Scene::asset(uint32_t id) const {
    return impl_->assetAt(id).desc;
}

std::span<const PatchBounds> Scene::patchBounds(uint32_t id) const {
    const SceneAsset& asset = impl_->assetAt(id);
    return {impl_->patches.data() + asset.firstPatch, asset.desc.asset->patchCount()};
}

// Instances ---------------------------------------------------------------------------------------------------------

const SceneInstance& Scene::Impl::at(uint32_t id) const {
    assert(id < instanceEnd && instances[id].generation % 2 == 1 && "no such instance");
    return instances[id];
}

Status Scene::addInstance(uint32_t assetId, const Placement& placement, uint32_t& id) {
    assert(impl_ && placement.maxScale > 0 && "use makePlacement");
    Impl& d = *impl_;
    const uint32_t patchCount = d.assetAt(assetId).desc.asset->patchCount();
    if (d.freeInstance == format::kNone && d.instanceEnd == d.config.instanceCapacity) {
        return outOfCapacity("too many instances: raise SceneConfig::instanceCapacity", d.instanceEnd + 1ull);
    }
    const uint32_t range = patchCount ? d.slotRanges.allocate(patchCount) : format::kNone;
    if (patchCount && range == format::kNone) {
        return outOfCapacity("the instances have too many patches: raise SceneConfig::patchCapacity", patchCount);
    }
    id = d.freeInstance != format::kNone ? d.freeInstance : d.instanceEnd++;
    SceneInstance& instance = d.instances[id];
    d.freeInstance = instance.nextFree;
    instance = {.generation = instance.generation + 1, .asset = assetId, .placement = placement, .slotRange = range};
    instance.firstSlot = patchCount ? d.slotRanges.offset(range) : 0;
    ++d.assets[assetId].instanceCount;
    return {};
}

void Scene::removeInstance(uint32_t id) {
    assert(impl_);
    Impl& d = *impl_;
    SceneInstance& instance = d.at(id);
    clearParts(id);
    clearPose(id);
    if (instance.slotRange != format::kNone) d.slotRanges.free(instance.slotRange);
    --d.assets[instance.asset].instanceCount;
    instance = {.generation = instance.generation + 1, .nextFree = d.freeInstance};
    d.freeInstance = id;
}

void Scene::setPlacement(uint32_t id, const Placement& placement) {
    assert(placement.maxScale > 0 && "use makePlacement");
    impl_->at(id).placement = placement;
}

const Placement& Scene::placement(uint32_t id) const {
    return impl_->at(id).placement;
}

void Scene::setVisible(uint32_t id, bool visible) {
    impl_->at(id).visible = visible;
}

bool Scene::visible(uint32_t id) const {
    return impl_->at(id).visible;
}

uint32_t Scene::assetOf(uint32_t id) const {
    return impl_->at(id).asset;
}

uint32_t Scene::firstSlot(uint32_t id) const {
    return impl_->at(id).firstSlot;
}

uint32_t Scene::instanceEnd() const {
    return impl_->instanceEnd;
}

bool Scene::hasInstance(uint32_t id) const {
    return id < impl_->instanceEnd && impl_->instances[id].generation % 2 == 1;
}

// Poses -------------------------------------------------------------------------------------------------------------

Status Scene::setPose(uint32_t id, const Pose& pose) {
    assert(impl_);
    Impl& d = *impl_;
    SceneInstance& instance = d.at(id);
    const AssetView& asset = *d.assetAt(instance.asset).desc.asset;
    const auto count = uint32_t(pose.morphWeights.size());
    if (count > 0 && instance.weightRange == format::kNone) {
        const uint32_t range = d.weightRanges.allocate(count);
        if (range == format::kNone) {
            return outOfCapacity("too many weights of targets: raise SceneConfig::morphWeightCapacity", count);
        }
        instance.weightRange = range;
        instance.firstWeight = d.weightRanges.offset(range);
    }
    std::copy_n(pose.morphWeights.data(), count, d.morphWeights.data() + instance.firstWeight);
    instance.weightCount = count;
    instance.posedSphere = posePatches(asset, pose, {d.posed.data() + instance.firstSlot, asset.patchCount()});
    instance.posed = true;
    return {};
}

void Scene::clearPose(uint32_t id) {
    SceneInstance& instance = impl_->at(id);
    if (instance.weightRange != format::kNone) impl_->weightRanges.free(instance.weightRange);
    instance.weightRange = format::kNone;
    instance.weightCount = 0;
    instance.posed = false;
}

std::span<const PosedPatch> Scene::posedPatches(uint32_t id) const {
    const SceneInstance& instance = impl_->at(id);
    if (!instance.posed) return {};
    return {impl_->posed.data() + instance.firstSlot, impl_->assetAt(instance.asset).desc.asset->patchCount()};
}

glm::vec4 Scene::posedSphere(uint32_t id) const {
    assert(impl_->at(id).posed);
    return impl_->at(id).posedSphere;
}

std::span<const float> Scene::posedWeights(uint32_t id) const {
    const SceneInstance& instance = impl_->at(id);
    assert(instance.posed);
    return {impl_->morphWeights.data() + instance.firstWeight, instance.weightCount};
}

// Parts -------------------------------------------------------------------------------------------------------------

Status Scene::setPart(uint32_t id, uint32_t part, const PartControl& control) {
    assert(impl_);
    Impl& d = *impl_;
    SceneInstance& instance = d.at(id);
    const auto partCount = uint32_t(d.assetAt(instance.asset).desc.asset->parts.size());
    assert(part < partCount && "no such part");
    assert(control.importance > 0 && std::isfinite(control.importance));
    if (!instance.steered()) {
        const uint32_t range = d.controlRanges.allocate(partCount);
        if (range == format::kNone) {
            return outOfCapacity("too many parts are steered: raise SceneConfig::steeredPartCapacity", partCount);
        }
        instance.controlRange = range;
        instance.firstControl = d.controlRanges.offset(range);
        std::fill_n(d.controls.data() + instance.firstControl, partCount, PartControl{});
    }
    d.controls[instance.firstControl + part] = control;
    return {};
}

PartControl Scene::part(uint32_t id, uint32_t part) const {
    const SceneInstance& instance = impl_->at(id);
    assert(part < impl_->assetAt(instance.asset).desc.asset->parts.size() && "no such part");
    return instance.steered() ? impl_->controls[instance.firstControl + part] : PartControl{};
}

bool Scene::steered(uint32_t id) const {
    return impl_->at(id).steered();
}

void Scene::clearParts(uint32_t id) {
    SceneInstance& instance = impl_->at(id);
    if (instance.steered()) impl_->controlRanges.free(instance.controlRange);
    instance.controlRange = format::kNone;
}

} // namespace xgc
