#include "camera_controls.h"
#include "frustum_lines.h"
#include "history.h"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <array>

namespace {

using namespace xgc;
using namespace xgc::viewer;

/// Where a camera shows a point: 0 to 1 each way.
glm::vec2 placeOf(const vulkan::Camera& camera, const glm::vec3& point) {
    const glm::vec4 clip = camera.worldToClip() * glm::vec4(point, 1);
    return 0.5f + 0.5f * glm::vec2(clip) / clip.w;
}

const std::array<glm::vec3, 3> kPoints = {{{-1, -1, -1}, {2, 1, 0}, {0, 3, 1}}};

} // namespace

TEST_CASE("framing shows all points, with a margin, whatever the picture's shape") {
    for (const float aspect : {0.4f, 1.0f, 2.5f}) {
        CameraControls controls;
        controls.frame(kPoints, aspect);
        glm::vec2 low(1), high(0);
        for (const glm::vec3& point : kPoints) {
            low = glm::min(low, placeOf(controls.camera(aspect), point));
            high = glm::max(high, placeOf(controls.camera(aspect), point));
        }
        CHECK(glm::all(glm::greaterThan(low, glm::vec2(0.02f))));
        CHECK(glm::all(glm::lessThan(high, glm::vec2(0.98f))));
        CHECK(std::max(high.x - low.x, high.y - low.y) > 0.8f); // it fills the picture
    }
}

TEST_CASE("orbiting keeps the distance and the target, and never turns the picture over") {
    CameraControls controls;
    controls.frame(kPoints, 1);
    const glm::vec3 target = controls.target();
    const float distance = controls.distance();
    for (int i = 0; i < 50; ++i) {
        controls.orbit(37, 29, 500);
        const vulkan::Camera camera = controls.camera(1);
        CHECK(camera.target == target);
        CHECK(glm::distance(camera.eye, camera.target) == doctest::Approx(distance).epsilon(1e-4));
        CHECK(camera.basis().up.y > 0);
    }
}

TEST_CASE("looking keeps the eye where it is, and panning moves what is under the pointer with it") {
    CameraControls controls;
    controls.frame(kPoints, 1.5f);
    const glm::vec3 eye = controls.camera(1.5f).eye;
    controls.look(80, -30, 600);
    CHECK(glm::distance(controls.camera(1.5f).eye, eye) < 1e-4f * controls.distance());

    const glm::vec3 under = controls.target();
    controls.pan(90, 45, 600); // right and down
    const glm::vec2 place = placeOf(controls.camera(1.5f), under);
    CHECK(place.x == doctest::Approx(0.5 + 90.0 / 900).epsilon(1e-3));
    CHECK(place.y == doctest::Approx(0.5 + 45.0 / 600).epsilon(1e-3));
}

TEST_CASE("zooming stops short of the target and of infinity, and flying goes where it looks") {
    CameraControls controls;
    controls.frame(kPoints, 1);
    for (int i = 0; i < 200; ++i) controls.zoom(5);
    CHECK(controls.distance() > 0);
    for (int i = 0; i < 400; ++i) controls.zoom(-5);
    CHECK(std::isfinite(controls.distance()));

    controls.frame(kPoints, 1);
    const vulkan::Camera before = controls.camera(1);
    controls.fly({0, 0, 1}, 0.25f);
    const glm::vec3 way = controls.camera(1).eye - before.eye;
    CHECK(glm::dot(glm::normalize(way), before.basis().forward) == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE("up may be z") {
    CameraControls controls;
    controls.setUp({0, 0, 1});
    controls.frame(kPoints, 1);
    const vulkan::Camera camera = controls.camera(1);
    CHECK(camera.basis().up.z > 0.5f);
    CHECK(camera.eye.z > camera.target.z); // from above
}

TEST_CASE("lines are projected, clipped at the near plane, and dropped behind it") {
    vulkan::Camera camera;
    camera.eye = {0, 0, 2};
    camera.target = {0, 0, 0};
    camera.fovY = glm::radians(90.0f);
    const std::vector<Line> whole = project(camera, {-1, 0, 0}, {1, 1, 0});
    REQUIRE(whole.size() == 1);
    CHECK(whole[0].from.x == doctest::Approx(0.25)); // 45 degrees are 0.5 from the middle
    CHECK(whole[0].to.y == doctest::Approx(0.25));   // up is less
    CHECK(project(camera, {0, 0, 3}, {0, 0, 4}).empty());
    const std::vector<Line> clipped = project(camera, {0.5f, 0, 3}, {0.5f, 0, 1});
    REQUIRE(clipped.size() == 1);
    CHECK(std::isfinite(clipped[0].from.x + clipped[0].from.y + clipped[0].to.x + clipped[0].to.y));
    CHECK(frustumLines(camera, camera, 1).size() >= 4); // the far rectangle at least
}

TEST_CASE("histories keep the latest values in order, and graphs get round tops") {
    History<4> history;
    CHECK(history.latest() == 0);
    for (int i = 1; i <= 6; ++i) history.add(float(i));
    REQUIRE(history.count() == 4);
    for (uint32_t i = 0; i < 4; ++i) CHECK(history.at(i) == float(3 + i));
    CHECK(history.latest() == 6);
    CHECK(history.largest() == 6);
    CHECK(niceCeiling(0) == 1);
    CHECK(niceCeiling(7148) == 10000);
    CHECK(niceCeiling(4100) == 5000);
    CHECK(niceCeiling(2000) == 2000);
}
