#include "app.h"

#include "app_units.h"
#include "overlay.h"
#include "panel.h"

#include <algorithm>
#include <cmath>

// A frame of the program: what is asked of the renderer, the picture's two halves, and what is measured of it.

namespace xgc::viewer {
namespace {

constexpr float kPanelWidth = 316;

} // namespace

// A frame -----------------------------------------------------------------------------------------------------------

Area App::area() const {
    uint32_t width = 0, height = 0;
    window_.size(width, height);
    const float panel = state_.showPanel ? std::min(kPanelWidth * state_.uiScale, 0.6f * float(width)) : 0;
    return {std::floor(panel), 0, std::max(1.0f, float(width) - std::floor(panel)), std::max(1.0f, float(height))};
}

void App::buildInterface(float seconds) {
    const Area view = area();
    presenter_.interface().begin(presenter_.canvas().size(), seconds);
    const LoadProgress progress = loader_.progress();
    if (view.x > 0) buildPanel(state_, models_, drawn_, view.x, view.height);
    buildOverlay(state_, models_.all().empty(), view);
    buildDialogs(state_, progress, models_.all().empty(), view);
    presenter_.interface().end();
}

void App::chooseLevels() {
    const Clock::time_point before = Clock::now();
    const SelectedFor view = selectedFor(state_, area());
    renderer_.select(0, selectionFor(state_, view));
    selectMs_ = fixedClock() ? 0 : milliseconds(Clock::now() - before);
    if (state_.split) chooseUniformLevels();
}

/// The other side's: as many triangles as the last frame had. Parts are steered there no more than that they are
/// hidden.
void App::chooseUniformLevels() {
    for (uint32_t i = 0; i < uniformError_.modelCount(); ++i)
        uniformLevels_.set(renderer_.scene(), models_.all()[i]->instance.index, uniformError_.levels(i));
    models_.applyAll(renderer_, true);
    const bool known = uniformError_.modelCount() > 0;
    renderer_.select(1, selectionFor(selectedFor(state_, area()), known ? &uniformLevels_ : nullptr));
    models_.applyAll(renderer_, false);
}

bake::Status App::recordScene(VkCommandBuffer cmd) {
    const Area view = area();
    const VkViewport viewport{view.x, view.y, view.width, view.height, 0, 1};
    vkCmdSetViewport(cmd, 0, 1, &viewport);
    const auto scissor = [&](float from, float to) {
        const auto left = int32_t(view.x + from * view.width), right = int32_t(view.x + to * view.width);
        const VkRect2D rect{{left, 0}, {uint32_t(std::max(0, right - left)), presenter_.canvas().size().height}};
        vkCmdSetScissor(cmd, 0, 1, &rect);
    };
    const float splitAt = state_.split ? state_.splitAt : 1;
    scissor(0, 1);
    renderer_.recordBackground(cmd);
    vulkan::ViewDesc desc = viewFor(state_, view, selectedFor(state_, view));
    if (state_.selected) {
        desc.highlightInstance = models_.all()[state_.selected->model]->instance.index;
        desc.highlightPart = state_.selected->part;
    }
    scissor(0, splitAt);
    Status status = renderer_.recordDraws(cmd, desc);
    if (status.ok() && state_.split) {
        scissor(splitAt, 1);
        desc.view = 1;
        status = renderer_.recordDraws(cmd, desc);
    }
    return fromRuntime(status);
}

bake::Status App::drawFrame(bool capture) {
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    bake::Status status = presenter_.begin(cmd);
    if (status.ok()) status = fromRuntime(renderer_.beginFrame());
    if (!status.ok()) return status;
    chooseLevels();
    renderer_.endFrame();
    renderer_.recordTransfers(cmd);
    presenter_.canvas().beginScene(cmd);
    status = recordScene(cmd);
    presenter_.canvas().endScene(cmd);
    if (!status.ok()) return status;
    const VkSemaphoreSubmitInfo done = renderer_.frameDone();
    status = presenter_.end(std::span(&done, 1), capture);
    ++sinceRebuild_;
    measure();
    return status;
}

void App::measure() {
    Measured& m = state_.measured;
    drawn_ = models_.drawn(renderer_, 0);
    const vulkan::FrameStats& stats = renderer_.stats();
    const SelectionStats& chosen = renderer_.selection(0).stats();
    m.triangles = renderer_.drawList(0).stats().triangles;
    m.draws = uint32_t(renderer_.drawList(0).draws().size());
    m.pixels = chosen.pixels;
    m.overBudget = chosen.overBudget;
    m.trianglesHistory.add(float(m.triangles));
    m.uploadHistory.add(float(stats.uploadBytes));
    m.changesHistory.add(float(renderer_.drawList(0).stats().changedPatches));
    m.frameHistory.add(frameMs_);
    m.selectHistory.add(selectMs_);
    if (state_.split) measureSplit();
}

void App::measureSplit() {
    Measured& m = state_.measured;
    uniform_ = models_.drawn(renderer_, 1);
    const SelectedFor view = selectedFor(state_, area());
    View seen = makeView(view.camera.eye, view.camera.fovY, view.height);
    seen.nearest = view.camera.nearPlane;
    m.worstPixels = worstErrorPixels(drawn_.assets, seen);
    m.uniformWorstPixels = worstErrorPixels(uniform_.assets, seen);
    m.uniformTriangles = renderer_.drawList(1).stats().triangles;
    m.uniformError = uniformError_.error();
    if (uniformError_.modelCount() != drawn_.assets.size()) uniformError_.create(drawn_.assets);
    uniformError_.hold(drawn_.assets, m.triangles); // for the next frame
}

} // namespace xgc::viewer
