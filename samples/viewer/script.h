#pragma once

#include "events.h"

#include <xgc/bake/status.h>

#include <string>

namespace xgc::viewer {

/// An event, and the frame before which it happens. Frames count from 1, from when all files are there.
struct ScriptedEvent {
    uint32_t frame = 1;
    Event event;
};

/// Reads a script of input, an event a line; # begins a comment:
///
///     FRAME move X Y          FRAME down left|right|middle     FRAME up left|right|middle
///     FRAME click X Y         FRAME key NAME                   FRAME hold NAME, FRAME release NAME
///     FRAME wheel STEPS       FRAME drop FILE                  FRAME quit
///
/// A click moves, presses and releases, a key is pressed and released, each a frame apart. NAME: a letter, a digit, or
/// escape, tab, space, enter, delete, shift, control, f1 or f12. Frames must not fall.
bake::Status parseScript(const std::string& text, const std::string& name, std::vector<ScriptedEvent>& out);

} // namespace xgc::viewer
