#include "renderer_impl.h"

#include "barriers.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace xgc::vulkan {
namespace {

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

void Renderer::recordTransfers(VkCommandBuffer cmd) const {
    const Impl& self = *impl_;
    const Functions& vk = self.context->vk();
    // No barrier before the copies: ranges are reused only after the host has seen the frames that read them finish.
    const std::span<const VkBufferCopy> streams = self.assets.uploads().copies();
    if (!streams.empty()) {
        vk.vkCmdCopyBuffer(cmd, self.staging.handle(), self.assets.arena().handle(), uint32_t(streams.size()),
                           streams.data());
    }
    const std::span<const VkBufferCopy> pages = self.streamedRows.copies();
    if (!pages.empty()) {
        vk.vkCmdCopyBuffer(cmd, self.staging.handle(), self.streamedRows.rows().handle(), uint32_t(pages.size()),
                           pages.data());
    }
    if (!self.indexCopies.empty()) {
        vk.vkCmdCopyBuffer(cmd, self.staging.handle(), self.indexArena.handle(), uint32_t(self.indexCopies.size()),
                           self.indexCopies.data());
    }
    for (const StoredView& view : self.views) {
        if (view.onDevice()) view.gpu.record(cmd, self.gpuPipelines);
    }
    if (streams.empty() && pages.empty() && self.indexCopies.empty()) return;
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
    if (views[desc.view].onDevice() && wire) {
        recordGpuDraws(cmd, {desc.view, late, pipelines.wire(), pipelines.wire(), false}, push);
    } else if (views[desc.view].onDevice()) {
        recordGpuDraws(cmd, {desc.view, late, pipelines.surface(), pipelines.surfaceMasked(), true}, push);
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
        self.recordGpuDraws(cmd, {desc.view, false, pipelines.depth(), pipelines.depthMasked(), true}, push);
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

} // namespace xgc::vulkan
