#include "commands.h"
#include "open_asset.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/image.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>
#include <xgc/vulkan/renderer.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

namespace xgc::tool {
namespace {

constexpr uint32_t kMaxSide = 8192;

struct RenderOptions {
    std::filesystem::path input;
    std::filesystem::path output;
    std::string eye, target, up = "0,1,0", size = "1280x720";
    float fovDegrees = 35;
    std::optional<float> errorPixels;
    std::optional<uint32_t> level;
    std::string mode = "shaded";
    bool json = false;
    bool quiet = false;
};

/// Numbers between separators, all of them finite.
template <typename T, size_t N>
bool parseNumbers(std::string_view text, char separator, std::array<T, N>& out) {
    for (size_t i = 0; i < N; ++i) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out[i]);
        if (error != std::errc{} || !std::isfinite(double(out[i]))) return false;
        text.remove_prefix(size_t(end - text.data()));
        if (i + 1 == N) return text.empty();
        if (!text.starts_with(separator)) return false;
        text.remove_prefix(1);
    }
    return false;
}

bake::Status parsePoint(const char* option, const std::string& text, glm::vec3& out) {
    std::array<float, 3> v;
    if (!parseNumbers(text, ',', v)) {
        return bake::usageError(fmt::format("{} {}: expected three numbers as in 1,0.5,-2", option, text));
    }
    out = {v[0], v[1], v[2]};
    return {};
}

bake::Status parseSize(const std::string& text, VkExtent2D& out) {
    std::array<uint32_t, 2> v;
    if (!parseNumbers(text, 'x', v) || v[0] == 0 || v[1] == 0 || v[0] > kMaxSide || v[1] > kMaxSide) {
        return bake::usageError(
            fmt::format("--size {}: expected a width and a height of 1 to {} as in 1280x720", text, kMaxSide));
    }
    out = {v[0], v[1]};
    return {};
}

bake::Status makeCamera(const RenderOptions& options, const AssetView& asset, VkExtent2D size, vulkan::Camera& camera) {
    if (!(options.fovDegrees >= 1 && options.fovDegrees <= 170)) {
        return bake::usageError(fmt::format("--fov {}: expected 1 to 170 degrees", options.fovDegrees));
    }
    glm::vec3 up;
    bake::Status status = parsePoint("--up", options.up, up);
    if (!status.ok()) return status;
    if (glm::dot(up, up) == 0) return bake::usageError("--up 0,0,0: expected a direction");
    vulkan::Framing framing;
    framing.up = up;
    framing.fovY = glm::radians(options.fovDegrees);
    framing.aspect = float(size.width) / float(size.height);
    // Three quarters from the front and a little above, whatever the up axis.
    const vulkan::Camera::Basis front = vulkan::Camera{{0, 0, 1}, {0, 0, 0}, up}.basis();
    framing.towards = 0.65f * front.right + 0.38f * front.up - front.forward;
    const glm::vec3 origin(0);
    camera = vulkan::frame(asset.positions.empty() ? std::span(&origin, 1) : asset.positions, framing);
    if (!options.target.empty()) status = parsePoint("--target", options.target, camera.target);
    if (status.ok() && !options.eye.empty()) status = parsePoint("--eye", options.eye, camera.eye);
    if (!status.ok()) return status;
    if (camera.eye == camera.target) return bake::usageError("--eye and --target are one point: move one of them");
    return {};
}

/// Exit codes: the device's refusals are the system's, everything else a limit that the asset is past.
bake::Status fromDevice(const Status& status) {
    if (status.ok()) return {};
    const std::string message = fmt::format("{} ({})", status.message, int64_t(status.element));
    return status.code == StatusCode::deviceRefused || status.code == StatusCode::outOfCapacity
               ? bake::systemError(message)
               : bake::badInput(message);
}

bake::Status chooseLevels(const RenderOptions& options, const AssetView& asset, const View& view,
                          std::vector<uint8_t>& levels) {
    levels.assign(asset.patchCount(), 0);
    if (!options.level) {
        select(asset, {}, view, ErrorPixels{options.errorPixels.value_or(1)}, levels);
        return {};
    }
    if (*options.level >= asset.levelCount()) {
        return bake::usageError(fmt::format("--level {}: {} has levels 0 to {}", *options.level, options.input.string(),
                                            asset.levelCount() - 1));
    }
    levels.assign(asset.patchCount(), uint8_t(*options.level));
    return {};
}

/// Everything that draws one still. Members are destroyed from the last up: the target waits for its frames.
struct Studio {
    vulkan::HeadlessDevice device;
    vulkan::Context context;
    vulkan::Renderer renderer;
    vulkan::Offscreen target;
};

Status createStudio(Studio& studio, const AssetView& asset, VkExtent2D size) {
    Status status = studio.device.create();
    if (status.ok()) status = studio.context.create(studio.device.contextDesc());
    if (!status.ok()) return status;
    const AssetView* assets[] = {&asset};
    vulkan::RendererConfig base;
    base.vertexArenaBytes = 0;
    base.indexBytes = 64;
    vulkan::OffscreenDesc desc;
    desc.size = size;
    desc.supersampling = 2;
    status = studio.renderer.create(studio.context, vulkan::configFor(assets, 1, base));
    if (status.ok()) status = studio.target.create(studio.context, studio.device.queue(), desc);
    return status;
}

Status drawFrame(Studio& studio, const vulkan::ViewDesc& view, uint64_t& frame) {
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    Status status = studio.target.begin(cmd);
    if (!status.ok()) return status;
    studio.renderer.recordTransfers(cmd);
    studio.target.beginRendering(cmd, std::array{0.0f, 0.0f, 0.0f, 1.0f});
    studio.renderer.recordBackground(cmd);
    status = studio.renderer.recordDraws(cmd, view);
    studio.target.endRendering(cmd);
    if (!status.ok()) return status;
    return studio.target.submit(std::array{studio.renderer.frameDone()}, frame);
}

