#include "app.h"

#include "overlay.h"
#include "panel.h"
#include "picking.h"
#include "report.h"
#include "uniform_level.h"

#include <fmt/format.h>
#include <imgui.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace xgc::viewer {
namespace {

constexpr float kFixedSeconds = 1.0f / 60;
constexpr float kPanelWidth = 316;
constexpr auto kDoubleClick = std::chrono::milliseconds(350);

bake::Status fromRuntime(const Status& status) {
    if (status.ok()) return {};
    return bake::systemError(fmt::format("{} ({})", status.message, int64_t(status.element)));
}

float milliseconds(std::chrono::steady_clock::duration d) {
    return std::chrono::duration<float, std::milli>(d).count();
}

} // namespace

App::~App() {
    presenter_.device().waitIdle();
}

// Set-up ------------------------------------------------------------------------------------------------------------

bake::Status App::start() {
    if (!options_.script.empty()) {
        std::ifstream in(options_.script);
        std::stringstream text;
        text << in.rdbuf();
        const bake::Status status = parseScript(text.str(), options_.script.string(), script_);
        if (!status.ok()) return status;
    }
    bake::Status status = window_.create(options_.width, options_.height);
    if (status.ok()) status = presenter_.create(window_);
    if (!status.ok()) return status;
    state_.device = presenter_.device().name();
    state_.uiScale = window_.contentScale();
    state_.mode = options_.mode;
    state_.pixels = options_.pixels;
    state_.useBudget = options_.budget > 0;
    if (options_.budget > 0) state_.budget = int(options_.budget);
    state_.morph = options_.morph;
    state_.split = options_.split;
    state_.showPanel = options_.panel;
    for (const std::filesystem::path& file : options_.files) loader_.request(file);
    state_.askFrameAll = true;
    return rebuildRenderer();
}

bake::Status App::run() {
    bake::Status status = start();
    bool running = true;
    lastFrame_ = Clock::now();
    while (status.ok() && running) status = step(running);
    return status.ok() ? finish() : status;
}

bake::Status App::rebuildRenderer() {
    presenter_.device().waitIdle();
    vulkan::RendererConfig config = models_.rendererConfig();
    config.framesInFlight = Presenter::kFramesInFlight;
    config.colorFormat = Canvas::kSceneFormat;
    config.depthFormat = Canvas::kDepthFormat;
    config.samples = Canvas::kSamples;
    renderer_ = {};
    hasRenderer_ = false;
    Status status = renderer_.create(presenter_.device().context(), config);
    if (status.ok()) status = models_.addTo(renderer_);
    hasRenderer_ = status.ok();
    drawn_ = uniform_ = {};
    sinceRebuild_ = 0;
    return fromRuntime(status);
}

// Between frames ----------------------------------------------------------------------------------------------------

bool App::settled() const {
    return !loader_.busy() && models_.resident(renderer_) && sinceRebuild_ > 2 && renderer_.stats().uploadBytes == 0;
}

/// From the script or the devices to the queue.
void App::takeEvents(bool waiting) {
    for (Event& event : window_.poll(waiting)) {
        const bool always = event.kind == EventKind::quit;
        if (always || (script_.empty() && !fixedClock())) events_.push_back(std::move(event));
    }
    while (scripted_ < script_.size() && script_[scripted_].frame <= frames_) {
        events_.push_back(script_[scripted_++].event);
    }
}

/// At most one button or key a frame, and a button only where the pointer rests, so that the panel sees each of them.
void App::dispatch() {
    bool moved = false;
    while (!events_.empty()) {
        const Event event = events_.front();
        const bool press = event.kind == EventKind::button || event.kind == EventKind::key;
        if (event.kind == EventKind::button && moved) return;
        events_.pop_front();
        moved |= event.kind == EventKind::move;
        Interface& interface = presenter_.interface();
        const bool modal = !state_.errors.empty();
        controls_.handle(event, state_, area(), modal || interface.wantsMouse(), modal || interface.wantsKeys());
        interface.feed(event);
        for (const std::filesystem::path& file : event.files) loader_.request(file);
        if (press) return;
    }
}

bake::Status App::takeLoaded() {
    bool changed = false;
    while (std::optional<Loader::Result> result = loader_.take()) {
        if (!result->status.ok()) {
            if (fixedClock()) return result->status; // nobody is there to read a dialog
            state_.errors.push_back(result->status.message);
            continue;
        }
        models_.add(std::move(result->file));
        changed = true;
    }
    if (!changed) return {};
    state_.askFrameAll = true;
    state_.frozen.reset();
    return rebuildRenderer();
}

void App::freeze() {
    if (state_.frozen) {
        state_.frozen.reset();
        return;
    }
    const Area view = area();
    state_.frozen = state_.camera.camera(view.aspect());
    state_.frozenHeight = view.height;
}

void App::pickAt(const glm::vec2& pixel) {
    const Area view = area();
    const glm::vec2 place((pixel.x - view.x) / view.width, (pixel.y - view.y) / view.height);
    const bool right = state_.split && place.x > state_.splitAt;
    const DrawnModels& seen = right ? uniform_ : drawn_;
    const std::optional<Hit> hit = pick(seen.assets, rayThrough(state_.camera.camera(view.aspect()), place));
    state_.selected.reset();
    if (!hit) return;
    state_.selected = PartName{hit->asset, hit->part};
    const Clock::time_point now = Clock::now();
    state_.askFocus |= now - lastPick_ < kDoubleClick && !fixedClock();
    lastPick_ = now;
}

