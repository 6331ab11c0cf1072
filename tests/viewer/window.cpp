#include "window_run.h"

#include "models.h"
#include "view_request.h"

#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/bake/models.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <array>
#include <fstream>

namespace {

using namespace xgc;
using namespace xgc::test;
using namespace xgc::viewer;

/// A small creature, as a model and baked; made once.
struct Files {
    std::string model = workFile("small.glb"), asset = workFile("small.xgc");

    Files() {
        bake::BakeOptions options;
        options.input = model;
        options.output = asset;
        bake::BakeReport report;
        REQUIRE(bake::exportModel(bake::makeModel(bake::BundledModel::creature, 3000), model).ok());
        REQUIRE(bake::bake(options, report).ok());
    }
};
const Files& files() {
    static const Files made;
    return made;
}

/// Draws what a report says with the headless renderer, in a picture of the size of the viewer's area.
class Headless {
public:
    Headless() {
        LoadedFile file;
        REQUIRE(bake::readImage(files().asset, file.bytes).ok());
        REQUIRE(openAll(file.bytes.span(), file.view).ok());
        models_.add(std::move(file));
        REQUIRE(device_.create().ok());
        REQUIRE(context_.create(device_.contextDesc()).ok());
    }

    bake::Image draw(const nlohmann::json& report, bool withHidden) {
        const VkExtent2D size{uint32_t(report["area"][2]), uint32_t(report["area"][3])};
        vulkan::OffscreenDesc target;
        target.size = size;
        REQUIRE(renderer_.create(context_, models_.rendererConfig()).ok());
        REQUIRE(offscreen_.create(context_, device_.queue(), target).ok());
        REQUIRE(models_.addTo(renderer_).ok());
        for (const nlohmann::json& steered : report["models"][0]["steered"]) {
            PartControl control{.hidden = steered["hidden"] && !withHidden};
            if (steered.contains("pinned")) control = PartControl::pinned(steered["pinned"]);
            REQUIRE(renderer_.setPart(models_.all()[0]->instance, steered["part"], control).ok());
        }
        vulkan::ViewDesc view;
        const auto vector = [&](const char* name) {
            return glm::vec3(report[name][0], report[name][1], report[name][2]);
        };
        view.camera.eye = vector("eye");
        view.camera.target = vector("target");
        view.camera.fovY = report["fovY"];
        view.camera.aspect = float(size.width) / float(size.height);
        view.mode = *vulkan::modeNamed(report["mode"].get<std::string>());
        SelectionDesc desc;
        desc.view = makeView(view.camera.eye, view.camera.fovY, float(size.height));
        desc.frustum = makeFrustum(view.camera.worldToClip());
        desc.pixels = report["pixels"];
        desc.hysteresis = 0.05f;
        desc.wholeBeyond = 1e30f;
        uint64_t frame = 0;
        do frame = drawFrame(view, desc);
        while (renderer_.stats().uploadBytes > 0 || renderer_.stats().triangles == 0); // until all of it is there
        triangles = renderer_.stats().triangles;
        bake::Image out{size.width, size.height, {}};
        out.pixels.resize(size_t(size.width) * size.height);
        REQUIRE(offscreen_.read(frame, std::as_writable_bytes(std::span(out.pixels))).ok());
        return out;
    }

    uint64_t triangles = 0; ///< of the last picture

private:
    uint64_t drawFrame(const vulkan::ViewDesc& view, const SelectionDesc& desc) {
        REQUIRE(renderer_.beginFrame().ok());
        renderer_.select(0, desc);
        renderer_.endFrame();
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        REQUIRE(offscreen_.begin(cmd).ok());
        renderer_.recordTransfers(cmd);
        offscreen_.beginRendering(cmd, std::array{0.0f, 0.0f, 0.0f, 1.0f});
        renderer_.recordBackground(cmd);
        REQUIRE(renderer_.recordDraws(cmd, view).ok());
        offscreen_.endRendering(cmd);
        uint64_t frame = 0;
        REQUIRE(offscreen_.submit(std::array{renderer_.frameDone()}, frame).ok());
        return frame;
    }

