// A scene that uses all of it: a hundred creatures around a temple on a terrain, and an animal that runs by its joints,
// in the sun with shadows, every part at a level of its own. Writes a picture a frame.
#include "clip.h"
#include "pages.h"
#include "world.h"

#include <xgc/bake/image.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>
#include <xgc/vulkan/renderer.h>
#include <xgc/vulkan/shadow_map.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace {

using namespace xgc;
using namespace xgc::scene_sample;

constexpr uint32_t kCreatures = 100;
constexpr uint64_t kDiskBytes = 200'000'000 / 30; ///< a frame
constexpr uint32_t kMostSettling = 300;           ///< frames: under a budget pages may never come to rest

struct Options {
    std::filesystem::path creature, temple, terrain, fox, animation, output;
    std::string clip = "Run";
    std::string mode = "shaded";
    uint32_t width = 1280, height = 720;
    uint32_t frames = 1;
    uint32_t shadowTexels = 4096;
    float errorPixels = 1;
    bool still = false;
    bool gpu = false;
    bool eyeShadows = false;
    double stream = 0; ///< share of the scene's bytes that its pages may take; 0: all is in memory
    bool approach = false;
};

// Destroyed from the last up: the target waits for its frames before anything that they use goes.
struct App {
    Options options;
    LoadedAsset creature, temple, terrain, fox;
    Clip clip;
    World world;
    Pages pages; ///< of creature, temple and terrain
    vulkan::HeadlessDevice device;
    vulkan::Context context;
    vulkan::Renderer renderer;
    vulkan::ShadowMap shadows;
    vulkan::Offscreen target;
    vulkan::InstanceHandle runner;
    std::vector<vulkan::AssetHandle> handles;
};

bake::Status fromRuntime(const Status& status) {
    if (status.ok()) return {};
    return bake::systemError(fmt::format("{} ({})", status.message, int64_t(status.element)));
}

bake::Status load(App& app) {
    const Options& o = app.options;
    const std::pair<LoadedAsset*, const std::filesystem::path*> files[] = {
        {&app.creature, &o.creature}, {&app.temple, &o.temple}, {&app.terrain, &o.terrain}, {&app.fox, &o.fox}};
    for (const auto& [asset, file] : files) {
        const bake::Status status = asset->load(*file);
        if (!status.ok()) return status;
    }
    // Where things stand is told by the whole files; an engine has that from its level.
    app.world = makeWorld({app.creature.view, app.temple.view, app.terrain.view, app.fox.view}, kCreatures);
    if (o.stream > 0) {
        const bake::Status status = app.pages.open({o.creature, o.temple, o.terrain}, o.stream);
        if (!status.ok()) return status;
    }
    return o.animation.empty() ? bake::Status{} : Clip::read(o.animation, o.clip, app.clip);
}

vulkan::RendererConfig configFor(App& app) {
    const AssetView* one[] = {&app.creature.view, &app.temple.view, &app.terrain.view, &app.fox.view};
    vulkan::RendererConfig config = vulkan::configFor(one, 1);
    config.instanceCapacity = kCreatures + 4;
    config.patchCapacity += kCreatures * app.creature.view.patchCount();
    config.indexBytes += 64u << 20;
    config.viewCapacity = 2;
    if (app.options.gpu) config.gpu.views = 2;
    if (app.options.stream > 0) config.residency = &app.pages.residency();
    config.waitNanoseconds = 120'000'000'000; // a software device takes its time
    return config;
}

Status addAll(App& app) {
    const std::pair<const AssetView*, std::vector<glm::mat4>> all[] = {{&app.creature.view, app.world.creatures},
                                                                       {&app.temple.view, {app.world.temple}},
                                                                       {&app.terrain.view, {app.world.terrain}},
                                                                       {&app.fox.view, {app.world.fox}}};
    for (const auto& [asset, places] : all) {
        vulkan::AssetHandle handle;
        const bool streamed = app.options.stream > 0 && asset != &app.fox.view;
        Status status = streamed ? app.renderer.addStreamedAsset(app.pages.asset(app.handles.size()), handle)
                                 : app.renderer.addAsset(*asset, handle);
        if (!status.ok()) return status;
        app.handles.push_back(handle);
        for (const glm::mat4& place : places) {
            status = app.renderer.addInstance(handle, makePlacement(place), app.runner); // the fox is the last
            if (!status.ok()) return status;
        }
    }
    return {};
}

