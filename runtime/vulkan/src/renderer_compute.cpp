#include "renderer_impl.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace xgc::vulkan {

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
    if (assetsOffGpu > 0) return "an asset that is streamed, or has a patch of more than 1024 domains";
    return GpuView::lacks(desc);
}

void Renderer::Impl::writeGpu() {
    bool written = false;
    for (StoredView& view : views) {
        if (!view.onDevice()) continue;
        if (!std::exchange(written, true)) gpuScene.write(scene, frame);
        view.gpu.write(gpuScene, frame);
    }
}

void Renderer::Impl::recordGpuDraws(VkCommandBuffer cmd, const GpuDraws& what, shader::PushConstants push) const {
    const Functions& vk = context->vk();
    const GpuView& gpu = views[what.view].gpu;
    const GpuView::Lists& lists = gpu.lists(what.late);
    push.draws = gpu.address() + lists.draws;
    push.indices = gpu.indices(what.late).address();
    push.instanceIds = gpu.address() + lists.ids;
    push.lambdaOffsets = push.lambdas = 0;
    if (what.indexed) vk.vkCmdBindIndexBuffer(cmd, gpu.indices(what.late).handle(), 0, VK_INDEX_TYPE_UINT32);
    const auto draw = what.indexed ? vk.vkCmdDrawIndexedIndirectCount : vk.vkCmdDrawIndirectCount; // as recordBatches
    for (uint32_t kind = 0; kind < shader::kDrawKinds; ++kind) {
        if (!gpu.hasKind(kind)) continue;
        const Pipelines::Pair& pair = kind & shader::kDrawMasked ? what.masked : what.opaque;
        const GpuView::DrawRange range = gpu.drawRange(what.late, kind);
        push.firstDraw = range.first;
        vk.vkCmdPushConstants(cmd, pipelines.layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                              sizeof(push), &push);
        vk.vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pair[kind & shader::kDrawPosable]);
        draw(cmd, gpu.buffer(), range.command, gpu.buffer(), range.count, gpu.drawCapacity(), sizeof(DrawCommand));
    }
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

} // namespace xgc::vulkan
