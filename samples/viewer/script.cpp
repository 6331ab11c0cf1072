#include "script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>

namespace xgc::viewer {
namespace {

constexpr int64_t kMostFrames = 1'000'000'000;

std::optional<int> keyNamed(const std::string& name) {
    if (name.size() == 1 && std::isalnum(static_cast<unsigned char>(name[0])))
        return std::toupper(static_cast<unsigned char>(name[0]));
    constexpr std::pair<const char*, int> kNames[] = {
        {"escape", kKeyEscape},       {"tab", kKeyTab},       {"space", kKeySpace},
        {"enter", kKeyEnter},         {"delete", kKeyDelete}, {"shift", kKeyLeftShift},
        {"control", kKeyLeftControl}, {"f1", kKeyF1},         {"f12", kKeyF12}};
    for (const auto& [word, key] : kNames) {
        if (name == word) return key;
    }
    return {};
}

std::optional<int> buttonNamed(const std::string& name) {
    if (name == "left") return 0;
    if (name == "right") return 1;
    if (name == "middle") return 2;
    return {};
}

Event pressed(EventKind kind, int code, bool down) {
    Event event;
    event.kind = kind;
    event.code = code;
    event.down = down;
    return event;
}

/// The events of one line behind its frame; false where it is none.
bool parseLine(const std::string& verb, std::istringstream& words, uint32_t frame, std::vector<ScriptedEvent>& out) {
    Event event;
    std::string name;
    if (verb == "move" || verb == "click") {
        if (!(words >> event.x >> event.y)) return false;
        out.push_back({frame, event});
        if (verb == "move") return true;
        out.push_back({frame + 1, pressed(EventKind::button, 0, true)});
        out.push_back({frame + 2, pressed(EventKind::button, 0, false)});
        return true;
    }
    if (verb == "down" || verb == "up") {
        if (!(words >> name)) return false;
        const std::optional<int> button = buttonNamed(name);
        if (button) out.push_back({frame, pressed(EventKind::button, *button, verb == "down")});
        return button.has_value();
    }
    if (verb == "key" || verb == "hold" || verb == "release") {
        if (!(words >> name)) return false;
        const std::optional<int> key = keyNamed(name);
        if (!key) return false;
        if (verb != "release") out.push_back({frame, pressed(EventKind::key, *key, true)});
        if (verb != "hold") out.push_back({verb == "key" ? frame + 1 : frame, pressed(EventKind::key, *key, false)});
        return true;
    }
    if (verb == "wheel") {
        event.kind = EventKind::wheel;
        if (!(words >> event.y)) return false;
    } else if (verb == "drop") {
        event.kind = EventKind::drop;
        if (!std::getline(words >> std::ws, name)) return false;
        event.files.push_back(name);
    } else if (verb == "quit") {
        event.kind = EventKind::quit;
    } else {
        return false;
    }
    out.push_back({frame, event});
    return true;
}

} // namespace

bake::Status parseScript(const std::string& text, const std::string& name, std::vector<ScriptedEvent>& out) {
    std::vector<ScriptedEvent> events;
    std::istringstream lines(text);
    std::string line;
    uint32_t last = 1;
    for (size_t number = 1; std::getline(lines, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        if ((words >> std::ws).eof()) continue;
        int64_t frame = 0;
        std::string verb;
        const bool read = bool(words >> frame >> verb) && frame > 0 && frame <= kMostFrames &&
                          parseLine(verb, words, uint32_t(frame), events);
        if (!read || !(words >> std::ws).eof()) {
            return bake::badInput(fmt::format(
                "{}:{}: '{}' is no event: expected a frame and move, click, down, up, key, hold, release, wheel, "
                "drop or quit with what they take",
                name, number, line));
        }
        if (frame < last) return bake::badInput(fmt::format("{}:{}: frame {} after {}", name, number, frame, last));
        last = uint32_t(frame);
    }
    std::stable_sort(events.begin(), events.end(),
                     [](const ScriptedEvent& a, const ScriptedEvent& b) { return a.frame < b.frame; });
    out = std::move(events);
    return {};
}

} // namespace xgc::viewer
