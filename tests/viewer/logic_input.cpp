#include "controls.h"
#include "loader.h"
#include "script.h"

#include <xgc/bake/export.h>
#include <xgc/bake/models.h>

#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>
#include <unistd.h>

namespace {

using namespace xgc;
using namespace xgc::viewer;

constexpr Area kArea{100, 0, 800, 600};

struct Hand {
    Controls controls;
    ViewerState state;

    void move(float x, float y) {
        Event event;
        event.x = x;
        event.y = y;
        controls.handle(event, state, kArea, false, false);
    }
    void press(EventKind kind, int code, bool down, bool overPanel = false, bool typing = false) {
        Event event;
        event.kind = kind;
        event.code = code;
        event.down = down;
        controls.handle(event, state, kArea, overPanel, typing);
    }
    void key(int code) {
        press(EventKind::key, code, true);
        press(EventKind::key, code, false);
    }
};

std::vector<ScriptedEvent> parsed(const std::string& text) {
    std::vector<ScriptedEvent> out;
    const bake::Status status = parseScript(text, "test", out);
    INFO(status.message);
    REQUIRE(status.ok());
    return out;
}

std::string refusal(const std::string& text) {
    std::vector<ScriptedEvent> out;
    const bake::Status status = parseScript(text, "test", out);
    CHECK_FALSE(status.ok());
    CHECK(out.empty());
    return status.message;
}

/// What the loader has made of its requests once it rests.
std::vector<Loader::Result> wait(Loader& loader) {
    std::vector<Loader::Result> out;
    while (loader.busy()) {
        while (std::optional<Loader::Result> result = loader.take()) out.push_back(std::move(*result));
        usleep(2000);
    }
    return out;
}

struct ScratchFile {
    std::filesystem::path path;
    explicit ScratchFile(const char* name)
        : path(std::filesystem::temp_directory_path() / (std::to_string(getpid()) + name)) {}
    ~ScratchFile() { std::filesystem::remove(path); }
};

} // namespace

TEST_CASE("a click picks, a drag orbits, and the panel's own clicks do neither") {
    Hand hand;
    const glm::vec3 eye = hand.state.camera.camera(1).eye;
    hand.move(400, 300);
    hand.press(EventKind::button, 0, true);
    hand.move(401, 300); // a hand trembles
    hand.press(EventKind::button, 0, false);
    REQUIRE(hand.state.askPick);
    CHECK(*hand.state.askPick == glm::vec2(401, 300));
    CHECK(hand.state.camera.camera(1).eye == eye);

    hand.state.askPick.reset();
    hand.press(EventKind::button, 0, true);
    hand.move(450, 320);
    hand.press(EventKind::button, 0, false);
    CHECK_FALSE(hand.state.askPick);
    CHECK(hand.state.camera.camera(1).eye != eye);

    hand.press(EventKind::button, 0, true, true);
    hand.press(EventKind::button, 0, false, true);
    CHECK_FALSE(hand.state.askPick);
    hand.move(50, 300); // beside the picture
    hand.press(EventKind::button, 0, true);
    hand.press(EventKind::button, 0, false);
    CHECK_FALSE(hand.state.askPick);
}

TEST_CASE("the line of a split view is dragged, and stays in the picture") {
    Hand hand;
    hand.key('V');
    REQUIRE(hand.state.split);
    hand.move(500, 300);
    hand.press(EventKind::button, 0, true);
    hand.move(300, 300);
    CHECK(hand.state.splitAt == doctest::Approx(0.25));
    hand.move(-4000, 300);
    CHECK(hand.state.splitAt > 0);
    hand.press(EventKind::button, 0, false);
    CHECK_FALSE(hand.state.askPick);
}

TEST_CASE("keys change the settings, unless they are typed into a field") {
    Hand hand;
    hand.key('4');
    CHECK(hand.state.mode == vulkan::ShadingMode::wire);
    hand.key(']');
    CHECK(hand.state.pixels == 2);
    for (int i = 0; i < 10; ++i) hand.key('[');
    CHECK(hand.state.pixels == 0); // all the detail there is
    hand.key(']');
    CHECK(hand.state.pixels > 0);
    hand.press(EventKind::key, 'M', true, false, true);
    CHECK_FALSE(hand.state.morph);
    hand.press(EventKind::key, kKeyLeftControl, true);
    hand.key('Q');
    CHECK(hand.state.askQuit);

    const glm::vec3 eye = hand.state.camera.camera(1).eye;
    hand.press(EventKind::key, kKeyLeftControl, false);
    hand.press(EventKind::key, 'W', true);
    hand.controls.advance(hand.state, 0.1f);
    CHECK(hand.state.camera.camera(1).eye != eye);
}

TEST_CASE("scripts become events in order of their frames") {
    const std::vector<ScriptedEvent> events =
        parsed("# a comment\n2 move 10 20\n\n4 click 30 40 # why\n5 key h\n9 quit\n");
    REQUIRE(events.size() == 7);
    CHECK(events[1].event.x == 30);
    const uint32_t frames[] = {2, 4, 5, 5, 6, 6, 9};
    for (size_t i = 0; i < events.size(); ++i) CHECK(events[i].frame == frames[i]);
    CHECK(events[3].event.code == 'H');
    CHECK(events.back().event.kind == EventKind::quit);
    CHECK(parsed("1 drop a file.glb\n").front().event.files.front() == "a file.glb");
}

TEST_CASE("lines that are no events are refused by name and number") {
    for (const char* line : {"move 1 2", "1 move 1", "1 jump", "1 key nothing", "1 down north", "1 wheel", "1 quit now",
                             "1 move 1 2 3", "-1 quit"}) {
        const std::string text = line;
        INFO(text);
        const std::string message = refusal("1 quit\n" + text + "\n");
        CHECK(message.find("test:2") != std::string::npos);
    }
    CHECK(refusal("5 quit\n3 quit\n").find("frame 3 after 5") != std::string::npos);
}

TEST_CASE("the loader bakes models, opens assets, and says what is wrong with files") {
    const ScratchFile model("viewer_small.glb"), broken("viewer_broken.xgc");
    REQUIRE(bake::exportModel(bake::makeModel(bake::BundledModel::shaft, 600), model.path).ok());
    std::FILE* file = std::fopen(broken.path.c_str(), "w");
    std::fputs("no asset", file);
    std::fclose(file);

    Loader loader;
    loader.request(model.path);
    loader.request(broken.path);
    loader.request("no/such/file.glb");
    const std::vector<Loader::Result> results = wait(loader);
    REQUIRE(results.size() == 3);
    INFO(results[0].status.message);
    REQUIRE(results[0].status.ok());
    CHECK(results[0].file.baked);
    CHECK(results[0].file.view.record->faceCount > 500);
    CHECK(results[1].status.message.find(broken.path.string()) != std::string::npos);
    CHECK(results[2].status.message.find("no/such/file.glb") != std::string::npos);
}

TEST_CASE("loading is given up when asked, and when the program ends") {
    Loader loader;
    loader.request("terrain"); // takes seconds
    while (loader.progress().fraction == 0) usleep(1000);
    loader.request("temple");
    loader.cancel();
    CHECK(wait(loader).empty());
    loader.request("terrain");
    while (!loader.progress().busy) usleep(1000);
}
