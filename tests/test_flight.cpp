#include "meshes/patched_torus.h"

#include <xgc/bake/flight.h>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace {

using namespace xgc;

const test::OpenAsset& torus() {
    static const test::OpenAsset asset = test::openBuilt(test::patchedTorus({}));
    REQUIRE(asset.failure == "");
    return asset;
}

std::filesystem::path file(const char* name) {
    return std::filesystem::path(XGC_BINARY_DIR) / (std::string("test_flight_") + name + ".json");
}

/// A flight with something of everything that a frame can ask for.
bake::Flight recorded() {
    bake::Flight flight;
    flight.assets.push_back({"torus.xgc", bake::imageHash(torus().view)});
    for (int i = 0; i < 5; ++i) {
        const glm::mat4 m = glm::translate(glm::mat4(1), glm::vec3(7.3f * float(i), 0, 1.0f / 3));
        flight.instances.push_back({0, glm::mat4x3(glm::rotate(m, 0.7f * float(i), glm::vec3(0, 1, 0)))});
    }
    flight.arenaBytes = 1 << 20;
    flight.stagingBytes = 40'000; // less than some frames want
    const AssetView* views[] = {&torus().view};
    bake::FlightPlayer player;
    REQUIRE(player.create(flight, views).ok());
    for (int f = 0; f < 40; ++f) {
        bake::Flight::Frame& frame = flight.frames.emplace_back();
        const glm::vec3 eye(0.1f * float(f * f), 1.1f, 3.7f);
        frame.desc.view = f % 7 == 3 ? makeOrthographicView(eye, {0.3f, -1, 0.1f}, 30, 500) : makeView(eye, 1, 1080);
        frame.desc.view.nearest = 0.013f;
        frame.desc.pixels = 1.0f / 3;
        frame.desc.hysteresis = 0.1f;
        frame.desc.cullBackfaces = f % 2 == 0;
        frame.desc.frustum = makeFrustum(glm::perspectiveRH_ZO(1.0f, 1.5f, 0.1f, 90.0f) *
                                         glm::lookAt(eye, glm::vec3(9, 0, 0), glm::vec3(0, 1, 0)));
        if (f % 5 == 1) frame.desc.triangleBudget = 700;
        if (f % 5 == 2) {
            frame.desc.policy = Policy::distanceBands;
            frame.bands = {0.7f, 1.9f, 5};
        }
        if (f > 30) {
            frame.desc.morph = true;
            frame.desc.morphRate = 0.3f;
            frame.desc.hysteresis = 0;
            frame.desc.triangleBudget = 0;
        }
        if (f % 3 == 0) frame.desc.wholeBeyond = std::numeric_limits<float>::infinity();
        SelectionDesc desc = frame.desc;
        desc.bands = frame.bands;
        frame.hashes = player.play(desc, frame.triangles);
    }
    return flight;
}

std::string textOf(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

} // namespace

TEST_CASE("a flight replays to the same levels, draws and copies, from a file too") {
    const bake::Flight flight = recorded();
    CHECK(flight.frames[3].hashes.draws != flight.frames[20].hashes.draws);
    REQUIRE(bake::writeFlight(flight, file("whole")).ok());
    bake::Flight read;
    const bake::Status status = bake::readFlight(file("whole"), read);
    REQUIRE_MESSAGE(status.ok(), status.message);
    CHECK(read.assets[0].hash == flight.assets[0].hash);
    const AssetView* views[] = {&torus().view};
    for (const bake::Flight* one : {&flight, static_cast<const bake::Flight*>(&read)}) {
        std::vector<uint32_t> differing = {99};
        REQUIRE(bake::replayFlight(*one, views, differing).ok());
        CHECK(differing.empty());
    }
    // Writing what was read gives the same file: no float lost a bit.
    REQUIRE(bake::writeFlight(read, file("again")).ok());
    CHECK(textOf(file("whole")) == textOf(file("again")));
}

TEST_CASE("a frame that asks for something else is found, and what follows from its history") {
    bake::Flight flight = recorded();
    flight.frames[8].desc.pixels *= 3;
    const AssetView* views[] = {&torus().view};
    std::vector<uint32_t> differing;
    REQUIRE(bake::replayFlight(flight, views, differing).ok());
    REQUIRE(!differing.empty());
    CHECK(differing.front() == 8);
    flight = recorded();
    flight.instances[2].toWorld[3].x += 0.5f;
    REQUIRE(bake::replayFlight(flight, views, differing).ok());
    CHECK(differing.size() > 5);
}

TEST_CASE("damaged flights are refused with the element's name") {
    REQUIRE(bake::writeFlight(recorded(), file("good")).ok());
    const std::string good = textOf(file("good"));
    const auto expect = [&](const std::string& from, const std::string& to, const char* message) {
        std::string text = good;
        const size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        text.replace(at, from.size(), to);
        std::ofstream(file("bad")) << text;
        bake::Flight flight;
        const bake::Status status = bake::readFlight(file("bad"), flight);
        CHECK(status.outcome == bake::Outcome::badInput);
        CHECK_MESSAGE(status.message.find(message) != std::string::npos, status.message);
        CHECK(status.message.find("bad.json") != std::string::npos);
    };
    expect("\"xgcFlight\": 1", "\"xgcFlight\": 2", "version");
    expect("\"asset\": 0", "\"asset\": 1", "instances[0] names an asset");
    expect("\"hysteresis\": 0.1", "\"hysteresis\": 1", "frames[0] has a hysteresis");
    expect("\"nearest\": 0.013", "\"nearest\": -1", "frames[0] must be finite");
    expect("\"pixelsPerUnit\"", "\"pixelPerUnit\"", "frames[0]");
    expect("\"levels\": \"", "\"levels\": \"x", "hexadecimal");
    expect("\"morphRate\"", "\"hysteresis\": 0.5, \"morphRate\"", "frames");
    expect("\"frames\"", "\"frame\"", "frames");
    expect("{", "", "not a flight");
    for (size_t length = 0; length < good.size(); length += good.size() / 50) {
        std::ofstream(file("bad")) << good.substr(0, length);
        bake::Flight flight;
        CHECK_FALSE(bake::readFlight(file("bad"), flight).ok());
    }
    bake::Flight flight;
    CHECK_FALSE(bake::readFlight(file("absent"), flight).ok());
}
