#include <xgc/vulkan/renderer.h>

#include "asset_store.h"
#include "barriers.h"
#include "frame_records.h"
#include "gpu_view.h"
#include "pipelines.h"
#include "timeline.h"

#include <algorithm>
#include <cassert>
#include <utility>

// Memory of the backend, all taken by `create`:
//
//   device-local   [ vertex arena: streams of assets, by address ]   [ index arena: ranges of the draw list ]
//                        ^ copies                                        ^ copies
//   mapped         [ staging: streams | indices ] x frames in flight
//   mapped         [ views | instances | draws | commands | lambdas ] x frames in flight     [ materials ]
//
// Frame n writes part n % framesInFlight of the mapped buffers after it waited for frame n - framesInFlight.

namespace xgc::vulkan {
namespace {

constexpr VkDeviceSize kMinStagingBytes = 64 * 1024;

struct StoredInstance {
    uint32_t generation = 0; ///< odd while it is there
    uint32_t asset = 0;
    bool visible = true; ///< the host's wish; it is while its asset is resident
    // Of its pose, in the renderer's lists.
    RangeList::Range joints{}, weights{};
    bool posed = false, skinned = false, displaced = false;
};

/// A view with levels of its own.
struct StoredView {
    Selection selection;
    DrawList draws;
    bool used = false;                               ///< was asked for levels
    const char* hostReason = "GpuPathConfig::views"; ///< null: `gpu` chooses
    GpuView gpu;

    bool onDevice() const { return used && !hostReason; }
};

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

shader::ViewRecord viewRecord(const ViewDesc& view) {
    const Camera::Basis basis = view.camera.basis();
    shader::ViewRecord record{};
    record.worldToClip = view.camera.worldToClip();
    record.eye = glm::vec4(view.camera.eye, 1);
    record.right = glm::vec4(basis.right, 0);
    record.up = glm::vec4(basis.up, 0);
    record.forward = glm::vec4(basis.forward, 0);
    record.sky = glm::vec4(view.sky, 0);
    record.measure = glm::vec4(view.measured.eye, view.measured.pixelsPerUnit / std::max(view.errorPixels, 1e-6f));
    record.mode = uint32_t(view.mode);
    record.linePixels = view.linePixels;
    record.highlightInstance = view.highlightInstance;
    record.highlightPart = view.highlightPart;
    if (!view.sun || view.mode != ShadingMode::shaded) return record;
    record.sun = glm::vec4(view.sun->towards, view.sun->texelUnits);
    record.sunColor = glm::vec4(view.sun->color, 1);
    record.shadow = view.sun->depths;
    record.shadowSize = view.sun->size;
    record.worldToShadow = view.sun->worldToClip;
    return record;
}

} // namespace

struct Renderer::Impl {
    const Context* context = nullptr;
    RendererConfig config;
    Pipelines pipelines;
    AssetStore assets;
    Buffer indexArena;
    StagingRing staging;
    FrameRecords records;
    Timeline timeline;
    Scene scene;
    IndexCache indexCache;
    std::vector<StoredView> views;
    GpuPipelines gpuPipelines;
    GpuScene gpuScene;
    const char* gpuLacks = nullptr;    ///< what the device has not, for the compute path
    uint32_t assetsOffGpu = 0;         ///< that the path cannot draw
    std::vector<uint32_t> storedAsset; ///< by id of the scene's asset: its index in the store

    std::vector<StoredInstance> instances;               ///< by id in the scene
    std::vector<shader::InstanceRecord> instanceRecords; ///< likewise
    uint32_t instanceEnd = 0;                            ///< ids from here on were never used
    RangeList jointRanges, weightRanges;
    std::vector<JointRows> joints; ///< of all poses
    std::vector<float> weights;    ///< of targets, likewise
    uint32_t poseCount = 0;        ///< instances with a pose

    uint64_t frame = 0;
    VkDeviceSize indexStagingOffset = 0;
    uint32_t passCount = 0;
    std::vector<VkBufferCopy> indexCopies; ///< reserved for all that a frame may have
    FrameStats stats;