    Models models_;
    vulkan::HeadlessDevice device_;
    vulkan::Context context_;
    vulkan::Renderer renderer_;
    vulkan::Offscreen offscreen_;
};

/// A rectangle of the area, as fractions of it.
struct Part {
    double left = 0, top = 0, right = 1, bottom = 0.93; ///< below are hints
};

/// Fraction of the pixels that differ visibly between the viewer's area and a picture of it.
double difference(const ViewerRun& run, const bake::Image& expected, const Part& part = {}) {
    const auto x0 = uint32_t(run.report["area"][0]);
    REQUIRE(run.picture.width == x0 + expected.width);
    REQUIRE(run.picture.height == expected.height);
    uint64_t different = 0, all = 0;
    for (auto y = uint32_t(part.top * expected.height); y < uint32_t(part.bottom * expected.height); ++y) {
        for (auto x = uint32_t(part.left * expected.width); x < uint32_t(part.right * expected.width); ++x) {
            const glm::ivec4 a(run.picture.pixels[size_t(y) * run.picture.width + x0 + x]);
            const glm::ivec4 b(expected.pixels[size_t(y) * expected.width + x]);
            ++all;
            different += std::abs(a.r - b.r) > 8 || std::abs(a.g - b.g) > 8 || std::abs(a.b - b.b) > 8;
        }
    }
    return double(different) / double(all);
}

std::string text(const ViewerRun& run) {
    return fmt::format("exit code {}, report {}, output {}", run.exitCode, run.report.dump(), run.output);
}

} // namespace

TEST_CASE("the window shows what the headless renderer draws, and a click and a key hide a part") {
    if (!hasDisplay()) return;
    const ViewerRun run = runViewer(files().asset + " --size 600x320 --mode parts --pixels 4 --frames 11",
                                    {.script = "1 key G\n2 click 452 150\n6 key H\n9 key escape\n"});
    INFO(text(run));
    REQUIRE(run.exitCode == 0);
    REQUIRE(run.report["models"][0]["steered"].size() == 1);
    CHECK(run.report["models"][0]["steered"][0]["hidden"] == true);
    CHECK(run.report["picked"].is_null()); // escape let go of it

    Headless headless;
    const bake::Image hidden = headless.draw(run.report, false);
    CHECK(run.report["triangles"] == headless.triangles);
    CHECK(difference(run, hidden) < 0.002);
    // The part that went was what was under the click.
    const bake::Image whole = headless.draw(run.report, true);
    const auto x = uint32_t(452 - int(run.report["area"][0]));
    CHECK(whole.pixels[size_t(150) * whole.width + x] != hidden.pixels[size_t(150) * whole.width + x]);
    CHECK(difference(run, whole) > 0.02);
}

TEST_CASE("a mouse and a keyboard pick and pin a part, and the window may change its size") {
    if (!hasDisplay()) return;
    const std::string name = "small.xgc - xgc-viewer";
    const ViewerRun run =
        runViewer(files().asset + " --size 560x300 --pixels 4",
                  {.xdotool = "w=$(timeout 60 xdotool search --sync --name '^" + name + "$' | head -n 1)\n" +
                              "sleep 0.5\nxdotool windowsize $w 640 360\nsleep 0.7\nxdotool windowfocus $w\n"
                              "xdotool mousemove --window $w 478 170\nsleep 0.3\nxdotool click 1\nsleep 0.5\n"
                              "xdotool key p\nsleep 0.4\nxdotool key 2\nsleep 0.4\nxdotool key ctrl+q\n"});
    INFO(text(run));
    REQUIRE(run.exitCode == 0);
    CHECK(run.picture.width == 640);
    CHECK(run.picture.height == 360);
    CHECK(run.report["mode"] == "parts");
    REQUIRE(run.report["picked"].is_object());
    REQUIRE(run.report["models"][0]["steered"].size() == 1);
    const nlohmann::json& steered = run.report["models"][0]["steered"][0];
    CHECK(steered["part"] == run.report["picked"]["part"]);
    CHECK(steered["pinned"] > 0); // 4 pixels are coarser than the input
}

