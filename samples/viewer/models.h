#pragma once

#include "drawn_asset.h"
#include "loader.h"
#include "state.h"

#include <memory>

namespace xgc::viewer {

struct Model {
    LoadedFile file;
    glm::mat4 toWorld{1};
    glm::vec3 center{0};               ///< world; the radius is 1
    std::vector<PartControl> controls; ///< a part each
    vulkan::AssetHandle asset;
    vulkan::InstanceHandle instance;

    bool steered(uint32_t part) const;
    std::string partName(uint32_t part) const;
    /// Bounds of a part in the world, at level 0.
    void partSphere(uint32_t part, glm::vec3& center, float& radius) const;
};

/// Models as they are drawn; `assets` points into the rest.
struct DrawnModels {
    std::vector<DrawnAsset> assets;
    std::vector<std::vector<uint8_t>> levels, visible;
};

/// The open models, one beside the other, each at a radius of 1.
class Models {
public:
    std::vector<std::unique_ptr<Model>>& all() { return models_; }
    const std::vector<std::unique_ptr<Model>>& all() const { return models_; }
    void add(LoadedFile file);
    void remove(uint32_t model);

    /// Corners of the models' boxes in the world; of a box of its own where there is no model.
    std::vector<glm::vec3> corners() const;

    /// Capacities that hold them, two views and morphs.
    vulkan::RendererConfig rendererConfig() const;
    /// Hands assets, instances and controls to a new renderer, which they must outlive.
    Status addTo(vulkan::Renderer& renderer);
    bool resident(const vulkan::Renderer& renderer) const;
    /// Tells the renderer how a part is steered.
    void applyControl(vulkan::Renderer& renderer, uint32_t model, uint32_t part) const;
    /// Parts alike at all levels but for those that are hidden, or as they are steered.
    void applyAll(vulkan::Renderer& renderer, bool hiddenOnly) const;

    /// What the renderer drew of each model in a view at the latest frame.
    DrawnModels drawn(const vulkan::Renderer& renderer, uint32_t view) const;

private:
    void arrange();

    std::vector<std::unique_ptr<Model>> models_; ///< renderers point into them
};

} // namespace xgc::viewer