    Status allocate();
    Status allocateGpu();
    bool hasGpu() const { return config.gpu.views > 0 && !gpuLacks; }
    bool isOnGpu(uint32_t instance) const { return assets.at(instances[instance].asset).onGpu; }
    Status addGpuAsset(StoredAsset& asset);
    const char* hostReason(uint32_t view, const SelectionDesc& desc) const;
    void writeGpu();
    StoredInstance* find(InstanceHandle handle);
    void showResident();
    void writePoses();
    void releasePose(StoredInstance& instance);
    void writeDraws(uint32_t view);
    void writeLambdas(uint32_t view);
    Status beginPass(uint32_t view, const shader::ViewRecord& record, shader::PushConstants& push);
    enum class Which : uint32_t { all, opaque, masked };
    void recordBatches(VkCommandBuffer cmd, uint32_t view, shader::PushConstants push, const Pipelines::Pair& pair,
                       Which which) const;
    struct GpuDraws {
        uint32_t view;
        bool late;
        VkPipeline pipeline;
        bool indexed;
    };
    void recordGpuDraws(VkCommandBuffer cmd, const GpuDraws& what, shader::PushConstants push) const;
    Status recordDraws(VkCommandBuffer cmd, const ViewDesc& desc, bool late);
};

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

Status Renderer::Impl::allocateGpu() {
    if (config.gpu.views == 0) return {};
    if (!context->hasDrawIndirectCount()) gpuLacks = "drawIndirectCount";
    if (gpuLacks) return {};
    Status status = gpuPipelines.create(*context);
    if (status.ok()) status = gpuScene.create(*context, config);
    for (uint32_t view = 0; view < std::min(config.gpu.views, config.viewCapacity) && status.ok(); ++view) {
        status = views[view].gpu.create(*context, config, gpuScene.stateCapacity());
    }
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

// The compute path --------------------------------------------------------------------------------------------------

/// An asset that the path cannot draw is no failure: views are then selected on the host.
Status Renderer::Impl::addGpuAsset(StoredAsset& asset) {
    asset.onGpu = false;
    if (!hasGpu()) return {};
    const Status status = gpuScene.addAsset(scene, asset.sceneAsset, asset.partColors);
    asset.onGpu = status.ok();
    if (status.code != StatusCode::unsupported) return status;
    ++assetsOffGpu;
    return {};
}

/// By name; null where nothing speaks against it.
const char* Renderer::Impl::hostReason(uint32_t view, const SelectionDesc& desc) const {
    if (view >= config.gpu.views) return "GpuPathConfig::views";
    if (gpuLacks) return gpuLacks;
    if (poseCount > 0) return "an instance with a pose";
    if (assetsOffGpu > 0) return "an asset that is streamed, or has a patch of more than 1024 domains";
    return GpuView::lacks(desc);
}

void Renderer::Impl::recordGpuDraws(VkCommandBuffer cmd, const GpuDraws& what, shader::PushConstants push) const {
    const Functions& vk = context->vk();
    const GpuView& gpu = views[what.view].gpu;
    const GpuView::Lists& lists = gpu.lists(what.late);
    push.draws = gpu.address() + lists.draws;
    push.indices = gpu.indices(what.late).address();
    push.instanceIds = gpu.address() + lists.ids;
    push.lambdaOffsets = push.lambdas = 0;
    vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                          sizeof(push), &push);
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, what.pipeline);
    if (what.indexed) vk.vkCmdBindIndexBuffer(cmd, gpu.indices(what.late).handle(), 0, VK_INDEX_TYPE_UINT32);
    const auto draw = what.indexed ? vk.vkCmdDrawIndexedIndirectCount : vk.vkCmdDrawIndirectCount; // as recordBatches
    draw(cmd, gpu.buffer(), lists.commands, gpu.buffer(), lists.totals + offsetof(shader::GpuTotals, drawCount),
         gpu.drawCapacity(), sizeof(DrawCommand));
}