Status createDevice(App& app) {
    Status status = app.device.create();
    if (status.ok()) status = app.context.create(app.device.contextDesc());
    if (!status.ok()) return status;
    vulkan::OffscreenDesc target;
    target.size = {app.options.width, app.options.height};
    target.supersampling = app.options.still ? 2 : 1;
    const vulkan::RendererConfig config = configFor(app);
    status = app.renderer.create(app.context, config);
    if (status.ok()) status = app.shadows.create(app.context, app.options.shadowTexels);
    if (status.ok()) status = app.target.create(app.context, app.device.queue(), target);
    if (status.ok()) status = addAll(app);
    return status;
}

/// The pose of the moment; without an animation, a slow wave through the joints.
Status pose(App& app, float second) {
    const AssetView& asset = app.fox.view;
    if (asset.joints.empty()) return {};
    std::vector<glm::mat4> nodes(asset.nodes.size());
    std::vector<glm::mat4x3> joints(asset.joints.size());
    const float length = std::max(app.clip.seconds(), 1e-3f);
    app.clip.sample(asset, std::fmod(second, length), nodes);
    if (app.options.animation.empty()) {
        for (size_t j = 1; j < asset.joints.size(); ++j) {
            const float bend = 0.25f * std::sin(3 * second + float(j));
            nodes[asset.joints[j].node] *=
                glm::mat4(glm::mat3(1, 0, 0, 0, std::cos(bend), std::sin(bend), 0, -std::sin(bend), std::cos(bend)));
        }
    }
    nodesToMesh(asset, nodes, nodes);
    jointMatrices(asset, nodes, joints);
    return app.renderer.setPose(app.runner, {joints, {}});
}

vulkan::ViewDesc viewFor(const App& app, const vulkan::SunView& sunView, const glm::vec3& towards, float second) {
    vulkan::ViewDesc view;
    view.mode = *vulkan::modeNamed(app.options.mode);
    view.camera.eye = app.world.eye;
    view.camera.target = app.world.target;
    if (app.options.approach) view.camera.eye += (1 - std::cos(0.8f * second)) * glm::vec3(-1.8f, -0.3f, -3.6f);
    view.camera.fovY = 0.62f;
    view.camera.aspect = float(app.options.width) / float(app.options.height);
    view.camera.nearPlane = 0.05f;
    view.sun = vulkan::Sun{
        towards,           {1.0f, 0.9f, 0.74f}, app.shadows.depths(), app.shadows.texels(), sunView.worldToClip,
        sunView.texelUnits};
    return view;
}

SelectionDesc wantedBy(const App& app, const vulkan::ViewDesc& view) {
    SelectionDesc desc;
    desc.view = makeView(view.camera.eye, view.camera.fovY, float(app.options.height));
    desc.view.nearest = view.camera.nearPlane;
    desc.frustum = makeFrustum(view.camera.worldToClip());
    desc.pixels = app.options.errorPixels;
    return desc;
}

/// The camera's levels, and the sun's: no caster is more than a level coarser than what is seen of it; or those that
/// the camera's eye asks for, for the device refers to no other view.
void select(App& app, const vulkan::ViewDesc& view, const vulkan::SunView& sun) {
    const SelectionDesc desc = wantedBy(app, view);
    app.renderer.select(0, desc);
    SelectionDesc shadow;
    if (app.options.gpu || app.options.eyeShadows) {
        shadow = desc;
    } else {
        shadow.view = sun.view;
        shadow.reference = &app.renderer.selection(0);
        shadow.coarserThanReference = 1;
    }
    shadow.frustum = makeFrustum(sun.worldToClip);
    app.renderer.select(1, shadow);
}