/// Frames until the asset is on the device and drawn at the levels.
Status drawStill(Studio& studio, const AssetView& asset, Levels levels, const vulkan::ViewDesc& view,
                 bake::Image& image) {
    vulkan::AssetHandle handle;
    vulkan::InstanceHandle instance;
    Status status = studio.renderer.addAsset(asset, handle);
    if (status.ok()) status = studio.renderer.addInstance(handle, {}, instance);
    uint64_t frame = 0;
    for (bool drawn = false; status.ok() && !drawn;) {
        status = studio.renderer.beginFrame();
        if (!status.ok()) return status;
        drawn = studio.renderer.resident(handle);
        if (drawn) status = studio.renderer.setLevels(instance, levels);
        studio.renderer.endFrame();
        drawn &= studio.renderer.stats().deferredInstances == 0;
        if (status.ok()) status = drawFrame(studio, view, frame);
    }
    if (!status.ok()) return status;
    const VkExtent2D size = studio.target.desc().size;
    image.width = size.width;
    image.height = size.height;
    image.pixels.resize(size_t(size.width) * size.height);
    return studio.target.read(frame, std::as_writable_bytes(std::span(image.pixels)));
}

void report(const RenderOptions& options, const AssetView& asset, Levels levels, const View& view,
            const vulkan::Camera& camera, const Studio& studio) {
    const float error = projectedError(asset, {}, view, levels);
    std::vector<uint32_t> patches(asset.levelCount(), 0);
    for (const uint8_t level : levels) ++patches[level];
    const float* c = asset.record->sphereCenter;
    const float radii = glm::distance(camera.eye, {c[0], c[1], c[2]}) / std::max(asset.record->sphereRadius, 1e-30f);
    const std::string pixels = std::isfinite(error) ? fmt::format("{:.4g}", error) : "null";
    if (options.json) {
        fmt::print("{{\"triangles\":{},\"errorPixels\":{},\"distanceRadii\":{:.4g},\"levels\":[{}],\"draws\":{}}}\n",
                   studio.renderer.stats().triangles, pixels, radii, fmt::join(patches, ","),
                   studio.renderer.drawList().draws().size());
    } else if (!options.quiet) {
        fmt::print(stderr, "{}: {} triangles, error {} pixels, from {:.4g} radii, on {}\n", options.output.string(),
                   studio.renderer.stats().triangles, std::isfinite(error) ? pixels : "unbounded", radii,
                   studio.device.name());
    }
}

bake::Status render(const RenderOptions& options) {
    if (options.errorPixels && !(*options.errorPixels >= 0)) {
        return bake::usageError("--error-pixels: expected 0 or more");
    }
    VkExtent2D size{};
    bake::Status status = parseSize(options.size, size);
    if (!status.ok()) return status;
    if (options.output.extension() != ".png") {
        return bake::usageError(fmt::format("{}: the picture must end in .png", options.output.string()));
    }
    OpenAsset opened;
    status = openAsset(options.input.string(), opened);
    if (!status.ok()) return status;
    const AssetView& asset = opened.view;
    vulkan::ViewDesc desc;
    desc.mode = *vulkan::modeNamed(options.mode);
    desc.linePixels *= 2; // the picture is drawn at twice its size
    status = makeCamera(options, asset, size, desc.camera);
    if (!status.ok()) return status;
    desc.sky = desc.camera.up / glm::length(desc.camera.up);
    const View view = makeView(desc.camera.eye, desc.camera.fovY, float(size.height));
    desc.measured = view;
    desc.errorPixels = options.errorPixels.value_or(1);
    std::vector<uint8_t> levels;
    status = chooseLevels(options, asset, view, levels);
    if (!status.ok()) return status;

    const auto studio = std::make_unique<Studio>();
    bake::Image image;
    status = fromDevice(createStudio(*studio, asset, size));
    if (status.ok()) status = fromDevice(drawStill(*studio, asset, levels, desc, image));
    if (status.ok()) status = bake::writePng(image, options.output);
    if (status.ok()) report(options, asset, levels, view, desc.camera, *studio);
    return status;
}

} // namespace

void addRender(CLI::App& app, Run& run) {
    const auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Draw a picture of an asset");
    command->footer("Example: xgc render creature.xgc -o creature.png --mode levels --error-pixels 2");
    command->add_option("input", options->input, "The .xgc file")->required();
    command->add_option("-o,--output", options->output, "The .png file to write")->required();
    command->add_option("--eye", options->eye, "Where the camera stands, x,y,z (default: it frames the asset)");
    command->add_option("--target", options->target, "What it looks at, x,y,z (default: the asset's centre)");
    command->add_option("--up", options->up, "Which way is up, x,y,z")->capture_default_str();
    command->add_option("--fov", options->fovDegrees, "Vertical field of view in degrees")->capture_default_str();
    command->add_option("--size", options->size, "Width and height in pixels")->capture_default_str();
    CLI::Option* error = command->add_option("--error-pixels", options->errorPixels,
                                             "Coarsest levels whose error stays below so many pixels (default: 1)");
    command->add_option("--level", options->level, "One level for every patch")->excludes(error);
    command->add_option("--mode", options->mode, "How it is coloured")
        ->check(CLI::IsMember({"shaded", "parts", "levels", "wire", "error"}))
        ->capture_default_str();
    command->add_flag("--json", options->json, "Print triangles, error and patches per level as JSON");
    command->add_flag("--quiet", options->quiet, "Print nothing but errors");
    command->callback([options, &run] { run = [options] { return render(*options); }; });
}

} // namespace xgc::tool