void Renderer::useOcclusion(uint32_t view, bool use) {
    assert(view < impl_->views.size() && "raise RendererConfig::viewCapacity");
    impl_->views[view].gpu.useOcclusion(use);
}

Status Renderer::recordOcclusion(VkCommandBuffer cmd, const ViewDesc& desc, VkImage depth, VkExtent2D size) {
    StoredView& stored = impl_->views[desc.view];
    if (!stored.onDevice() || !stored.gpu.occludes()) return {};
    return stored.gpu.recordLate(cmd, impl_->gpuPipelines, desc.camera.worldToClip(), depth, size);
}

Status Renderer::recordLateDraws(VkCommandBuffer cmd, const ViewDesc& desc) {
    const StoredView& stored = impl_->views[desc.view];
    if (!stored.onDevice() || !stored.gpu.occludes()) return {};
    return impl_->recordDraws(cmd, desc, true);
}

const char* Renderer::hostReason(uint32_t view) const {
    return impl_->views[view].hostReason;
}

const GpuStats& Renderer::gpuStats(uint32_t view) const {
    return impl_->views[view].gpu.stats();
}

// Assets and instances ----------------------------------------------------------------------------------------------

Status Renderer::addAsset(const AssetView& asset, AssetHandle& out) {
    Impl& self = *impl_;
    AssetHandle handle;
    Status status = self.assets.add(asset, handle);
    if (!status.ok()) return status;
    StoredAsset& stored = self.assets.at(handle.index);
    status = self.scene.addAsset({.asset = &stored.view, .firstMaterial = uint32_t(stored.materials.first)},
                                 stored.sceneAsset);
    if (status.ok()) {
        status = self.indexCache.addAsset(stored.sceneAsset, stored.view);
        if (status.ok()) {
            status = self.addGpuAsset(stored);
            if (!status.ok()) self.indexCache.removeAsset(stored.sceneAsset);
        }
        if (!status.ok()) self.scene.removeAsset(stored.sceneAsset);
    }
    if (!status.ok()) {
        const Status removed = self.assets.remove(handle, self.frame);
        assert(removed.ok());
        (void)removed;
        return status;
    }
    self.storedAsset[stored.sceneAsset] = handle.index;
    out = handle;
    return {};
}

bool Renderer::resident(AssetHandle asset) const {
    return impl_->assets.find(asset) && impl_->assets.uploads().done(asset.index);
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
    self.poseCount += !std::exchange(instance->posed, true);
    instance->skinned = joints > 0;
    instance->displaced = weights > 0 && !asset.morphDeltas.empty();
    return {};
}

void Renderer::Impl::releasePose(StoredInstance& instance) {
    jointRanges.free(std::exchange(instance.joints, {}));
    weightRanges.free(std::exchange(instance.weights, {}));
    poseCount -= std::exchange(instance.posed, false);
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

// A frame -----------------------------------------------------------------------------------------------------------

Status Renderer::beginFrame() {
    Impl& self = *impl_;
    const uint64_t next = self.frame + 1;
    if (next > self.config.framesInFlight) {
        const Status status = self.timeline.wait(next - self.config.framesInFlight, self.config.waitNanoseconds);
        if (!status.ok()) return status;
    }
    self.frame = next;
    self.assets.reclaim(self.frame, self.config.framesInFlight);
    self.records.begin(self.frame);
    self.staging.begin(self.frame);
    // Streams take at most half, so that levels can change while assets arrive.
    self.assets.uploads().fill(self.staging, self.staging.bytesPerFrame() / 2);
    const std::span<std::byte> rest = self.staging.take(self.staging.freeBytes(), self.indexStagingOffset);
    self.indexCache.beginFrame(rest);
    self.passCount = 0;
    self.showResident();
    return {};
}

/// Instances whose assets are on their way are in no view.
void Renderer::Impl::showResident() {
    for (uint32_t id = 0; id < instanceEnd; ++id) {
        const StoredInstance& instance = instances[id];
        if (instance.generation % 2 == 1)
            scene.setVisible(id, instance.visible && assets.uploads().done(instance.asset));
    }
}

void Renderer::select(uint32_t view, const SelectionDesc& desc) {
    assert(view < impl_->views.size() && "raise RendererConfig::viewCapacity");
    StoredView& stored = impl_->views[view];
    const bool wasOnDevice = stored.onDevice();
    stored.used = true;
    stored.hostReason = impl_->hostReason(view, desc);
    if (stored.onDevice()) {
        if (!wasOnDevice) stored.draws.clear(impl_->indexCache);
        stored.gpu.ask(desc);
    } else {
        stored.selection.update(impl_->scene, desc);
    }
}

Status Renderer::setLevels(InstanceHandle handle, Levels levels, std::span<const float> fractions) {
    const StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "setLevels: no such instance", handle.index};
    if (!impl_->assets.uploads().done(instance->asset)) {
        return {StatusCode::outOfCapacity,
                "the asset is still on its way: ask again next frame, or raise RendererConfig::stagingBytes",
                instance->asset};
    }
    impl_->views[0].selection.set(impl_->scene, handle.index, levels, fractions);
    impl_->views[0].used = true;
    impl_->views[0].hostReason = "setLevels";
    return {};
}

