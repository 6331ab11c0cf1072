#include "renderer_impl.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace xgc::vulkan {
namespace {

constexpr VkDeviceSize kMinStagingBytes = 64 * 1024;

SceneConfig sceneConfig(const RendererConfig& config) {
    SceneConfig out;
    out.assetCapacity = config.assetCapacity;
    out.instanceCapacity = config.instanceCapacity;
    out.assetPatchCapacity = config.assetPatchCapacity;
    out.patchCapacity = config.patchCapacity;
    out.steeredPartCapacity = config.steeredPartCapacity;
    out.morphWeightCapacity = config.morphWeightCapacity;
    return out;
}

DrawListConfig drawListConfig(const RendererConfig& config) {
    DrawListConfig out;
    out.scene = sceneConfig(config);
    out.materialCapacity = config.materialCapacity;
    out.domainCapacity = config.domainCapacity;
    // Vertex streams may take half of the staging memory.
    const VkDeviceSize atOnce = config.stagingBytes / 2 / (3 * sizeof(uint32_t));
    out.wholeTriangles = uint32_t(std::min<VkDeviceSize>(out.wholeTriangles, atOnce));
    return out;
}

IndexCacheConfig indexCacheConfig(const RendererConfig& config) {
    IndexCacheConfig out;
    out.arenaBytes = config.indexBytes;
    out.rangeCapacity = std::max(out.rangeCapacity, 2 * config.patchCapacity);
    out.keyBytes = std::max(out.keyBytes, 64 * out.rangeCapacity);
    out.assetCapacity = config.assetCapacity;
    out.slotCapacity = config.slotCapacity;
    out.faceCapacity = config.faceCapacity;
    out.patchCapacity = config.assetPatchCapacity;
    out.framesInFlight = config.framesInFlight;
    out.narrowIndices = config.narrowIndices;
    return out;
}

void setRows(shader::InstanceRecord& record, const Placement& placement) {
    const glm::mat4x3& m = placement.toWorld;
    for (int row = 0; row < 3; ++row) record.toWorld[row] = {m[0][row], m[1][row], m[2][row], m[3][row]};
}

} // namespace

// Set-up ------------------------------------------------------------------------------------------------------------

Renderer::Renderer() = default;
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Status Renderer::Impl::allocate() {
    const IndexCacheConfig cache = indexCacheConfig(config);
    Status status = scene.create(sceneConfig(config));
    if (status.ok()) status = indexCache.create(cache);
    views.resize(config.viewCapacity);
    for (StoredView& view : views) {
        if (status.ok()) status = view.selection.create(sceneConfig(config));
        if (status.ok()) status = view.draws.create(drawListConfig(config));
    }
    if (status.ok()) status = assets.create(*context, config);
    if (status.ok()) status = streamedRows.create(*context, config);
    if (status.ok()) {
        status = indexArena.create(*context, config.indexBytes,
                                   VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                       VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                   Residence::device);
    }
    if (status.ok()) status = staging.create(*context, config.stagingBytes, config.framesInFlight);
    if (status.ok()) {
        status =
            records.create(*context, {config.passCapacity, config.viewCapacity, config.instanceCapacity,
                                      config.patchCapacity + DrawListConfig{}.wholeRangeCapacity, config.framesInFlight,
                                      config.morphGroupCapacity, config.jointCapacity, config.morphWeightCapacity});
    }
    if (status.ok()) status = timeline.create(*context);
    if (status.ok()) status = allocateGpu();
    joints.resize(config.jointCapacity);
    weights.resize(config.morphWeightCapacity);
    jointRanges.create(config.jointCapacity);
    weightRanges.create(config.morphWeightCapacity);
    instances.resize(config.instanceCapacity);
    instanceRecords.resize(config.instanceCapacity);
    storedAsset.resize(config.assetCapacity);
    indexCopies.reserve(cache.copyCapacity);
    return status;
}

