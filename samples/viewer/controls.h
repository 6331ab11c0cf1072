#pragma once

#include "events.h"
#include "state.h"

#include <array>

namespace xgc::viewer {

/// What mouse and keys do to the state: drags move the camera or the split line, clicks ask for a pick, keys are
/// listed in README.md. Knows no window and no renderer.
class Controls {
public:
    /// `overPanel`: the pointer is over a control; `typing`: a text field has the keys.
    void handle(const Event& event, ViewerState& state, const Area& area, bool overPanel, bool typing);
    /// Flies by the keys that are held.
    void advance(ViewerState& state, float seconds) const;

private:
    enum class Drag { none, orbit, pan, look, split };

    void press(int button, ViewerState& state, const Area& area);
    void release(int button, ViewerState& state);
    void move(float x, float y, ViewerState& state, const Area& area);
    void key(int code, ViewerState& state) const;
    bool held(int code) const { return held_[size_t(code)]; }
    bool shift() const { return held(kKeyLeftShift) || held(kKeyRightShift); }
    bool control() const { return held(kKeyLeftControl) || held(kKeyRightControl); }

    std::array<bool, kKeyCount> held_{};
    Drag drag_ = Drag::none;
    int button_ = 0; ///< of the drag
    float x_ = 0, y_ = 0;
    float travelled_ = 0; ///< since the button was pressed, pixels
};

} // namespace xgc::viewer
