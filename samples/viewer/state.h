#pragma once

#include "camera_controls.h"
#include "history.h"

#include <xgc/vulkan/renderer.h>

#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace xgc::viewer {

/// A rectangle of the picture, in pixels.
struct Area {
    float x = 0, y = 0, width = 1, height = 1;

    float aspect() const { return width / height; }
    bool contains(float px, float py) const { return px >= x && py >= y && px < x + width && py < y + height; }
};

struct PartName {
    uint32_t model = 0;
    uint32_t part = 0;
};

/// What the last frame drew, and what it took.
struct Measured {
    uint64_t triangles = 0;        ///< of the selection
    uint64_t uniformTriangles = 0; ///< of the other side of a split view
    float uniformError = 0;        ///< that all of it stays within, in radii of the models
    float pixels = 0;              ///< error that the levels hold
    bool overBudget = false;
    float worstPixels = 0, uniformWorstPixels = 0; ///< of what is visible, in a split view
    uint32_t draws = 0;
    History<240> trianglesHistory, uploadHistory, changesHistory, frameHistory, selectHistory;
};

/// Everything that the panel and the keys change. Plain data: the panel edits it, the program acts on it.
struct ViewerState {
    // What to draw.
    vulkan::ShadingMode mode = vulkan::ShadingMode::shaded;
    float pixels = 1;
    bool useBudget = false;
    int budget = 20000;
    bool morph = false;

    CameraControls camera;
    bool zUp = false;
    /// The camera that levels are selected for, and the height of its picture, while the selection is frozen.
    std::optional<vulkan::Camera> frozen;
    float frozenHeight = 1;

    bool split = false;
    float splitAt = 0.5f; ///< of the area's width

    std::optional<PartName> selected;
    bool showPickedRow = false; ///< bring it into the list's sight
    bool showPanel = true;
    bool showGraphs = true;
    bool showHelp = false;
    std::string partFilter;

    // Asked for by the panel, done by the program between frames.
    std::optional<glm::vec2> askPick; ///< a pixel of the picture
    bool askFrameAll = false;
    bool askFocus = false;
    bool askFreeze = false; ///< or thaw
    bool askCancelLoad = false;
    bool askScreenshot = false;
    bool askQuit = false;
    bool askPin = false;                    ///< the picked part at its present level, or not
    bool askHide = false, askReset = false; ///< the picked part
    bool askResetAll = false;
    bool askShowAll = false;
    std::optional<std::string> askOpen;
    std::optional<uint32_t> askClose; ///< a model

    std::vector<PartName> changedParts; ///< whose control the renderer is to be told

    std::string notice;              ///< of what was done, for a while
    float noticeSeconds = 0;         ///< that it is still shown
    std::vector<std::string> errors; ///< shown one after the other until they are dismissed
    Measured measured;
    std::string device;
    float uiScale = 1;
};

} // namespace xgc::viewer