Status drawFrame(App& app, float second, uint64_t& ticket) {
    const glm::vec3 towards = app.world.towardsSun;
    const vulkan::SunView sun = vulkan::sunView(towards, app.world.center, app.world.radius, app.options.shadowTexels);
    const vulkan::ViewDesc view = viewFor(app, sun, towards, second);
    if (app.options.stream > 0) {
        app.pages.residency().want(app.renderer.scene(), app.renderer.selection(), wantedBy(app, view));
        app.pages.read(kDiskBytes);
    }
    Status status = app.renderer.beginFrame();
    if (status.ok()) status = pose(app, second);
    if (!status.ok()) return status;
    select(app, view, sun);
    app.renderer.endFrame();

    VkCommandBuffer cmd = VK_NULL_HANDLE;
    status = app.target.begin(cmd);
    if (!status.ok()) return status;
    app.renderer.recordTransfers(cmd);
    app.shadows.begin(cmd);
    status = app.renderer.recordDepth(cmd, {.view = 1, .worldToClip = sun.worldToClip});
    app.shadows.end(cmd);
    app.target.beginRendering(cmd, std::array{0.0f, 0.0f, 0.0f, 1.0f});
    app.renderer.recordBackground(cmd);
    if (status.ok()) status = app.renderer.recordDraws(cmd, view);
    app.target.endRendering(cmd);
    if (!status.ok()) return status;
    return app.target.submit(std::array{app.renderer.frameDone()}, ticket);
}

/// Of the patches in sight of the camera: errors on the screen, rising.
std::vector<float> errorsInSight(const App& app, const SelectionDesc& desc) {
    const Scene& scene = app.renderer.scene();
    const DrawList& draws = app.renderer.drawList();
    std::vector<float> errors;
    for (uint32_t id = 0; id < scene.instanceEnd(); ++id) {
        if (!scene.hasInstance(id) || draws.kind(id) != InstanceKind::mixed) continue; // whole ones are as asked for
        const AssetView& asset = *scene.asset(scene.assetOf(id)).asset;
        const Placement& placement = scene.placement(id);
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            if (!app.renderer.selection().visible(id)[p]) continue;
            const glm::vec4 sphere = scene.patchBounds(scene.assetOf(id))[p].sphere;
            const glm::vec3 center = placement.toWorld * glm::vec4(glm::vec3(sphere), 1);
            const float away = glm::distance(center, desc.view.eye) - sphere.w * placement.maxScale;
            const float error = asset.error(p, draws.levels(id)[p]) * placement.maxScale;
            errors.push_back(error * desc.view.pixelsPerUnit / std::max(away, desc.view.nearest));
        }
    }
    std::sort(errors.begin(), errors.end());
    return errors;
}

std::string streamingStats(const App& app, const SelectionDesc& desc) {
    const std::vector<float> errors = errorsInSight(app, desc);
    if (app.options.stream == 0 || errors.empty()) return {};
    const ResidencyStats stats = app.pages.residency().stats();
    return fmt::format(", \"errorPixels95\": {:.2f}, \"errorPixels\": {:.2f}, \"residentBytes\": {}, "
                       "\"readBytes\": {}, \"sceneBytes\": {}",
                       errors[errors.size() * 19 / 20], errors.back(), stats.residentBytes, stats.readBytes,
                       app.pages.sceneBytes());
}

bake::Status writeFrame(App& app, uint64_t ticket, uint32_t frame, float second) {
    bake::Image image{app.options.width, app.options.height, {}};
    image.pixels.resize(size_t(image.width) * image.height);
    const Status read = app.target.read(ticket, std::as_writable_bytes(std::span(image.pixels)));
    if (!read.ok()) return fromRuntime(read);
    vulkan::FrameStats stats = app.renderer.stats();
    for (uint32_t view = 0; view < 2 && app.options.gpu; ++view) {
        stats.triangles += app.renderer.gpuStats(view).triangles;
        stats.draws += app.renderer.gpuStats(view).draws;
    }
    const SelectionDesc desc = wantedBy(app, viewFor(app, {}, {}, second));
    fmt::print("{{\"frame\": {}, \"triangles\": {}, \"draws\": {}, \"uploadBytes\": {}{}}}\n", frame, stats.triangles,
               stats.draws, stats.uploadBytes, streamingStats(app, desc));
    return bake::writePng(image, app.options.output / fmt::format("frame_{:04}.png", frame));
}

