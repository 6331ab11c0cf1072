#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/vulkan/renderer.h>

#include <memory>
#include <vector>

namespace xgc::headless {

/// An .xgc file in memory, opened in place.
struct LoadedAsset {
    bake::AlignedBytes bytes;
    AssetView view;
};

/// An asset at a place.
struct SceneInstance {
    const AssetView* asset = nullptr;
    Placement placement;
    vulkan::InstanceHandle handle;
};

/// Baked assets, each standing several times on a grid in the plane y = 0.
class AssetGrid {
public:
    bake::Status load(const std::vector<std::filesystem::path>& files, uint32_t instancesOfEach);

    /// Capacities that hold it all.
    vulkan::RendererConfig rendererConfig(bool morph) const;
    /// Hands assets and instances to the renderer, which the scene must outlive.
    Status addTo(vulkan::Renderer& renderer);

    std::vector<SceneInstance>& instances() { return instances_; }
    const std::vector<SceneInstance>& instances() const { return instances_; }
    const std::vector<std::unique_ptr<LoadedAsset>>& assets() const { return assets_; }
    /// A sphere around everything.
    glm::vec3 center() const { return center_; }
    float radius() const { return radius_; }

private:
    std::vector<std::unique_ptr<LoadedAsset>> assets_;
    std::vector<SceneInstance> instances_;
    uint32_t instancesOfEach_ = 1;
    glm::vec3 center_{0};
    float radius_ = 1;
};

} // namespace xgc::headless