void Renderer::Impl::writeDraws(uint32_t view) {
    const DrawList& list = views[view].draws;
    std::copy(list.draws().begin(), list.draws().end(), records.commands(view));
    std::copy(list.drawInstances().begin(), list.drawInstances().end(), records.ids(view));
    shader::DrawRecord* out = records.draws(view);
    for (const DrawBatch& batch : list.batches()) {
        for (uint32_t i = batch.firstDraw; i < batch.firstDraw + batch.drawCount; ++i) {
            const DrawSource& source = list.sources()[i];
            const StoredAsset& asset = assets.at(storedAsset[source.asset]);
            const bool whole = source.patch == format::kNone;
            shader::DrawRecord record{};
            record.firstInstance = list.draws()[i].firstInstance;
            record.material = batch.material;
            record.partColor =
                whole ? shader::kPartColorCount : asset.partColors[asset.view.patches[source.patch].part];
            const uint32_t coarsest = std::max(asset.view.levelCount(), 2u) - 1;
            record.levelFraction = float(source.level) / float(coarsest);
            record.vertexOffset = uint32_t(list.draws()[i].vertexOffset);
            record.indexBytes = batch.indexBytes;
            record.error =
                whole ? scene.wholeError(source.asset, source.level) : asset.view.error(source.patch, source.level);
            record.part = whole ? shader::kNothing : asset.view.patches[source.patch].part;
            out[i] = record;
        }
    }
}

/// One behind the other, of the instances that morph.
void Renderer::Impl::writeLambdas(uint32_t view) {
    if (config.morphGroupCapacity == 0) return;
    const DrawList& list = views[view].draws;
    uint32_t* offsets = records.lambdaOffsets(view);
    std::fill_n(offsets, instanceEnd, shader::kNoLambdas);
    uint32_t used = 0;
    for (const uint32_t id : list.drawInstances()) {
        if (list.kind(id) != InstanceKind::mixed || list.fractions(id).empty()) continue;
        const AssetView& asset = assets.at(instances[id].asset).view;
        const uint32_t count = groupCount(asset);
        if (count > config.morphGroupCapacity - used) {
            ++stats.unmorphedInstances;
            continue;
        }
        groupLambdas(asset, list.levels(id), list.fractions(id), {records.lambdas(view) + used, count});
        offsets[id] = std::exchange(used, used + count);
    }
}

void Renderer::Impl::writeGpu() {
    bool written = false;
    for (StoredView& view : views) {
        if (!view.onDevice()) continue;
        if (!std::exchange(written, true)) gpuScene.write(scene, frame);
        view.gpu.write(gpuScene, frame);
    }
}

