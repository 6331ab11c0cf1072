#pragma once

#include "controls.h"
#include "models.h"
#include "options.h"
#include "presenter.h"
#include "script.h"
#include "uniform_error.h"
#include "view_request.h"

#include <chrono>
#include <deque>

namespace xgc::viewer {

/// The program: events in, frames out.
class App {
public:
    explicit App(const Options& options) : options_(options) {}
    ~App();

    /// Until it is closed, or for as many frames as the options say.
    bake::Status run();

private:
    using Clock = std::chrono::steady_clock;

    bake::Status start();
    bake::Status step(bool& running);

    // Between frames.
    void takeEvents(bool waiting);
    void dispatch();
    bake::Status takeLoaded();
    bake::Status rebuildRenderer();
    void act();
    void actOnParts();
    void pickAt(const glm::vec2& pixel);
    void freeze();
    void updateTitle();
    void writePicture();
    bake::Status finish();

    // A frame.
    Area area() const;
    void buildInterface(float seconds);
    bake::Status drawFrame(bool capture);
    void chooseLevels();
    void chooseUniformLevels();
    bake::Status recordScene(VkCommandBuffer cmd);
    void measure();
    void measureSplit();
    bool settled() const;
    bool fixedClock() const { return options_.frames > 0; }

    Options options_;
    ViewerState state_;
    Models models_;
    Loader loader_;
    Controls controls_;
    std::vector<ScriptedEvent> script_;
    size_t scripted_ = 0; ///< events of it that have happened
    std::deque<Event> events_;
    Window window_;
    Presenter presenter_;
    vulkan::Renderer renderer_;
    bool hasRenderer_ = false;
    DrawnModels drawn_, uniform_; ///< of the latest frame
    UniformError uniformError_;   ///< of these models, or of none
    Selection uniformLevels_;     ///< holds its levels for the renderer
    uint32_t frames_ = 0;         ///< counted from when all files are there
    uint32_t sinceRebuild_ = 0;   ///< frames
    std::string title_;
    Clock::time_point lastPick_{};
    Clock::time_point lastFrame_{};
    float selectMs_ = 0, frameMs_ = 0;
};

} // namespace xgc::viewer
