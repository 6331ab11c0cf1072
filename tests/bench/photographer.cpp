#include "photographer.h"

#include <array>
#include <map>

namespace xgc::bench {

Status Photographer::create(uint32_t width, uint32_t height) {
    Status status = device_.create();
    if (status.ok()) status = context_.create(device_.contextDesc());
    if (!status.ok()) return status;
    vulkan::OffscreenDesc desc;
    desc.size = {width, height};
    return target_.create(context_, device_.queue(), desc);
}

Status Photographer::begin(std::span<const AssetView* const> assets, uint32_t copies) {
    vulkan::RendererConfig base;
    base.vertexArenaBytes = 0;
    vulkan::RendererConfig config = vulkan::configFor(assets, copies, base);
    config.vertexArenaBytes *= 4; // those of the pictures before, which frames in flight may read
    renderer_ = std::make_unique<vulkan::Renderer>();
    return renderer_->create(context_, config);
}

Status Photographer::drawFrame(const vulkan::Camera& camera, uint64_t& ticket) {
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    Status status = target_.begin(cmd);
    if (!status.ok()) return status;
    renderer_->recordTransfers(cmd);
    target_.beginRendering(cmd, std::array{0.0f, 0.0f, 0.0f, 1.0f});
    renderer_->recordBackground(cmd);
    vulkan::ViewDesc view;
    view.camera = camera;
    status = renderer_->recordDraws(cmd, view);
    target_.endRendering(cmd);
    return status.ok() ? target_.submit(std::array{renderer_->frameDone()}, ticket) : status;
}

Status Photographer::take(const std::vector<Posed>& scene, const vulkan::Camera& camera, bake::Image& out) {
    std::map<const AssetView*, vulkan::AssetHandle> handles;
    std::vector<vulkan::InstanceHandle> instances(scene.size());
    Status status;
    for (size_t i = 0; i < scene.size() && status.ok(); ++i) {
        vulkan::AssetHandle& handle = handles[scene[i].asset];
        if (handle.generation == 0) status = renderer_->addAsset(*scene[i].asset, handle);
        if (status.ok()) status = renderer_->addInstance(handle, scene[i].placement, instances[i]);
    }
    uint64_t ticket = 0;
    for (bool drawn = false; status.ok() && !drawn;) {
        status = renderer_->beginFrame();
        if (!status.ok()) break;
        drawn = true;
        for (size_t i = 0; i < scene.size(); ++i) drawn &= renderer_->setLevels(instances[i], scene[i].levels).ok();
        renderer_->endFrame();
        drawn &= renderer_->stats().deferredInstances == 0;
        status = drawFrame(camera, ticket);
    }
    if (status.ok()) {
        const VkExtent2D size = target_.desc().size;
        out.width = size.width;
        out.height = size.height;
        out.pixels.resize(size_t(size.width) * size.height);
        status = target_.read(ticket, std::as_writable_bytes(std::span(out.pixels)));
    }
    for (const vulkan::InstanceHandle& instance : instances) {
        const Status removed = renderer_->removeInstance(instance);
        if (status.ok()) status = removed;
    }
    for (const auto& [asset, handle] : handles) {
        const Status removed = renderer_->removeAsset(handle);
        if (status.ok()) status = removed;
    }
    return status;
}

} // namespace xgc::bench