/// Joints and weights, and where each posed instance finds its own this frame.
void Renderer::Impl::writePoses() {
    std::copy(joints.begin(), joints.end(), records.joints());
    std::copy(weights.begin(), weights.end(), records.morphWeights());
    for (uint32_t id = 0; id < instanceEnd; ++id) {
        const StoredInstance& instance = instances[id];
        shader::InstanceRecord& record = instanceRecords[id];
        record.pose = instance.skinned ? records.jointsAddress() + instance.joints.first * sizeof(JointRows) : 0;
        record.morphWeights =
            instance.displaced ? records.morphWeightsAddress() + instance.weights.first * sizeof(float) : 0;
    }
}

void Renderer::endFrame() {
    Impl& self = *impl_;
    self.stats = {};
    for (uint32_t view = 0; view < self.views.size(); ++view) {
        StoredView& stored = self.views[view];
        if (!stored.used || stored.onDevice()) continue;
        stored.draws.update(self.scene, stored.selection, self.indexCache);
        self.writeDraws(view);
        self.writeLambdas(view);
        const DrawStats& drawn = stored.draws.stats();
        self.stats.triangles += drawn.triangles;
        self.stats.draws += uint32_t(stored.draws.draws().size());
        self.stats.patchesChanged += drawn.changedPatches;
        self.stats.deferredInstances += drawn.deferredInstances;
    }
    self.indexCache.endFrame();
    self.writePoses();
    self.writeGpu();
    std::copy_n(self.instanceRecords.begin(), self.instanceEnd, self.records.instances());
    self.indexCopies.clear();
    for (const CopyRange& range : self.indexCache.copies()) {
        self.indexCopies.push_back({self.indexStagingOffset + range.staging, range.arena, range.bytes});
    }
    const IndexCacheStats cache = self.indexCache.stats();
    self.stats.patchesRebuilt = cache.misses;
    self.stats.uploadBytes = cache.uploadBytes + uint32_t(self.assets.uploads().bytes());
}

// Recording ---------------------------------------------------------------------------------------------------------

void Renderer::recordTransfers(VkCommandBuffer cmd) const {
    const Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    // No barrier before the copies: ranges are reused only after the host has seen the frames that read them finish.
    const std::span<const VkBufferCopy> streams = self.assets.uploads().copies();
    if (!streams.empty()) {
        vk.vkCmdCopyBuffer(cmd, self.staging.handle(), self.assets.arena().handle(), uint32_t(streams.size()),
                           streams.data());
    }
    if (!self.indexCopies.empty()) {
        vk.vkCmdCopyBuffer(cmd, self.staging.handle(), self.indexArena.handle(), uint32_t(self.indexCopies.size()),
                           self.indexCopies.data());
    }
    for (const StoredView& view : self.views) {
        if (view.onDevice()) view.gpu.record(cmd, self.gpuPipelines);
    }
    if (streams.empty() && self.indexCopies.empty()) return;
    memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                  {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                   VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT});
}

void Renderer::recordBackground(VkCommandBuffer cmd) const {
    const Functions& vk = impl_->context->vk();
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, impl_->pipelines.background());
    vk.vkCmdDraw(cmd, 3, 1, 0, 0);
}