TEST_CASE("the split view's other side is one error at as many triangles, and the left side stays as it is") {
    if (!hasDisplay()) return;
    const ViewerRun run =
        runViewer(files().asset + " --size 360x300 --no-panel --mode levels --pixels 3 --split --frames 5",
                  {.script = "1 key G\n"});
    INFO(text(run));
    REQUIRE(run.exitCode == 0);
    CHECK(run.report["uniformTriangles"] <= run.report["triangles"]);
    CHECK(run.report["uniformTriangles"].get<double>() > 0.9 * run.report["triangles"].get<double>()); // few patches
    CHECK(run.report["uniformError"] > 0);
    Headless headless;
    const bake::Image expected = headless.draw(run.report, false);
    CHECK(difference(run, expected, {.top = 0.35, .right = 0.48}) < 0.002);
    CHECK(difference(run, expected, {.left = 0.52, .top = 0.35}) > 0.005);
}

TEST_CASE("a model is baked as it comes, and the same frames give the same picture") {
    if (!hasDisplay()) return;
    const std::string arguments = files().model + " --size 400x260 --morph --mode error --pixels 4 --frames 3";
    const ViewerRun first = runViewer(arguments);
    INFO(text(first));
    REQUIRE(first.exitCode == 0);
    CHECK(first.report["models"][0]["baked"] == true);
    const ViewerRun second = runViewer(arguments);
    REQUIRE(second.exitCode == 0);
    CHECK(first.picture.pixels == second.picture.pixels);
    CHECK(first.report == second.report);
}

TEST_CASE("frozen levels stay as they are while the camera goes outside") {
    if (!hasDisplay()) return;
    const ViewerRun run =
        runViewer(files().asset + " --size 360x300 --no-panel --pixels 3 --frames 9",
                  {.script = "2 key X\n3 move 180 100\n4 down left\n5 move 260 120\n6 up left\n7 wheel -30\n"});
    INFO(text(run));
    REQUIRE(run.exitCode == 0);
    CHECK(run.report["frozen"] == true);
    Headless headless;
    static_cast<void>(headless.draw(run.report, false)); // from the eye that has gone away, it takes far less
    CHECK(run.report["triangles"] > 2 * headless.triangles);
}

TEST_CASE("what cannot be shown is said: bad files, bad arguments, no display") {
    if (!hasDisplay()) return;
    std::ofstream(workFile("broken.xgc")) << "not an asset";
    const std::string broken = workFile("broken.xgc");
    const ViewerRun refused = runViewer(broken + " --frames 2");
    CHECK(refused.exitCode == 3);
    CHECK(refused.output.find(broken) != std::string::npos);

    // With a window open, it is a dialog, and the rest goes on.
    const ViewerRun dropped =
        runViewer(files().asset + " --size 360x300 --frames 6", {.script = "2 drop " + broken + "\n"});
    INFO(text(dropped));
    REQUIRE(dropped.exitCode == 0);
    REQUIRE(dropped.report["errors"].size() == 1);
    CHECK(dropped.report["errors"][0].get<std::string>().find(broken) != std::string::npos);
    CHECK(dropped.report["models"].size() == 1);

    const ViewerRun dark = runViewer(files().asset, {.display = false});
    CHECK(dark.exitCode == 4);
    CHECK(dark.output.find("DISPLAY") != std::string::npos);
    CHECK(dark.output.find("xvfb-run") != std::string::npos);
    for (const char* bad : {"--size 10x10", "--mode pretty", "--pixels -1", "--budget 0", "--frames 0",
                            "--screenshot a.jpg", "--script nothing.txt", "--morph --budget 5", "--nothing"}) {
        INFO(bad);
        std::string output;
        CHECK(runShell(std::string("'") + XGC_VIEWER + "' " + bad, output) == 2);
        CHECK_FALSE(output.empty());
    }
}
