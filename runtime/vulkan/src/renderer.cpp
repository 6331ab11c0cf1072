#include <xgc/vulkan/renderer.h>

#include "asset_store.h"
#include "barriers.h"
#include "frame_records.h"
#include "pipelines.h"
#include "timeline.h"

#include <algorithm>
#include <cassert>

// Memory of the backend, all taken by `create`:
//
//   device-local   [ vertex arena: streams of assets, by address ]   [ index arena: ranges of the draw list ]
//                        ^ copies                                        ^ copies
//   mapped         [ staging: streams | indices ] x frames in flight
//   mapped         [ views | instances | draws | commands ] x frames in flight     [ materials ]
//
// Frame n writes part n % framesInFlight of the mapped buffers after it waited for frame n - framesInFlight.

namespace xgc::vulkan {
namespace {

constexpr VkDeviceSize kMinStagingBytes = 64 * 1024;

struct StoredInstance {
    uint32_t generation = 0; ///< odd while it is there
    uint32_t asset = 0;
};

DrawListConfig drawListConfig(const RendererConfig& config) {
    DrawListConfig out;
    out.instanceCapacity = config.instanceCapacity;
    out.patchCapacity = config.patchCapacity;
    out.materialCapacity = config.materialCapacity;
    out.slotCapacity = config.slotCapacity;
    out.domainCapacity = config.domainCapacity;
    out.indexCapacity = config.indexCapacity;
    out.framesInFlight = config.framesInFlight;
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
    record.mode = uint32_t(view.mode);
    record.linePixels = view.linePixels;
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
    DrawList drawList;

    std::vector<StoredInstance> instances;               ///< by id of the draw list
    std::vector<shader::InstanceRecord> instanceRecords; ///< likewise
    uint32_t instanceEnd = 0;                            ///< ids from here on were never used

    uint64_t frame = 0;
    VkDeviceSize indexStagingOffset = 0;
    uint32_t viewCount = 0;
    std::vector<VkBufferCopy> indexCopies; ///< reserved for one a patch
    FrameStats stats;

    Status allocate();
    StoredInstance* find(InstanceHandle handle);
    void writeDraws();
    void recordBatches(VkCommandBuffer cmd, shader::PushConstants push, bool wire) const;
};

// Set-up ------------------------------------------------------------------------------------------------------------

Renderer::Renderer() = default;
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Status Renderer::Impl::allocate() {
    Status status = drawList.create(drawListConfig(config));
    if (status.ok()) status = assets.create(*context, config);
    if (status.ok()) {
        status = indexArena.create(*context, VkDeviceSize(config.indexCapacity) * sizeof(uint32_t),
                                   VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                       VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                   Residence::device);
    }
    if (status.ok()) status = staging.create(*context, config.stagingBytes, config.framesInFlight);
    if (status.ok()) {
        status = records.create(
            *context, {config.viewCapacity, config.instanceCapacity, config.patchCapacity, config.framesInFlight});
    }
    if (status.ok()) status = timeline.create(*context);
    instances.resize(config.instanceCapacity);
    instanceRecords.resize(config.instanceCapacity);
    indexCopies.reserve(config.patchCapacity);
    return status;
}

Status Renderer::create(const Context& context, const RendererConfig& config) {
    if (config.stagingBytes < kMinStagingBytes || config.assetCapacity == 0 || config.viewCapacity == 0) {
        return {StatusCode::badArgument,
                "RendererConfig: stagingBytes must be 64 KiB or more, and no capacity may be zero", 0};
    }
    auto impl = std::make_unique<Impl>();
    impl->context = &context;
    impl->config = config;
    Status status = impl->allocate();
    if (status.ok()) {
        status = impl->pipelines.create(context,
                                        {config.colorFormat, config.depthFormat, config.samples, config.depthCompare});
    }
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

// Assets and instances ----------------------------------------------------------------------------------------------

Status Renderer::addAsset(const AssetView& asset, AssetHandle& handle) {
    return impl_->assets.add(asset, handle);
}

bool Renderer::resident(AssetHandle asset) const {
    return impl_->assets.find(asset) && impl_->assets.uploads().done(asset.index);
}

Status Renderer::removeAsset(AssetHandle asset) {
    return impl_->assets.remove(asset, impl_->frame);
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
    InstanceDesc desc;
    desc.asset = &asset->view;
    desc.firstMaterial = uint32_t(asset->materials.first);
    uint32_t id = 0;
    const Status status = self.drawList.addInstance(desc, id);
    if (!status.ok()) return status;
    ++asset->instanceCount;
    StoredInstance& instance = self.instances[id];
    instance = {instance.generation + 1, handle.index};
    shader::InstanceRecord& record = self.instanceRecords[id];
    record = {};
    setRows(record, placement);
    record.positions = asset->positions;
    record.normals = asset->normals;
    record.colors = asset->colors;
    record.colorFormat = uint32_t(asset->colorFormat);
    self.instanceEnd = std::max(self.instanceEnd, id + 1);
    out = {id, instance.generation};
    return {};
}

Status Renderer::setPlacement(InstanceHandle handle, const Placement& placement) {
    if (!impl_->find(handle)) return {StatusCode::badArgument, "setPlacement: no such instance", handle.index};
    setRows(impl_->instanceRecords[handle.index], placement);
    return {};
}

Status Renderer::removeInstance(InstanceHandle handle) {
    StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "removeInstance: no such instance", handle.index};
    impl_->drawList.removeInstance(handle.index);
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
    self.drawList.beginFrame({reinterpret_cast<uint32_t*>(rest.data()), rest.size() / sizeof(uint32_t)});
    self.viewCount = 0;
    return {};
}

Status Renderer::setLevels(InstanceHandle handle, Levels levels) {
    const StoredInstance* instance = impl_->find(handle);
    if (!instance) return {StatusCode::badArgument, "setLevels: no such instance", handle.index};
    if (!impl_->assets.uploads().done(instance->asset)) {
        return {StatusCode::outOfCapacity,
                "the asset is still on its way: ask again next frame, or raise RendererConfig::stagingBytes",
                instance->asset};
    }
    return impl_->drawList.setLevels(handle.index, levels);
}

Levels Renderer::levels(InstanceHandle handle) const {
    return impl_->find(handle) ? impl_->drawList.levels(handle.index) : Levels{};
}

void Renderer::Impl::writeDraws() {
    const std::span<const DrawCommand> commands = drawList.draws();
    const std::span<const DrawPatch> patches = drawList.drawPatches();
    std::copy(commands.begin(), commands.end(), records.commands());
    shader::DrawRecord* out = records.draws();
    for (size_t i = 0; i < patches.size(); ++i) {
        const StoredAsset& asset = assets.at(instances[patches[i].instance].asset);
        const format::PatchRecord& patch = asset.view.patches[patches[i].patch];
        const uint32_t level = drawList.levels(patches[i].instance)[patches[i].patch];
        shader::DrawRecord record{};
        record.instance = patches[i].instance;
        record.material = uint32_t(asset.materials.first) + patch.material;
        record.partColor = asset.partColors[patch.part];
        record.levelFraction = asset.view.levelCount() > 1 ? float(level) / float(asset.view.levelCount() - 1) : 0;
        out[i] = record;
    }
    std::copy_n(instanceRecords.begin(), instanceEnd, records.instances());
}

void Renderer::endFrame() {
    Impl& self = *impl_;
    self.drawList.endFrame();
    self.writeDraws();
    self.indexCopies.clear();
    for (const CopyRange& range : self.drawList.copies()) {
        constexpr VkDeviceSize size = sizeof(uint32_t);
        self.indexCopies.push_back(
            {self.indexStagingOffset + range.staging * size, range.arena * size, range.count * size});
    }
    self.stats = self.drawList.stats();
    self.stats.uploadBytes += uint32_t(self.assets.uploads().bytes());
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

void Renderer::Impl::recordBatches(VkCommandBuffer cmd, shader::PushConstants push, bool wire) const {
    const Functions& vk = context->vk();
    // Wire draws read the same commands as VkDrawIndirectCommand, which is a DrawCommand's first four words: its
    // vertexOffset, always 0 here, is taken for firstInstance, and the instance is found by the draw's record.
    const auto draw = wire ? vk.vkCmdDrawIndirect : vk.vkCmdDrawIndexedIndirect;
    for (const DrawBatch& batch : drawList.batches()) {
        for (uint32_t done = 0; done < batch.drawCount;) {
            const uint32_t count = std::min(batch.drawCount - done, context->maxDrawIndirectCount());
            push.firstDraw = batch.firstDraw + done;
            vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                                  sizeof(push), &push);
            draw(cmd, records.handle(), records.commandsOffset() + push.firstDraw * sizeof(DrawCommand), count,
                 sizeof(DrawCommand));
            done += count;
        }
    }
}

Status Renderer::recordDraws(VkCommandBuffer cmd, const ViewDesc& view) {
    Impl& self = *impl_;
    if (self.viewCount == self.config.viewCapacity) {
        return {StatusCode::outOfCapacity, "too many views a frame: raise RendererConfig::viewCapacity",
                self.viewCount + 1ull};
    }
    const Functions& vk = self.context->vk();
    self.records.views()[self.viewCount] = viewRecord(view);
    shader::PushConstants push{};
    push.view = self.records.viewAddress(self.viewCount++);
    push.instances = self.records.instancesAddress();
    push.draws = self.records.drawsAddress();
    push.materials = self.assets.materials().address();
    push.indices = self.indexArena.address();
    const bool wire = view.mode == ShadingMode::wire;
    vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, wire ? self.pipelines.wire() : self.pipelines.surface());
    vk.vkCmdBindIndexBuffer(cmd, self.indexArena.handle(), 0, VK_INDEX_TYPE_UINT32);
    self.recordBatches(cmd, push, wire);
    return {};
}

VkSemaphoreSubmitInfo Renderer::frameDone() const {
    return impl_->timeline.signal(impl_->frame);
}

FrameGeometry Renderer::geometry() const {
    const Impl& self = *impl_;
    FrameGeometry out;
    out.indices = self.indexArena.handle();
    out.indicesAddress = self.indexArena.address();
    out.commands = self.records.handle();
    out.commandsOffset = self.records.commandsOffset();
    out.instances = self.records.instancesAddress();
    out.draws = self.records.drawsAddress();
    out.materials = self.assets.materials().address();
    out.batches = self.drawList.batches();
    return out;
}

const FrameStats& Renderer::stats() const {
    return impl_->stats;
}

const DrawList& Renderer::drawList() const {
    return impl_->drawList;
}

std::optional<ShadingMode> modeNamed(std::string_view name) {
    constexpr std::string_view kNames[] = {"shaded", "parts", "levels", "wire"};
    for (uint32_t i = 0; i < std::size(kNames); ++i) {
        if (kNames[i] == name) return ShadingMode(i);
    }
    return {};
}

// Capacities --------------------------------------------------------------------------------------------------------

RendererConfig configFor(std::span<const AssetView* const> assets, uint32_t instances, const RendererConfig& base) {
    RendererConfig config = base;
    uint64_t patches = 0, materials = 0, faces = 0, streamBytes = 0, largestFaces = 0;
    for (const AssetView* asset : assets) {
        patches += asset->patchCount();
        materials += asset->materials.size();
        faces += asset->record->faceCount;
        largestFaces = std::max<uint64_t>(largestFaces, asset->record->faceCount);
        for (uint32_t i = 0; i < asset->vertexStreamCount; ++i) {
            streamBytes += asset->vertexStreams[i].bytes.size() + AssetStore::kAlignment;
        }
        config.slotCapacity = std::max(config.slotCapacity, scratchCapacity(*asset));
        config.domainCapacity = std::max(config.domainCapacity, asset->record->domainCount);
    }
    const auto grow = [](uint32_t& field, uint64_t least) {
        field = uint32_t(std::min<uint64_t>(std::max<uint64_t>(field, least), UINT32_MAX));
    };
    grow(config.assetCapacity, assets.size());
    grow(config.instanceCapacity, uint64_t(instances) * assets.size());
    grow(config.patchCapacity, patches * instances);
    grow(config.materialCapacity, materials);
    // Old ranges live on while frames that read them are in flight, so a whole change takes this many times the
    // indices.
    grow(config.indexCapacity, 3 * faces * instances * (1 + config.framesInFlight));
    config.vertexArenaBytes = std::max<VkDeviceSize>(config.vertexArenaBytes, streamBytes);
    // Half of it takes the whole of the largest asset at level 0 at once.
    config.stagingBytes = std::max<VkDeviceSize>(config.stagingBytes, 2 * 3 * sizeof(uint32_t) * largestFaces + 4096);
    return config;
}

} // namespace xgc::vulkan
