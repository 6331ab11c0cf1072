// Flies a camera over baked assets and writes a picture and a line of JSON a frame: the whole of what a renderer does
// with xgc, without a window.
#include "asset_grid.h"
#include "camera_path.h"
#include "frame_line.h"
#include "recorder.h"

#include <xgc/bake/image.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <array>
#include <cstdio>
#include <limits>

namespace {

using namespace xgc;
using namespace xgc::headless;

/// A patch keeps its level while its distance changes by less than this part.
constexpr float kHysteresis = 0.05f;

struct Options {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output;
    std::string path = "orbit";
    uint32_t frames = 60;
    float errorPixels = 1;
    std::vector<float> bands; ///< empty: errorPixels decides
    uint32_t budget = 0;      ///< triangles a frame; 0: as many as it takes
    std::string mode = "shaded";
    std::filesystem::path record; ///< empty: no flight is written
    uint32_t width = 1280, height = 720;
    uint32_t instances = 1;
    bool morph = false;
};

// Destroyed from the last up: the target waits for its frames before anything that they use goes.
struct App {
    Options options;
    AssetGrid scene;
    CameraPath path;
    Recorder recorder;
    vulkan::HeadlessDevice device;
    vulkan::Context context;
    vulkan::Renderer renderer;
    vulkan::Offscreen target;
};

bake::Status fromRuntime(const Status& status) {
    if (status.ok()) return {};
    return bake::systemError(fmt::format("{} ({})", status.message, int64_t(status.element)));
}

Status createDevice(App& app) {
    Status status = app.device.create();
    if (status.ok()) status = app.context.create(app.device.contextDesc());
    if (!status.ok()) return status;
    const vulkan::RendererConfig config = app.scene.rendererConfig(app.options.morph);
    vulkan::OffscreenDesc target;
    target.size = {app.options.width, app.options.height};
    target.framesInFlight = config.framesInFlight;
    status = app.renderer.create(app.context, config);
    if (status.ok()) status = app.target.create(app.context, app.device.queue(), target);
    if (status.ok()) status = app.scene.addTo(app.renderer);
    return status;
}

vulkan::Camera cameraAt(const App& app, uint32_t frame) {
    const CameraKey key = app.path.at(app.options.frames > 1 ? float(frame) / float(app.options.frames - 1) : 0);
    vulkan::Camera camera;
    camera.eye = key.eye;
    camera.target = key.target;
    camera.fovY = glm::radians(45.0f);
    camera.aspect = float(app.options.width) / float(app.options.height);
    camera.nearPlane = app.scene.radius() / 1000;
    return camera;
}

/// What the camera asks for. An instance that cannot change yet keeps what it has: no hole, no crack.
SelectionDesc selectionFor(const App& app, const vulkan::Camera& camera) {
    SelectionDesc desc;
    desc.view = makeView(camera.eye, camera.fovY, float(app.options.height));
    desc.view.nearest = camera.nearPlane;
    desc.frustum = makeFrustum(camera.worldToClip());
    desc.pixels = app.options.errorPixels;
    desc.morph = app.options.morph;
    desc.hysteresis = desc.morph ? 0 : kHysteresis;
    if (!app.options.bands.empty()) {
        desc.policy = Policy::distanceBands;
        desc.bands = app.options.bands;
    }
    // One draw of a whole asset has one colour: these two colour patches.
    if (app.options.mode == "parts") desc.wholeBeyond = std::numeric_limits<float>::infinity();
    desc.triangleBudget = app.options.budget;
    return desc;
}

/// One frame, from levels to the queue. `ticket` names it for reading back.
Status drawFrame(App& app, const vulkan::Camera& camera, uint64_t& ticket) {
    Status status = app.renderer.beginFrame();
    if (!status.ok()) return status;
    app.renderer.select(0, selectionFor(app, camera));
    app.renderer.endFrame();

    VkCommandBuffer cmd = VK_NULL_HANDLE;
    status = app.target.begin(cmd);
    if (!status.ok()) return status;
    app.renderer.recordTransfers(cmd);
    app.target.beginRendering(cmd, std::array{0.0f, 0.0f, 0.0f, 1.0f});
    app.renderer.recordBackground(cmd);
    vulkan::ViewDesc view;
    view.camera = camera;
    view.mode = *vulkan::modeNamed(app.options.mode);
    view.measured = makeView(camera.eye, camera.fovY, float(app.options.height));
    view.errorPixels = app.options.errorPixels;
    status = app.renderer.recordDraws(cmd, view);
    app.target.endRendering(cmd);
    if (!status.ok()) return status;
    return app.target.submit(std::array{app.renderer.frameDone()}, ticket);
}

bake::Status writeFrame(App& app, uint64_t ticket, uint32_t frame) {
    bake::Image image;
    image.width = app.options.width;
    image.height = app.options.height;
    image.pixels.resize(size_t(image.width) * image.height);
    const Status read = app.target.read(ticket, std::as_writable_bytes(std::span(image.pixels)));
    if (!read.ok()) return fromRuntime(read);
    return bake::writePng(image, app.options.output / fmt::format("frame_{:04}.png", frame));
}

/// Frames from the first camera until every instance stands at the levels that it asks for: assets arrive in pieces.
bake::Status settle(App& app) {
    const vulkan::Camera camera = cameraAt(app, 0);
    do {
        uint64_t ticket = 0;
        const Status status = drawFrame(app, camera, ticket);
        if (!status.ok()) return fromRuntime(status);
    } while (app.renderer.stats().uploadBytes > 0);
    return {};
}

/// Pictures are read a frame late, so that the device draws one while the host writes the other.
bake::Status fly(App& app) {
    uint64_t previous = 0;
    for (uint32_t frame = 0; frame < app.options.frames; ++frame) {
        uint64_t ticket = 0;
        const vulkan::Camera camera = cameraAt(app, frame);
        if (!app.options.record.empty()) app.recorder.add(selectionFor(app, camera));
        const Status status = drawFrame(app, camera, ticket);
        if (!status.ok()) return fromRuntime(status);
        fmt::print("{}\n", frameLine(frame, app.renderer, app.scene.instances()));
        if (previous > 0) {
            const bake::Status written = writeFrame(app, previous, frame - 1);
            if (!written.ok()) return written;
        }
        previous = ticket;
    }
    const bake::Status written = writeFrame(app, previous, app.options.frames - 1);
    return written.ok() && !app.options.record.empty() ? app.recorder.write(app.options.record) : written;
}

bake::Status run(App& app) {
    bake::Status status = app.scene.load(app.options.inputs, app.options.instances);
    if (status.ok()) {
        status = CameraPath::make(app.options.path, app.scene.center(), app.scene.radius(), app.path);
    }
    if (!status.ok()) return status;
    std::error_code error;
    std::filesystem::create_directories(app.options.output, error);
    if (error) {
        return bake::systemError(fmt::format("{}: {}", app.options.output.string(), error.message()));
    }
    status = fromRuntime(createDevice(app));
    if (status.ok() && !app.options.record.empty()) status = app.recorder.begin(app.scene, app.options.inputs);
    if (status.ok()) status = settle(app);
    if (status.ok()) status = fly(app);
    return status;
}

void addOptions(CLI::App& cli, Options& options) {
    cli.footer("Example: xgc_headless creature.xgc temple.xgc -o frames --path flyby --frames 90 --mode levels");
    cli.add_option("assets", options.inputs, ".xgc files")->required();
    cli.add_option("-o,--output", options.output, "Folder for frame_0000.png and on")->required();
    cli.add_option("--path", options.path, "orbit, flyby, or a file of lines with eye and target")
        ->capture_default_str();
    cli.add_option("--frames", options.frames, "Pictures to draw")->check(CLI::Range(1, 100000))->capture_default_str();
    CLI::Option* error =
        cli.add_option("--error-pixels", options.errorPixels, "Coarsest levels whose error stays below so many pixels")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
    cli.add_option("--bands", options.bands, "Distances, in radii of the asset, at which levels 1, 2, ... begin")
        ->delimiter(',')
        ->excludes(error);
    CLI::Option* budget = cli.add_option("--budget", options.budget,
                                         "At most so many triangles a frame, at as few pixels of error as that takes")
                              ->check(CLI::Range(1u, 1u << 30));
    cli.add_flag("--morph", options.morph, "Levels change continuously, without a pop")->excludes(budget);
    cli.add_option("--mode", options.mode, "How it is coloured")
        ->check(CLI::IsMember({"shaded", "parts", "levels", "wire", "error"}))
        ->capture_default_str();
    cli.add_option_function<std::string>(
           "--size",
           [&options](const std::string& text) {
               char rest = 0;
               if (std::sscanf(text.c_str(), "%ux%u%c", &options.width, &options.height, &rest) != 2 ||
                   options.width - 1 >= 8192 || options.height - 1 >= 8192) {
                   throw CLI::ValidationError("--size", "expected a width and a height of 1 to 8192 as in 1280x720");
               }
           },
           "Width and height in pixels")
        ->default_str("1280x720");
    cli.add_option("--record", options.record, "Write the flight to a file that xgc replay plays again");
    cli.add_option("--instances", options.instances, "How often each asset stands there")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
}

} // namespace

int main(int argc, char** argv) {
    App app;
    CLI::App cli{"xgc_headless: fly a camera over baked assets"};
    addOptions(cli, app.options);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error) == 0 ? 0 : int(bake::Outcome::usage);
    }
    if (app.options.budget > 0 && !app.options.bands.empty()) {
        fmt::print(stderr, "xgc_headless: --budget goes by pixels of error, --bands by distance: give one of them\n");
        return int(bake::Outcome::usage);
    }
    if (!std::is_sorted(app.options.bands.begin(), app.options.bands.end())) {
        fmt::print(stderr, "xgc_headless: --bands must rise\n");
        return int(bake::Outcome::usage);
    }
    const bake::Status status = run(app);
    if (!status.ok()) fmt::print(stderr, "xgc_headless: {}\n", status.message);
    return int(status.outcome);
}