Status Renderer::create(const Context& context, const RendererConfig& config) {
    if (config.stagingBytes < kMinStagingBytes || config.assetCapacity == 0 || config.viewCapacity == 0 ||
        config.passCapacity == 0) {
        return {StatusCode::badArgument,
                "RendererConfig: stagingBytes must be 64 KiB or more, and no capacity may be zero", 0};
    }
    auto impl = std::make_unique<Impl>();
    impl->context = &context;
    impl->config = config;
    Status status = impl->allocate();
    if (status.ok()) {
        status = impl->pipelines.create(context, {config.colorFormat, config.depthFormat, config.samples,
                                                  config.depthCompare, config.depthOnlySamples});
    }
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

// Assets and instances ----------------------------------------------------------------------------------------------

/// Brings a stored asset into scene, cache and compute path, or takes it out of the store again.
Status Renderer::Impl::enterAsset(AssetHandle handle) {
    StoredAsset& stored = assets.at(handle.index);
    // Of a streamed one the residency's own view: it knows its assets by that.
    const AssetView& view = stored.streamed == format::kNone ? stored.view : config.residency->view(stored.streamed);
    Status status;
    if (view.record->domainCount > config.domainCapacity) {
        status = {StatusCode::outOfCapacity, "the asset has too many domains: raise RendererConfig::domainCapacity",
                  view.record->domainCount};
    }
    if (status.ok()) {
        status = scene.addAsset({.asset = &view, .firstMaterial = uint32_t(stored.materials.first)}, stored.sceneAsset);
    }
    if (status.ok()) {
        status = indexCache.addAsset(stored.sceneAsset, view);
        if (status.ok()) {
            status = addGpuAsset(stored);
            if (!status.ok()) indexCache.removeAsset(stored.sceneAsset);
        }
        if (!status.ok()) scene.removeAsset(stored.sceneAsset);
    }
    if (status.ok()) {
        storedAsset[stored.sceneAsset] = handle.index;
        return {};
    }
    const Status removed = assets.remove(handle, frame);
    assert(removed.ok());
    (void)removed;
    return status;
}

Status Renderer::addAsset(const AssetView& asset, AssetHandle& out) {
    AssetHandle handle;
    Status status = impl_->assets.add(asset, handle);
    if (status.ok()) status = impl_->enterAsset(handle);
    if (status.ok()) out = handle;
    return status;
}

Status Renderer::addStreamedAsset(uint32_t residencyAsset, AssetHandle& out) {
    Impl& self = *impl_;
    if (!self.config.residency)
        return {StatusCode::badArgument, "addStreamedAsset: there is no RendererConfig::residency", 0};
    AssetHandle handle;
    Status status =
        self.assets.addStreamed(self.config.residency->view(residencyAsset), residencyAsset, self.streamedRows, handle);
    if (status.ok()) status = self.enterAsset(handle);
    if (status.ok()) out = handle;
    return status;
}

bool Renderer::Impl::resident(uint32_t asset) const {
    const StoredAsset& stored = assets.at(asset);
    return stored.streamed == format::kNone ? assets.uploads().done(asset) : config.residency->ready(stored.streamed);
}

bool Renderer::resident(AssetHandle asset) const {
    return impl_->assets.find(asset) && impl_->resident(asset.index);
}

Status Renderer::removeAsset(AssetHandle handle) {
    Impl& self = *impl_;
    const StoredAsset* asset = self.assets.find(handle);
    const uint32_t sceneAsset = asset ? asset->sceneAsset : 0;
    const bool onGpu = asset && asset->onGpu;
    const Status status = self.assets.remove(handle, self.frame);
    if (!status.ok()) return status;
    if (onGpu) self.gpuScene.removeAsset(sceneAsset, self.frame);
    if (!onGpu && self.hasGpu()) --self.assetsOffGpu;
    for (StoredView& view : self.views) {
        if (view.used) view.draws.forgetAsset(sceneAsset, self.indexCache);
    }
    self.indexCache.removeAsset(sceneAsset);
    self.scene.removeAsset(sceneAsset);
    return {};
}

StoredInstance* Renderer::Impl::find(InstanceHandle handle) {
    if (handle.index >= instances.size()) return nullptr;
    StoredInstance& instance = instances[handle.index];
    return instance.generation % 2 == 1 && instance.generation == handle.generation ? &instance : nullptr;
}

Status Renderer::addInstance(AssetHandle handle, const Placement& placement, InstanceHandle& out) {
    Impl& self = *impl_;
    StoredAsset* asset = self.assets.find(handle);
    if (!asset) return {StatusCode::badArgument, "addInstance: no such asset", handle.index};
    uint32_t id = 0;
    const Status status = self.scene.addInstance(asset->sceneAsset, placement, id);
    if (!status.ok()) return status;
    StoredInstance& instance = self.instances[id];
    if (asset->onGpu) {
        const Status added = self.gpuScene.addInstance(self.scene, id, instance.generation + 1);
        if (!added.ok()) {
            self.scene.removeInstance(id);
            return added;
        }
    }
    ++asset->instanceCount;
    instance = {instance.generation + 1, handle.index};
    shader::InstanceRecord& record = self.instanceRecords[id];
    record = {};
    setRows(record, placement);
    record.positions = asset->positions;
    record.normals = asset->normals;
    record.colors = asset->colors;
    record.colorFormat = uint32_t(asset->colorFormat);
    record.morphs = asset->morphs;
    for (int set = 0; set < 2; ++set) {
        record.joints[set] = asset->joints[size_t(set)];
        record.weights[set] = asset->weights[size_t(set)];
    }
    record.morphRows = asset->targetRows;
    record.morphDeltas = asset->targetDeltas;
    record.maxScale = placement.maxScale;
    self.instanceEnd = std::max(self.instanceEnd, id + 1);
    out = {id, instance.generation};
    return {};
}

Status Renderer::setPlacement(InstanceHandle handle, const Placement& placement) {
    if (!impl_->find(handle)) return {StatusCode::badArgument, "setPlacement: no such instance", handle.index};
    setRows(impl_->instanceRecords[handle.index], placement);
    impl_->instanceRecords[handle.index].maxScale = placement.maxScale;
    impl_->scene.setPlacement(handle.index, placement);
    if (impl_->isOnGpu(handle.index)) impl_->gpuScene.setPlacement(handle.index, placement);
    return {};
}

Status Renderer::setVisible(InstanceHandle handle, bool visible) {
    StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "setVisible: no such instance", handle.index};
    instance->visible = visible;
    return {};
}

