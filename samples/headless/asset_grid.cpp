#include "asset_grid.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::headless {
namespace {

bake::Status loadAsset(const std::filesystem::path& file, LoadedAsset& asset) {
    const bake::Status status = bake::readImage(file, asset.bytes);
    if (!status.ok()) return status;
    const Status opened = openAll(asset.bytes.span(), asset.view);
    if (opened.ok()) return {};
    return bake::badInput(fmt::format("{}: {} (element {})", file.string(), opened.message, opened.element));
}

/// All assets at one size: the bounding sphere's radius becomes 1, its centre the origin.
glm::mat4 normalized(const AssetView& asset) {
    const float* c = asset.record->sphereCenter;
    const float radius = asset.record->sphereRadius > 0 ? asset.record->sphereRadius : 1;
    const glm::mat4 scaled = glm::scale(glm::mat4(1), glm::vec3(1 / radius));
    return glm::translate(scaled, -glm::vec3(c[0], c[1], c[2]));
}

} // namespace

bake::Status AssetGrid::load(const std::vector<std::filesystem::path>& files, uint32_t instancesOfEach) {
    constexpr float kSpacing = 1.9f;
    instancesOfEach_ = instancesOfEach;
    const uint32_t count = uint32_t(files.size()) * instancesOfEach;
    const auto columns = uint32_t(std::ceil(std::sqrt(float(count))));
    const uint32_t rows = (count + columns - 1) / columns;
    for (const std::filesystem::path& file : files) {
        assets_.push_back(std::make_unique<LoadedAsset>());
        const bake::Status status = loadAsset(file, *assets_.back());
        if (!status.ok()) return status;
    }
    for (uint32_t i = 0; i < count; ++i) {
        SceneInstance instance;
        instance.asset = &assets_[i % assets_.size()]->view;
        const glm::vec3 place(kSpacing * (float(i % columns) - 0.5f * float(columns - 1)), 0,
                              kSpacing * (float(i / columns) - 0.5f * float(rows - 1)));
        instance.placement = makePlacement(glm::translate(glm::mat4(1), place) * normalized(*instance.asset));
        instances_.push_back(std::move(instance));
    }
    radius_ = 1 + 0.5f * kSpacing * std::hypot(float(columns - 1), float(rows - 1));
    return {};
}

vulkan::RendererConfig AssetGrid::rendererConfig(bool morph) const {
    std::vector<const AssetView*> views;
    for (const auto& asset : assets_) views.push_back(&asset->view);
    vulkan::RendererConfig base;
    base.morphGroupCapacity = morph ? 1 : 0; // configFor grows it
    return vulkan::configFor(views, instancesOfEach_, base);
}

Status AssetGrid::addTo(vulkan::Renderer& renderer) {
    std::vector<vulkan::AssetHandle> handles(assets_.size());
    for (size_t i = 0; i < assets_.size(); ++i) {
        const Status status = renderer.addAsset(assets_[i]->view, handles[i]);
        if (!status.ok()) return status;
    }
    for (size_t i = 0; i < instances_.size(); ++i) {
        SceneInstance& instance = instances_[i];
        const Status status = renderer.addInstance(handles[i % handles.size()], instance.placement, instance.handle);
        if (!status.ok()) return status;
    }
    return {};
}

} // namespace xgc::headless
