#include "app.h"

#include "app_units.h"
#include "picking.h"
#include "report.h"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <sstream>

namespace xgc::viewer {
namespace {

constexpr float kFixedSeconds = 1.0f / 60;
constexpr float kNoticeSeconds = 3;
constexpr auto kDoubleClick = std::chrono::milliseconds(350);

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
    if (status.ok()) status = uniformLevels_.create(renderer_.scene().config());
    hasRenderer_ = status.ok();
    drawn_ = uniform_ = {};
    uniformError_ = {};
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
            if (fixedClock() && frames_ == 0) return result->status; // nobody is there to read a dialog
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
    state_.showPickedRow = true;
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

/// The models' names, once they are all there.
void App::updateTitle() {
    std::string title = loader_.busy() ? "loading - " : "";
    for (const auto& model : models_.all()) title += model->file.name + " - ";
    title += "xgc-viewer";
    if (title == title_) return;
    title_ = title;
    window_.setTitle(title_.c_str());
}

/// Of the last frame, under a name that is free.
void App::writePicture() {
    std::string file;
    for (uint32_t i = 1; file.empty() || std::filesystem::exists(file); ++i)
        file = fmt::format("xgc-viewer-{:03}.png", i);
    const bake::Status status = bake::writePng(presenter_.canvas().picture(), file);
    if (!status.ok()) {
        state_.errors.push_back(status.message);
        return;
    }
    state_.notice = "wrote " + file;
    state_.noticeSeconds = kNoticeSeconds;
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
    state_.noticeSeconds -= seconds;
    controls_.advance(state_, seconds);
    act();
    updateTitle();
    const bool last = state_.askQuit || (fixedClock() && frames_ >= options_.frames);
    running = !last;
    if (!visible) return {};
    buildInterface(seconds);
    const bool capture = state_.askScreenshot || (last && !options_.screenshot.empty());
    status = drawFrame(capture);
    if (status.ok() && state_.askScreenshot) writePicture();
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

} // namespace xgc::viewer
