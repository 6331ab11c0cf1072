#pragma once

#include <filesystem>
#include <vector>

namespace xgc::viewer {

/// Keys by GLFW's numbers: letters and digits are their upper-case ASCII.
enum Key : int {
    kKeySpace = 32,
    kKeySlash = 47,
    kKeyEscape = 256,
    kKeyEnter = 257,
    kKeyTab = 258,
    kKeyBackspace = 259,
    kKeyDelete = 261,
    kKeyRight = 262,
    kKeyLeft = 263,
    kKeyDown = 264,
    kKeyUp = 265,
    kKeyHome = 268,
    kKeyEnd = 269,
    kKeyF1 = 290,
    kKeyF12 = 301,
    kKeyLeftShift = 340,
    kKeyLeftControl = 341,
    kKeyLeftAlt = 342,
    kKeyRightShift = 344,
    kKeyRightControl = 345,
    kKeyCount = 512
};

enum class EventKind { move, button, wheel, key, text, drop, quit };

/// What the window and scripts alike hand to the program.
struct Event {
    EventKind kind = EventKind::move;
    float x = 0, y = 0; ///< of move: pixels of the picture from its upper left corner; of wheel: steps
    int code = 0;       ///< of button: 0 left, 1 right, 2 middle; of key: a Key; of text: a code point
    bool down = false;  ///< of button and key
    std::vector<std::filesystem::path> files; ///< of drop
};

} // namespace xgc::viewer
