#include "asset.h"
#include "gpu_sections.h"

#include <xgc/bake/models.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>
#include <xgc/vulkan/renderer.h>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <optional>

// One flight, drawn three times in step: the host selects, the device does, the device does and hides what is hidden.
// On a device without a graphics processor times of the device prove nothing; what is counted does.

namespace xgc::bench {
namespace {

constexpr uint32_t kWidth = 640, kHeight = 360, kFrames = 60, kSide = 10;

using Clock = std::chrono::steady_clock;
using Pixels = std::vector<uint32_t>;

/// A square of one model, and the camera's way through it.
struct Crowd {
    const char* model;
    uint32_t faces;
    float spacing; ///< radii of the model
    float height;  ///< of the eye, likewise
};

constexpr Crowd kCrowds[] = {{"creature", 20000, 2.5f, 0.4f}, {"temple", 20000, 1.6f, 0.1f}};

bake::Status makeAsset(const Crowd& crowd, OpenAsset& out) {
    Subject subject;
    const bake::Status loaded = load({crowd.model, {}, crowd.faces}, subject);
    if (!loaded.ok()) return loaded;
    const bake::Hierarchy hierarchy = build(subject, subject.parts, {}, crowd.faces / 60);
    return layOut(subject, subject.parts, hierarchy, measureErrors(subject, hierarchy), out);
}

enum class Way { host, device, occluded };

struct Drawn {
    uint64_t triangles = 0, draws = 0, uploadBytes = 0;
    double hostSeconds = 0;
    Pixels pixels;
};

/// A renderer that draws the crowd one way.
class Studio {
public:
    Status create(const vulkan::HeadlessDevice& device, const vulkan::Context& context, const AssetView& asset,
                  Way way) {
        way_ = way;
        const AssetView* const assets[] = {&asset};
        vulkan::RendererConfig config = vulkan::configFor(assets, kSide * kSide);
        config.samples = VK_SAMPLE_COUNT_1_BIT;
        config.framesInFlight = 1;
        if (way != Way::host) config.gpu = {.views = 1, .indexBytes = 256u << 20};
        if (way == Way::occluded) config.gpu.depthPixels = kWidth * kHeight;
        Status status = renderer_.create(context, config);
        vulkan::OffscreenDesc target;
        target.size = {kWidth, kHeight};
        target.samples = VK_SAMPLE_COUNT_1_BIT;
        target.pauses = way == Way::occluded;
        if (status.ok()) status = offscreen_.create(context, device.queue(), target);
        vulkan::AssetHandle handle;
        if (status.ok()) status = renderer_.addAsset(asset, handle);
        asset_ = handle;
        renderer_.useOcclusion(0, true);
        return status;
    }
    Status place(const Placement& placement) {
        vulkan::InstanceHandle instance;
        return renderer_.addInstance(asset_, placement, instance);
    }
    Status frame(const vulkan::Camera& camera, const SelectionDesc& desc, Drawn& out) {
        vulkan::ViewDesc view;
        view.camera = camera;
        Status status = renderer_.beginFrame();
        if (!status.ok()) return status;
        const Clock::time_point start = Clock::now();
        renderer_.select(0, desc);
        renderer_.endFrame();
        out.hostSeconds = std::chrono::duration<double>(Clock::now() - start).count();
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        status = offscreen_.begin(cmd);
        if (!status.ok()) return status;
        constexpr std::array<float, 4> kGround{0.5f, 0.5f, 0.5f, 1};
        renderer_.recordTransfers(cmd);
        offscreen_.beginRendering(cmd, kGround);
        status = renderer_.recordDraws(cmd, view);
        if (way_ == Way::occluded && status.ok()) {
            const VkImage depth = offscreen_.pauseRendering(cmd);
            status = renderer_.recordOcclusion(cmd, view, depth, {kWidth, kHeight});
            offscreen_.resumeRendering(cmd);
            if (status.ok()) status = renderer_.recordLateDraws(cmd, view);
        }
        offscreen_.endRendering(cmd);
        if (!status.ok()) return status;
        const std::array signals = {renderer_.frameDone()};
        uint64_t number = 0;
        status = offscreen_.submit(signals, number);
        out.pixels.resize(size_t(kWidth) * kHeight);
        if (status.ok()) status = offscreen_.read(number, std::as_writable_bytes(std::span(out.pixels)));
        return status;
    }
    /// Draws a frame, or as many as the asset takes to arrive.
    Status settle(const vulkan::Camera& camera, const SelectionDesc& desc, Drawn& out) {
        Status status;
        do {
            status = frame(camera, desc, out);
        } while (status.ok() && !renderer_.resident(asset_));
        return status;
    }
    /// What was drawn: on the host in the latest frame, on the device in the one before.
    void count(Drawn& latest, Drawn& before) const {
        const vulkan::FrameStats& stats = renderer_.stats();
        const vulkan::GpuStats& gpu = renderer_.gpuStats(0);
        latest.uploadBytes = stats.uploadBytes;
        Drawn& out = way_ == Way::host ? latest : before;
        out.triangles = way_ == Way::host ? stats.triangles : gpu.triangles;
        out.draws = way_ == Way::host ? stats.draws : gpu.draws;
    }

private:
    Way way_ = Way::host;
    vulkan::Renderer renderer_;
    vulkan::AssetHandle asset_;
    vulkan::Offscreen offscreen_;
};

/// Where the camera is in a frame.
vulkan::Camera cameraAt(const Crowd& crowd, float radius, uint32_t frame) {
    const float t = float(frame) / kFrames, side = crowd.spacing * radius * float(kSide - 1);
    vulkan::Camera camera;
    camera.eye = {side * (0.05f + 0.5f * t) + 0.5f * crowd.spacing * radius, crowd.height * radius,
                  side * (0.45f + 0.1f * std::sin(6 * t)) + 0.5f * crowd.spacing * radius};
    camera.target = camera.eye + glm::vec3(std::cos(t), 0.02f, std::sin(2 * t) * 0.5f);
    camera.nearPlane = 0.02f * radius;
    return camera;
}

size_t different(const Pixels& a, const Pixels& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

struct Sums {
    std::array<double, 3> triangles{}, draws{}, bytes{}, seconds{};
    double differsOnDevice = 0, differsOccluded = 0;
};

using Row = std::array<Drawn, 3>;

void writeRow(const Crowd& crowd, uint32_t frame, const Row& row, Csv& csv, Sums& sums) {
    for (size_t way = 0; way < row.size(); ++way) {
        sums.triangles[way] += double(row[way].triangles) / kFrames;
        sums.draws[way] += double(row[way].draws) / kFrames;
        sums.bytes[way] += double(row[way].uploadBytes) / kFrames;
        sums.seconds[way] += row[way].hostSeconds / kFrames;
    }
    const size_t device = different(row[0].pixels, row[1].pixels), occluded = different(row[1].pixels, row[2].pixels);
    sums.differsOnDevice += double(device) / kFrames;
    sums.differsOccluded += double(occluded) / kFrames;
    csv.row(fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{:.1f},{:.1f}", crowd.model, frame, row[0].triangles,
                        row[1].triangles, row[2].triangles, row[0].draws, row[1].draws, row[2].draws,
                        row[0].uploadBytes, row[1].uploadBytes, row[2].uploadBytes, device, occluded,
                        1e6 * row[0].hostSeconds, 1e6 * row[1].hostSeconds));
}

/// Also stands still before it starts, so that assets are there and occlusion has seen a frame, and at its end.
Status fly(const Crowd& crowd, std::array<Studio, 3>& studios, const AssetView& asset, Csv& csv, Sums& sums) {
    constexpr uint32_t kStill = 3;
    Row before;
    for (uint32_t i = 0; i <= kFrames + kStill; ++i) {
        const uint32_t f = std::min(i < kStill ? 0 : i - kStill, kFrames - 1);
        const vulkan::Camera camera = cameraAt(crowd, asset.record->sphereRadius, f);
        SelectionDesc desc;
        desc.view = makeView(camera.eye, camera.fovY, float(kHeight));
        desc.view.nearest = camera.nearPlane;
        desc.frustum = makeFrustum(camera.worldToClip());
        desc.hysteresis = 0.05f;
        Row latest;
        for (size_t way = 0; way < studios.size(); ++way) {
            const Status status = studios[way].settle(camera, desc, latest[way]);
            if (!status.ok()) return status;
            studios[way].count(latest[way], before[way]);
        }
        if (i > kStill) writeRow(crowd, i - kStill - 1, before, csv, sums);
        before = std::move(latest);
    }
    return {};
}

void print(const Crowd& crowd, const Sums& s) {
    fmt::print("\n{} x {} of {}, means of {} frames of {} x {} at 1 pixel\n", kSide, kSide, crowd.model, kFrames,
               kWidth, kHeight);
    fmt::print("{:<28}{:>12}{:>12}{:>12}\n", "", "host", "device", "occlusion");
    const auto row = [](const char* name, const std::array<double, 3>& values) {
        fmt::print("{:<28}{:>12.0f}{:>12.0f}{:>12.0f}\n", name, values[0], values[1], values[2]);
    };
    row("triangles", s.triangles);
    row("draws", s.draws);
    row("bytes of indices uploaded", s.bytes);
    row("microseconds of the host", {1e6 * s.seconds[0], 1e6 * s.seconds[1], 1e6 * s.seconds[2]});
    fmt::print("pixels that differ: {:.2f} from the host's, {:.2f} by occlusion\n", s.differsOnDevice,
               s.differsOccluded);
}

Status run(const Crowd& crowd, const AssetView& asset, const vulkan::HeadlessDevice& device,
           const vulkan::Context& context, Csv& csv) {
    std::array<Studio, 3> studios;
    for (size_t way = 0; way < studios.size(); ++way) {
        Status status = studios[way].create(device, context, asset, Way(way));
        const float* c = asset.record->sphereCenter;
        for (uint32_t i = 0; i < kSide * kSide && status.ok(); ++i) {
            const float step = crowd.spacing * asset.record->sphereRadius;
            glm::mat4 m = glm::translate(glm::mat4(1), step * glm::vec3(i % kSide, 0, i / kSide));
            m = glm::rotate(m, 1.7f * float(i), glm::vec3(0, 1, 0));
            status = studios[way].place(makePlacement(glm::translate(m, -glm::vec3(c[0], c[1], c[2]))));
        }
        if (!status.ok()) return status;
    }
    Sums sums;
    const Status status = fly(crowd, studios, asset, csv, sums);
    if (status.ok()) print(crowd, sums);
    return status;
}

} // namespace

int benchGpu(const Flags& flags) {
    vulkan::HeadlessDevice device;
    vulkan::Context context;
    Status status = device.create({});
    if (status.ok()) status = context.create(device.contextDesc());
    Csv csv(flags, "gpu",
            "crowd,frame,triangles_host,triangles_device,triangles_occluded,draws_host,draws_device,draws_occluded,"
            "upload_host,upload_device,upload_occluded,pixels_differ_device,pixels_differ_occluded,host_us,device_us");
    for (const Crowd& crowd : kCrowds) {
        if (!status.ok() || !flags.wantsModel(crowd.model)) continue;
        OpenAsset asset;
        if (const bake::Status made = makeAsset(crowd, asset); !made.ok()) {
            fmt::print(stderr, "{}\n", made.message);
            return 1;
        }
        status = run(crowd, asset.view, device, context, csv);
    }
    if (status.ok()) return 0;
    fmt::print(stderr, "{} ({})\n", status.message, status.element);
    return 1;
}

} // namespace xgc::bench