/// Draws the batches of one kind of material.
void Renderer::Impl::recordBatches(VkCommandBuffer cmd, uint32_t view, shader::PushConstants push,
                                   const Pipelines::Pair& pair, Which which) const {
    const Functions& vk = context->vk();
    // Wire draws read the same commands as VkDrawIndirectCommand, which is a DrawCommand's first four words: its
    // vertexOffset is taken for firstInstance, and the instances and rows are found by the draw's record.
    const bool indexed = pair != pipelines.wire();
    const auto draw = indexed ? vk.vkCmdDrawIndexedIndirect : vk.vkCmdDrawIndirect;
    uint32_t bound = 0;
    VkPipeline boundPipeline = VK_NULL_HANDLE;
    for (const DrawBatch& batch : views[view].draws.batches()) {
        const AssetStore::MaterialKind kind = assets.kindOf(batch.material);
        if (which != Which::all && kind.masked != (which == Which::masked)) continue;
        const VkPipeline pipeline = pair[kind.posable];
        if (std::exchange(boundPipeline, pipeline) != pipeline) {
            vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
        }
        if (indexed && std::exchange(bound, batch.indexBytes) != batch.indexBytes) {
            const VkIndexType type = batch.indexBytes == 2 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32;
            vk.vkCmdBindIndexBuffer(cmd, indexArena.handle(), 0, type);
        }
        for (uint32_t done = 0; done < batch.drawCount;) {
            const uint32_t count = std::min(batch.drawCount - done, context->maxDrawIndirectCount());
            push.firstDraw = batch.firstDraw + done;
            vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                  sizeof(push), &push);
            draw(cmd, records.handle(), records.commandsOffset(view) + push.firstDraw * sizeof(DrawCommand), count,
                 sizeof(DrawCommand));
            done += count;
        }
    }
}

/// Takes the next of the frame's pass records.
Status Renderer::Impl::beginPass(uint32_t view, const shader::ViewRecord& record, shader::PushConstants& push) {
    if (passCount == config.passCapacity) {
        return {StatusCode::outOfCapacity, "too many passes a frame: raise RendererConfig::passCapacity",
                passCount + 1ull};
    }
    if (view >= views.size()) {
        return {StatusCode::outOfCapacity, "no such view: raise RendererConfig::viewCapacity", view + 1ull};
    }
    records.passes()[passCount] = record;
    push = {};
    push.view = records.passAddress(passCount++);
    push.instances = records.instancesAddress();
    push.draws = records.drawsAddress(view);
    push.materials = assets.materials().address();
    push.indices = indexArena.address();
    push.instanceIds = records.idsAddress(view);
    push.lambdaOffsets = records.lambdaOffsetsAddress(view);
    push.lambdas = records.lambdasAddress(view);
    return {};
}

Status Renderer::Impl::recordDraws(VkCommandBuffer cmd, const ViewDesc& desc, bool late) {
    shader::PushConstants push;
    const Status status = beginPass(desc.view, viewRecord(desc), push);
    if (!status.ok()) return status;
    const bool wire = desc.mode == ShadingMode::wire;
    if (views[desc.view].onDevice()) {
        const Pipelines::Pair& shaded = assets.anyMasked() ? pipelines.surfaceMasked() : pipelines.surface();
        recordGpuDraws(cmd, {desc.view, late, wire ? pipelines.wire()[0] : shaded[0], !wire}, push);
    } else if (wire) {
        recordBatches(cmd, desc.view, push, pipelines.wire(), Which::all);
    } else {
        recordBatches(cmd, desc.view, push, pipelines.surface(), Which::opaque);
        recordBatches(cmd, desc.view, push, pipelines.surfaceMasked(), Which::masked);
    }
    return {};
}

Status Renderer::recordDepth(VkCommandBuffer cmd, const DepthDesc& desc) {
    Impl& self = *impl_;
    shader::ViewRecord record{};
    record.worldToClip = desc.worldToClip;
    shader::PushConstants push;
    const Status status = self.beginPass(desc.view, record, push);
    if (!status.ok()) return status;
    self.context->vk().vkCmdSetDepthBias(cmd, desc.constantBias, 0, desc.slopeBias);
    const Pipelines& pipelines = self.pipelines;
    if (self.views[desc.view].onDevice()) {
        const Pipelines::Pair& pair = self.assets.anyMasked() ? pipelines.depthMasked() : pipelines.depth();
        self.recordGpuDraws(cmd, {desc.view, false, pair[0], true}, push);
        return {};
    }
    self.recordBatches(cmd, desc.view, push, pipelines.depth(), Impl::Which::opaque);
    self.recordBatches(cmd, desc.view, push, pipelines.depthMasked(), Impl::Which::masked);
    return {};
}

Status Renderer::recordDraws(VkCommandBuffer cmd, const ViewDesc& desc) {
    return impl_->recordDraws(cmd, desc, false);
}

