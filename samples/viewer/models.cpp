#include "models.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::viewer {
namespace {

constexpr float kSpacing = 2.05f; ///< between centres, radii

float radiusOf(const AssetView& asset) {
    return asset.record->sphereRadius > 0 ? asset.record->sphereRadius : 1;
}

} // namespace

bool Model::steered(uint32_t part) const {
    const PartControl& c = controls[part];
    return c.hidden || c.bias != 0 || c.importance != 1 || c.finest != 0 || c.coarsest < format::kMaxLevels;
}

std::string Model::partName(uint32_t part) const {
    const std::string_view name = file.view.text(file.view.parts[part].name);
    return name.empty() ? fmt::format("part {}", part) : std::string(name);
}

void Model::partSphere(uint32_t part, glm::vec3& c, float& radius) const {
    const format::PartRecord& record = file.view.parts[part];
    glm::vec3 low(1e30f), high(-1e30f);
    for (uint32_t i = record.firstPatch; i < record.firstPatch + record.patchCount; ++i) {
        const format::PatchRecord& patch = file.view.patches[i];
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], patch.boxMin[axis]);
            high[axis] = std::max(high[axis], patch.boxMax[axis]);
        }
    }
    if (record.patchCount == 0) low = high = glm::vec3(0);
    c = glm::vec3(toWorld * glm::vec4(0.5f * (low + high), 1));
    radius = 0.5f * glm::length(high - low) / radiusOf(file.view);
}

void Models::add(LoadedFile file) {
    auto model = std::make_unique<Model>();
    model->file = std::move(file);
    model->controls.resize(model->file.view.parts.size());
    models_.push_back(std::move(model));
    arrange();
}

void Models::remove(uint32_t model) {
    models_.erase(models_.begin() + model);
    arrange();
}

void Models::arrange() {
    for (size_t i = 0; i < models_.size(); ++i) {
        Model& model = *models_[i];
        const float* c = model.file.view.record->sphereCenter;
        model.center = {kSpacing * (float(i) - 0.5f * float(models_.size() - 1)), 0, 0};
        const glm::mat4 unit = glm::scale(glm::mat4(1), glm::vec3(1 / radiusOf(model.file.view)));
        model.toWorld = glm::translate(glm::mat4(1), model.center) * glm::translate(unit, -glm::vec3(c[0], c[1], c[2]));
    }
}

std::vector<glm::vec3> Models::corners() const {
    std::vector<glm::vec3> out;
    for (const auto& model : models_) {
        const format::AssetRecord& record = *model->file.view.record;
        for (int corner = 0; corner < 8; ++corner) {
            glm::vec4 p(0, 0, 0, 1);
            for (int axis = 0; axis < 3; ++axis)
                p[axis] = (corner >> axis & 1) ? record.boundsMax[axis] : record.boundsMin[axis];
            out.emplace_back(model->toWorld * p);
        }
    }
    if (out.empty()) out = {glm::vec3(-1), glm::vec3(1)};
    return out;
}

vulkan::RendererConfig Models::rendererConfig() const {
    std::vector<const AssetView*> views;
    uint32_t parts = 0;
    for (const auto& model : models_) {
        views.push_back(&model->file.view);
        parts += uint32_t(model->controls.size());
    }
    vulkan::RendererConfig base;
    base.viewCapacity = 2;
    base.steeredPartCapacity = std::max(base.steeredPartCapacity, parts);
    base.vertexArenaBytes = 1u << 20; // configFor grows these
    base.morphGroupCapacity = 1;
    vulkan::RendererConfig config = vulkan::configFor(views, 1, base);
    config.morphGroupCapacity = std::max(1u, config.morphGroupCapacity);
    config.indexBytes = uint32_t(std::min<uint64_t>(2ull * config.indexBytes, 1u << 31)); // two views
    return config;
}

Status Models::addTo(vulkan::Renderer& renderer) {
    for (const auto& model : models_) {
        Status status = renderer.addAsset(model->file.view, model->asset);
        if (status.ok()) status = renderer.addInstance(model->asset, makePlacement(model->toWorld), model->instance);
        if (!status.ok()) return status;
    }
    applyAll(renderer, false);
    return {};
}

bool Models::resident(const vulkan::Renderer& renderer) const {
    return std::all_of(models_.begin(), models_.end(), [&](const auto& m) { return renderer.resident(m->asset); });
}

void Models::applyControl(vulkan::Renderer& renderer, uint32_t model, uint32_t part) const {
    const Model& m = *models_[model];
    const Status status = renderer.setPart(m.instance, part, m.controls[part]);
    static_cast<void>(status); // the capacity holds all parts
}

void Models::applyAll(vulkan::Renderer& renderer, bool hiddenOnly) const {
    for (const auto& model : models_) {
        for (uint32_t part = 0; part < model->controls.size(); ++part) {
            if (!model->steered(part)) continue;
            PartControl control = model->controls[part];
            if (hiddenOnly) control = {.hidden = control.hidden};
            const Status status = renderer.setPart(model->instance, part, control);
            static_cast<void>(status); // as above
        }
    }
}

DrawnModels Models::drawn(const vulkan::Renderer& renderer, uint32_t view) const {
    const DrawList& list = renderer.drawList(view);
    const Selection& selection = renderer.selection(view);
    DrawnModels out;
    out.levels.resize(models_.size());
    out.visible.resize(models_.size());
    for (size_t i = 0; i < models_.size(); ++i) {
        const Model& model = *models_[i];
        const uint32_t id = model.instance.index, patches = model.file.view.patchCount();
        std::vector<uint8_t>&levels = out.levels[i], &visible = out.visible[i];
        levels.assign(patches, 0);
        visible.assign(patches, list.kind(id) != InstanceKind::culled);
        if (list.kind(id) == InstanceKind::whole) {
            renderer.scene().wholeLevels(renderer.scene().assetOf(id), list.wholeState(id), levels);
        } else if (list.kind(id) == InstanceKind::mixed) {
            levels.assign(list.levels(id).begin(), list.levels(id).end());
            if (selection.kind(id) == InstanceKind::mixed)
                visible.assign(selection.visible(id).begin(), selection.visible(id).end());
        }
        out.assets.push_back({&model.file.view, glm::mat4x3(model.toWorld), levels, visible});
    }
    return out;
}

} // namespace xgc::viewer