void App::actOnParts() {
    auto& all = models_.all();
    if (state_.selected) {
        const PartName name = *state_.selected;
        Model& model = *all[name.model];
        PartControl& control = model.controls[name.part];
        const bool asked = state_.askPin || state_.askHide || state_.askReset;
        if (state_.askPin && control.finest == control.coarsest) {
            control.finest = 0;
            control.coarsest = format::kMaxLevels;
        } else if (state_.askPin && name.model < drawn_.levels.size()) {
            const uint32_t patch = model.file.view.parts[name.part].firstPatch;
            control.finest = control.coarsest = drawn_.levels[name.model][patch];
        }
        if (state_.askHide) control.hidden = !control.hidden;
        if (state_.askReset) control = {};
        if (asked) state_.changedParts.push_back(name);
    }
    if (state_.askResetAll || state_.askShowAll) {
        for (uint32_t m = 0; m < all.size(); ++m) {
            for (uint32_t part = 0; part < all[m]->controls.size(); ++part) {
                if (!all[m]->steered(part)) continue;
                if (state_.askResetAll) all[m]->controls[part] = {};
                all[m]->controls[part].hidden = false;
                state_.changedParts.push_back({m, part});
            }
        }
    }
    for (const PartName& name : state_.changedParts) models_.applyControl(renderer_, name.model, name.part);
    state_.changedParts.clear();
    state_.askPin = state_.askHide = state_.askReset = state_.askResetAll = state_.askShowAll = false;
}

/// What keys and panel asked for.
void App::act() {
    if (state_.askPick) pickAt(*state_.askPick);
    actOnParts();
    if (state_.askFreeze) freeze();
    if (state_.askFocus && state_.selected) {
        glm::vec3 center;
        float radius = 1;
        models_.all()[state_.selected->model]->partSphere(state_.selected->part, center, radius);
        state_.camera.focus(center, 1.6f * radius, area().aspect());
    }
    if (state_.askFrameAll) state_.camera.frame(models_.corners(), area().aspect());
    if (state_.askCancelLoad) loader_.cancel();
    if (state_.askOpen) loader_.request(*state_.askOpen);
    state_.askPick.reset();
    state_.askOpen.reset();
    state_.askFreeze = state_.askFocus = state_.askFrameAll = state_.askCancelLoad = false;
}

bake::Status App::step(bool& running) {
    bake::Status status;
    const bool visible = presenter_.fit(status);
    if (!status.ok()) return status;
    if (settled()) ++frames_;
    takeEvents(!visible);
    dispatch();
    status = takeLoaded();
    if (!status.ok()) return status;
    if (state_.askClose) {
        models_.remove(*state_.askClose);
        state_.selected.reset();
        state_.askClose.reset();
        state_.askFrameAll = true;
        status = rebuildRenderer();
        if (!status.ok()) return status;
    }
    const Clock::time_point now = Clock::now();
    const float seconds = fixedClock() ? kFixedSeconds : milliseconds(now - lastFrame_) / 1000;
    frameMs_ = fixedClock() ? 1000 * kFixedSeconds : milliseconds(now - lastFrame_);
    lastFrame_ = now;
    controls_.advance(state_, seconds);
    act();
    const bool last = state_.askQuit || (fixedClock() && frames_ >= options_.frames);
    running = !last;
    if (!visible) return {};
    buildInterface(seconds);
    const bool capture = state_.askScreenshot || (last && !options_.screenshot.empty());
    status = drawFrame(capture);
    if (status.ok() && state_.askScreenshot) {
        status = bake::writePng(presenter_.canvas().picture(), fmt::format("xgc-viewer-{:03}.png", ++pictures_));
        if (!status.ok()) state_.errors.push_back(status.message);
        status = {};
    }
    state_.askScreenshot = false;
    return status;
}

bake::Status App::finish() {
    bake::Status status;
    if (!options_.screenshot.empty()) status = bake::writePng(presenter_.canvas().picture(), options_.screenshot);
    if (status.ok() && !options_.report.empty()) {
        const std::string text = reportJson(state_, models_, area(), frames_) + "\n";
        status = bake::writeFileAtomically(options_.report, std::as_bytes(std::span(text)));
    }
    return status;
}

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
    buildOverlay(state_, models_.all().empty() && !progress.busy, view);
    buildDialogs(state_, progress, view);
    presenter_.interface().end();
}

void App::chooseLevels() {
    const Clock::time_point before = Clock::now();
    const SelectedFor view = selectedFor(state_, area());
    renderer_.select(0, selectionFor(state_, view));
    selectMs_ = milliseconds(Clock::now() - before);
    if (!state_.split) return;
    // The other side is one level for all: parts are steered there no more than that they are hidden.
    models_.applyAll(renderer_, true);
    renderer_.select(1, uniformSelectionFor(view, state_.measured.uniformLevel, bands_));
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
    if (!state_.split) return;
    uniform_ = models_.drawn(renderer_, 1);
    const SelectedFor view = selectedFor(state_, area());
    View seen = makeView(view.camera.eye, view.camera.fovY, view.height);
    seen.nearest = view.camera.nearPlane;
    m.worstPixels = worstErrorPixels(drawn_.assets, seen);
    m.uniformWorstPixels = worstErrorPixels(uniform_.assets, seen);
    m.uniformTriangles = renderer_.drawList(1).stats().triangles;
    m.uniformLevel = uniformLevelWithin(drawn_.assets, m.triangles).level;
}

} // namespace xgc::viewer