VkSemaphoreSubmitInfo Renderer::frameDone() const {
    return impl_->timeline.signal(impl_->frame);
}

FrameGeometry Renderer::geometry(uint32_t view) const {
    const Impl& self = *impl_;
    assert(view < self.views.size());
    FrameGeometry out;
    out.indices = self.indexArena.handle();
    out.indicesAddress = self.indexArena.address();
    out.commands = self.records.handle();
    out.commandsOffset = self.records.commandsOffset(view);
    out.instances = self.records.instancesAddress();
    out.instanceIds = self.records.idsAddress(view);
    out.draws = self.records.drawsAddress(view);
    out.materials = self.assets.materials().address();
    out.batches = self.views[view].draws.batches();
    out.lambdaOffsets = self.records.lambdaOffsetsAddress(view);
    out.lambdas = self.records.lambdasAddress(view);
    return out;
}

const FrameStats& Renderer::stats() const {
    return impl_->stats;
}

const Scene& Renderer::scene() const {
    return impl_->scene;
}

const Selection& Renderer::selection(uint32_t view) const {
    return impl_->views[view].selection;
}

const DrawList& Renderer::drawList(uint32_t view) const {
    return impl_->views[view].draws;
}

const IndexCache& Renderer::indexCache() const {
    return impl_->indexCache;
}

std::optional<ShadingMode> modeNamed(std::string_view name) {
    constexpr std::string_view kNames[] = {"shaded", "parts", "levels", "wire", "error"};
    for (uint32_t i = 0; i < std::size(kNames); ++i) {
        if (kNames[i] == name) return ShadingMode(i);
    }
    return {};
}

// Capacities --------------------------------------------------------------------------------------------------------

RendererConfig configFor(std::span<const AssetView* const> assets, uint32_t instances, const RendererConfig& base) {
    RendererConfig config = base;
    uint64_t patches = 0, materials = 0, faces = 0, streamBytes = 0, largestFaces = 0, groups = 0, joints = 0,
             targets = 0;
    for (const AssetView* asset : assets) {
        patches += asset->patchCount();
        materials += asset->materials.size();
        faces += asset->record->faceCount;
        largestFaces = std::max<uint64_t>(largestFaces, asset->record->faceCount);
        config.faceCapacity = std::max(config.faceCapacity, asset->record->maxPatchFaces);
        groups += groupCount(*asset);
        streamBytes += AssetStore::bytesOf(*asset, config.morphGroupCapacity > 0);
        joints += asset->joints.size();
        targets += asset->morphTargets.size();
        config.slotCapacity = std::max(config.slotCapacity, scratchCapacity(*asset));
        config.domainCapacity = std::max(config.domainCapacity, asset->record->domainCount);
    }
    const auto grow = [](uint32_t& field, uint64_t least) {
        field = uint32_t(std::min<uint64_t>(std::max<uint64_t>(field, least), UINT32_MAX));
    };
    grow(config.assetCapacity, assets.size());
    grow(config.instanceCapacity, uint64_t(instances) * assets.size());
    grow(config.assetPatchCapacity, patches);
    grow(config.patchCapacity, patches * instances);
    grow(config.materialCapacity, materials);
    grow(config.jointCapacity, joints * instances);
    grow(config.morphWeightCapacity, targets * instances);
    if (config.morphGroupCapacity > 0) grow(config.morphGroupCapacity, groups * instances);
    // Twice what is held: of mixed instances all, and what frames in flight still read of a whole change.
    grow(config.indexBytes, 2 * 3 * sizeof(uint32_t) * faces * instances * (1 + config.framesInFlight));
    config.vertexArenaBytes = std::max<VkDeviceSize>(config.vertexArenaBytes, streamBytes);
    // Half of it takes the whole of the largest asset at level 0 at once.
    config.stagingBytes = std::max<VkDeviceSize>(config.stagingBytes, 2 * 3 * sizeof(uint32_t) * largestFaces + 4096);
    return config;
}

} // namespace xgc::vulkan
