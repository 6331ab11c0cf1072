#include "view_request.h"

#include <algorithm>
#include <array>
#include <limits>

namespace xgc::viewer {
namespace {

/// A patch keeps its level while its distance changes by less than this part.
constexpr float kHysteresis = 0.05f;

} // namespace

SelectedFor selectedFor(const ViewerState& state, const Area& area) {
    if (state.frozen) return {*state.frozen, state.frozenHeight};
    return {state.camera.camera(area.aspect()), area.height};
}

SelectionDesc selectionFor(const ViewerState& state, const SelectedFor& view) {
    SelectionDesc desc;
    desc.view = makeView(view.camera.eye, view.camera.fovY, view.height);
    desc.view.nearest = view.camera.nearPlane;
    desc.frustum = makeFrustum(view.camera.worldToClip());
    desc.pixels = state.pixels;
    desc.morph = state.morph;
    if (!desc.morph) {
        desc.hysteresis = kHysteresis;
        desc.triangleBudget = state.useBudget ? uint32_t(std::max(state.budget, 1)) : 0;
    }
    // One draw of a whole model has one colour, and no part that stands out.
    desc.wholeBeyond = std::numeric_limits<float>::infinity();
    return desc;
}

SelectionDesc selectionFor(const SelectedFor& view, const Selection* levels) {
    static constexpr std::array<float, format::kMaxLevels> kCoarsest{}; // each is at or below every distance
    SelectionDesc desc;
    desc.view = makeView(view.camera.eye, view.camera.fovY, view.height);
    desc.frustum = makeFrustum(view.camera.worldToClip());
    desc.policy = Policy::distanceBands;
    desc.bands = kCoarsest;
    desc.reference = levels; // which allows nothing coarser
    desc.wholeBeyond = std::numeric_limits<float>::infinity();
    return desc;
}

vulkan::ViewDesc viewFor(const ViewerState& state, const Area& area, const SelectedFor& view) {
    vulkan::ViewDesc desc;
    desc.camera = state.camera.camera(area.aspect());
    desc.sky = desc.camera.up;
    desc.mode = state.mode;
    desc.linePixels = 1.1f * state.uiScale;
    desc.measured = makeView(view.camera.eye, view.camera.fovY, view.height);
    desc.errorPixels = std::max(state.pixels, state.useBudget && !state.morph ? state.measured.pixels : 0.0f);
    return desc;
}

} // namespace xgc::viewer
