#include "report.h"

#include <nlohmann/json.hpp>

namespace xgc::viewer {
namespace {

using Json = nlohmann::ordered_json;

Json vector(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

Json modelJson(const Model& model) {
    Json out;
    out["name"] = model.file.name;
    out["faces"] = model.file.view.record->faceCount;
    out["baked"] = model.file.baked;
    out["steered"] = Json::array();
    for (uint32_t part = 0; part < model.controls.size(); ++part) {
        if (!model.steered(part)) continue;
        const PartControl& c = model.controls[part];
        Json steered;
        steered["part"] = part;
        steered["name"] = model.partName(part);
        steered["hidden"] = c.hidden;
        steered["bias"] = c.bias;
        steered["importance"] = c.importance;
        if (c.finest == c.coarsest) steered["pinned"] = c.finest;
        out["steered"].push_back(steered);
    }
    return out;
}

} // namespace

std::string reportJson(const ViewerState& state, const Models& models, const Area& area, uint32_t frames) {
    constexpr const char* kModes[] = {"shaded", "parts", "levels", "wire", "error"};
    const vulkan::Camera camera = state.camera.camera(area.aspect());
    Json out;
    out["frames"] = frames;
    out["device"] = state.device;
    out["area"] = {area.x, area.y, area.width, area.height};
    out["eye"] = vector(camera.eye);
    out["target"] = vector(camera.target);
    out["fovY"] = camera.fovY;
    out["mode"] = kModes[uint32_t(state.mode)];
    out["pixels"] = state.pixels;
    out["budget"] = state.useBudget ? state.budget : 0;
    out["morph"] = state.morph;
    out["frozen"] = state.frozen.has_value();
    out["split"] = state.split;
    out["triangles"] = state.measured.triangles;
    if (state.split) {
        out["splitAt"] = state.splitAt;
        out["uniformError"] = state.measured.uniformError;
        out["uniformTriangles"] = state.measured.uniformTriangles;
    }
    out["models"] = Json::array();
    for (const auto& model : models.all()) out["models"].push_back(modelJson(*model));
    out["picked"] = nullptr;
    if (state.selected) {
        out["picked"] = {{"model", state.selected->model},
                         {"part", state.selected->part},
                         {"name", models.all()[state.selected->model]->partName(state.selected->part)}};
    }
    out["errors"] = state.errors;
    return out.dump();
}

} // namespace xgc::viewer