/// Assets arrive in pieces, and what the device made is known framesInFlight frames later.
bake::Status settle(App& app, uint64_t& ticket) {
    bake::Status status;
    const uint32_t enough = app.options.gpu || app.options.stream > 0 ? vulkan::RendererConfig{}.framesInFlight : 0;
    for (uint32_t still = 0, frame = 0; status.ok() && still <= enough && frame < kMostSettling; ++frame) {
        status = fromRuntime(drawFrame(app, 0, ticket));
        still = app.renderer.stats().uploadBytes > 0 ? 0 : still + 1;
    }
    const char* reason = app.options.gpu ? app.renderer.hostReason(0) : nullptr;
    if (status.ok() && reason) return bake::systemError(fmt::format("--gpu: not on this device: {}", reason));
    return status;
}

bake::Status run(App& app) {
    bake::Status status = load(app);
    if (status.ok()) status = fromRuntime(createDevice(app));
    if (!status.ok()) return status;
    std::error_code error;
    std::filesystem::create_directories(app.options.output, error);
    if (error) return bake::systemError(fmt::format("{}: {}", app.options.output.string(), error.message()));
    uint64_t ticket = 0;
    status = settle(app, ticket);
    for (uint32_t frame = 0; status.ok() && frame < app.options.frames; ++frame) {
        const float second = 0.3f + float(frame) / 30;
        status = fromRuntime(drawFrame(app, second, ticket));
        if (status.ok()) status = writeFrame(app, ticket, frame, second);
    }
    return status;
}

} // namespace

int main(int argc, char** argv) {
    App app;
    Options& o = app.options;
    CLI::App cli{"xgc_scene: creatures, a temple, a terrain and a runner in the sun"};
    cli.add_option("--creature", o.creature, ".xgc file")->required();
    cli.add_option("--temple", o.temple, ".xgc file")->required();
    cli.add_option("--terrain", o.terrain, ".xgc file")->required();
    cli.add_option("--runner", o.fox, ".xgc file with a skin, such as Khronos' Fox")->required();
    cli.add_option("--animation", o.animation, "The .glb that the runner was baked from: its clip is played");
    cli.add_option("--clip", o.clip, "Name of the clip")->capture_default_str();
    cli.add_option("-o,--output", o.output, "Folder for frame_0000.png and on")->required();
    cli.add_option("--frames", o.frames, "Pictures to draw, 30 a second")->capture_default_str();
    cli.add_option("--width", o.width)->check(CLI::Range(1, 4096))->capture_default_str();
    cli.add_option("--height", o.height)->check(CLI::Range(1, 4096))->capture_default_str();
    cli.add_option("--error-pixels", o.errorPixels)->check(CLI::NonNegativeNumber)->capture_default_str();
    cli.add_option("--mode", o.mode, "How it is coloured")
        ->check(CLI::IsMember({"shaded", "parts", "levels", "wire"}))
        ->capture_default_str();
    CLI::Option* stream =
        cli.add_option("--stream", o.stream,
                       "Streams all but the runner (baked with --tiers), in memory of this share of their pages: 0.1")
            ->check(CLI::Range(0.001, 10.0));
    cli.add_flag("--approach", o.approach, "The camera goes towards the temple and back");
    cli.add_flag("--gpu", o.gpu, "Chooses levels, culls and builds index lists and draws on the device")
        ->excludes(stream);
    cli.add_flag("--eye-shadows", o.eyeShadows, "What casts shadows takes its levels from the camera, as with --gpu");
    cli.add_flag("--still", o.still, "Draws at twice the size and halves the picture");
    CLI11_PARSE(cli, argc, argv);
    const bake::Status status = run(app);
    if (!status.ok()) fmt::print(stderr, "xgc_scene: {}\n", status.message);
    return int(status.outcome);
}