/// Room for the pose's matrices and weights, taken at its first one.
Status Renderer::setPose(InstanceHandle handle, const Pose& pose) {
    Impl& self = *impl_;
    StoredInstance* instance = self.find(handle);
    if (!instance) return {StatusCode::badArgument, "setPose: no such instance", handle.index};
    const AssetView& asset = self.assets.at(instance->asset).view;
    const size_t joints = pose.joints.size(), weights = pose.morphWeights.size();
    if ((joints > 0 && joints != asset.joints.size()) || (weights > 0 && weights != asset.morphTargets.size())) {
        return {StatusCode::badArgument, "setPose: give a matrix a joint and a weight a target of the asset", joints};
    }
    if (weights > 0 && asset.residence)
        return {StatusCode::unsupported, "setPose: no morph target moves a streamed asset", weights};
    if (joints > 0 && instance->joints.count == 0 && !self.jointRanges.allocate(joints, instance->joints)) {
        return {StatusCode::outOfCapacity, "too many joints: raise RendererConfig::jointCapacity", joints};
    }
    if (weights > 0 && instance->weights.count == 0 && !self.weightRanges.allocate(weights, instance->weights)) {
        return {StatusCode::outOfCapacity, "too many targets: raise RendererConfig::morphWeightCapacity", weights};
    }
    const Status status = self.scene.setPose(handle.index, pose);
    if (!status.ok()) return status;
    for (size_t j = 0; j < joints; ++j) {
        const glm::mat4x3& m = pose.joints[j];
        JointRows& rows = self.joints[instance->joints.first + j];
        for (int row = 0; row < 3; ++row) rows[size_t(row)] = {m[0][row], m[1][row], m[2][row], m[3][row]};
    }
    std::copy(pose.morphWeights.begin(), pose.morphWeights.end(), self.weights.begin() + instance->weights.first);
    instance->skinned = joints > 0;
    instance->displaced = weights > 0 && !asset.morphDeltas.empty();
    return {};
}

void Renderer::Impl::releasePose(StoredInstance& instance) {
    jointRanges.free(std::exchange(instance.joints, {}));
    weightRanges.free(std::exchange(instance.weights, {}));
    instance.skinned = instance.displaced = false;
}

Status Renderer::clearPose(InstanceHandle handle) {
    StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "clearPose: no such instance", handle.index};
    impl_->releasePose(*instance);
    impl_->scene.clearPose(handle.index);
    return {};
}

Status Renderer::setPart(InstanceHandle handle, uint32_t part, const PartControl& control) {
    const StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "setPart: no such instance", handle.index};
    if (part >= impl_->assets.at(instance->asset).view.parts.size()) {
        return {StatusCode::badArgument, "setPart: the asset has no such part", part};
    }
    return impl_->scene.setPart(handle.index, part, control);
}

Status Renderer::clearParts(InstanceHandle handle) {
    if (!impl_->find(handle)) return {StatusCode::badArgument, "clearParts: no such instance", handle.index};
    impl_->scene.clearParts(handle.index);
    return {};
}

Status Renderer::removeInstance(InstanceHandle handle) {
    StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "removeInstance: no such instance", handle.index};
    if (impl_->isOnGpu(handle.index)) impl_->gpuScene.removeInstance(impl_->scene, handle.index);
    impl_->releasePose(*instance);
    impl_->scene.removeInstance(handle.index);
    --impl_->assets.at(instance->asset).instanceCount;
    ++instance->generation;
    return {};
}

} // namespace xgc::vulkan
