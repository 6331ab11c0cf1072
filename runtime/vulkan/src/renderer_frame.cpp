#include "renderer_impl.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace xgc::vulkan {

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
    // Pages first, since they are drawn from now on. All streams take at most half, so that levels can change while
    // assets arrive.
    self.streamedRows.update(self.staging);
    const VkDeviceSize half = self.staging.bytesPerFrame() / 2;
    self.assets.uploads().fill(self.staging, half - std::min(half, self.streamedRows.bytes()));
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
        if (instance.generation % 2 == 1) scene.setVisible(id, instance.visible && resident(instance.asset));
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
    if (!impl_->resident(instance->asset)) {
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
        if (asset.residence) continue;
        const uint32_t count = groupCount(asset);
        if (count > config.morphGroupCapacity - used) {
            ++stats.unmorphedInstances;
            continue;
        }
        groupLambdas(asset, list.levels(id), list.fractions(id), {records.lambdas(view) + used, count});
        offsets[id] = std::exchange(used, used + count);
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
        if (self.config.residency) self.config.residency->drawn(self.scene, stored.draws);
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
    self.stats.uploadBytes = cache.uploadBytes + uint32_t(self.assets.uploads().bytes() + self.streamedRows.bytes());
}

} // namespace xgc::vulkan
