#include "controls.h"

#include <algorithm>
#include <cmath>

namespace xgc::viewer {
namespace {

constexpr float kClick = 4;     ///< pixels that the pointer may move within a click
constexpr float kSplitGrab = 9; ///< pixels beside the line
constexpr float kLeastPixels = 1.0f / 16, kMostPixels = 64;

/// Half or twice as many, through 0 at the lower end.
float scaledPixels(float pixels, float factor) {
    if (pixels == 0) return factor > 1 ? kLeastPixels : 0;
    const float out = pixels * factor;
    return out < kLeastPixels ? 0 : std::min(out, kMostPixels);
}

} // namespace

void Controls::handle(const Event& event, ViewerState& state, const Area& area, bool overPanel, bool typing) {
    switch (event.kind) {
    case EventKind::move:
        move(event.x, event.y, state, area);
        break;
    case EventKind::button:
        if (event.down && !overPanel && area.contains(x_, y_)) press(event.code, state, area);
        if (!event.down) release(event.code, state);
        break;
    case EventKind::wheel:
        if (!overPanel && area.contains(x_, y_)) state.camera.zoom(event.y);
        break;
    case EventKind::key:
        if (event.code < 0 || event.code >= kKeyCount) break;
        held_[size_t(event.code)] = event.down && !typing;
        if (event.down && !typing) key(event.code, state);
        break;
    case EventKind::quit:
        state.askQuit = true;
        break;
    case EventKind::text:
    case EventKind::drop:
        break;
    }
}

void Controls::press(int button, ViewerState& state, const Area& area) {
    if (drag_ != Drag::none) return;
    button_ = button;
    travelled_ = 0;
    const float line = area.x + area.width * state.splitAt;
    if (button == 0 && state.split && std::abs(x_ - line) <= kSplitGrab) {
        drag_ = Drag::split;
    } else if (button == 1) {
        drag_ = Drag::look;
    } else {
        drag_ = button == 2 || shift() ? Drag::pan : Drag::orbit;
    }
}

void Controls::release(int button, ViewerState& state) {
    if (drag_ == Drag::none || button != button_) return;
    if (button == 0 && drag_ != Drag::split && travelled_ < kClick) state.askPick = glm::vec2(x_, y_);
    drag_ = Drag::none;
}

void Controls::move(float x, float y, ViewerState& state, const Area& area) {
    const float dx = x - x_, dy = y - y_;
    x_ = x;
    y_ = y;
    travelled_ += std::abs(dx) + std::abs(dy);
    if (drag_ == Drag::split) state.splitAt = std::clamp((x - area.x) / area.width, 0.02f, 0.98f);
    if (travelled_ < kClick) return; // a click may tremble
    if (drag_ == Drag::orbit) state.camera.orbit(dx, dy, area.height);
    if (drag_ == Drag::pan) state.camera.pan(dx, dy, area.height);
    if (drag_ == Drag::look) state.camera.look(dx, dy, area.height);
}

void Controls::key(int code, ViewerState& state) const {
    if (code >= '1' && code <= '5') state.mode = vulkan::ShadingMode(code - '1');
    switch (code) {
    case '[':
        state.pixels = scaledPixels(state.pixels, 0.5f);
        break;
    case ']':
        state.pixels = scaledPixels(state.pixels, 2);
        break;
    case 'B':
        state.useBudget = !state.useBudget;
        break;
    case 'M':
        state.morph = !state.morph;
        break;
    case 'X':
        state.askFreeze = true;
        break;
    case 'V':
        state.split = !state.split;
        break;
    case 'F':
        state.askFrameAll = true;
        break;
    case 'C':
        state.askFocus = true;
        break;
    case 'P':
        state.askPin = true;
        break;
    case 'H':
        state.askHide = true;
        break;
    case 'R':
        (shift() ? state.askResetAll : state.askReset) = true;
        break;
    case 'U':
        state.askShowAll = true;
        break;
    case 'Z':
        state.zUp = !state.zUp;
        state.camera.setUp(state.zUp ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0));
        break;
    case 'G':
        state.showGraphs = !state.showGraphs;
        break;
    case 'Q':
        state.askQuit |= control();
        break;
    case kKeyTab:
        state.showPanel = !state.showPanel;
        break;
    case kKeyF1:
    case kKeySlash: // where ? is
        state.showHelp = !state.showHelp;
        break;
    case kKeyF12:
        state.askScreenshot = true;
        break;
    case kKeyEscape:
        if (!state.showHelp) state.selected.reset();
        state.showHelp = false;
        break;
    default:
        break;
    }
}

void Controls::advance(ViewerState& state, float seconds) const {
    if (control()) return;
    const auto axis = [&](int more, int less) { return float(held(more)) - float(held(less)); };
    const glm::vec3 direction(axis('D', 'A'), axis('E', 'Q'), axis('W', 'S'));
    if (direction != glm::vec3(0)) state.camera.fly(shift() ? 3.0f * direction : direction, seconds);
}

} // namespace xgc::viewer
