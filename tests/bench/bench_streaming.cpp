// Streaming beside a scene that is all in memory: bench_streaming [--csv FOLDER] [--models A,B]. Flies over a
// terrain and around a temple with budgets from a twentieth of the pages to all of them, a disk of 40 MB/s at 60 frames
// a second, and prints what was read, what was drawn, and how far that lay from the input's surface, in pixels: of the
// patches in sight, from the second second on.

#include "flags.h"

#include "meshes/baked_model.h"

#include <xgc/load.h>
#include <xgc/residency.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>

namespace {

using namespace xgc;
using namespace xgc::bench;

constexpr uint32_t kFrames = 600;
constexpr uint32_t kWarmFrames = 60;             ///< in which the first view's pages come
constexpr uint64_t kDiskBytes = 40'000'000 / 60; ///< a frame
constexpr uint32_t kLatency = 2;                 ///< frames from a request to its first byte
constexpr float kPixels = 1;

struct Baked {
    bake::AlignedBytes file;
    AssetView tables;
    std::string failure;
};

void bakeModel(bake::BundledModel which, uint32_t faces, Baked& out) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("xgc_bench_streaming_" + std::to_string(getpid()));
    fs::create_directories(folder);
    bake::BakeOptions options;
    options.input = folder / "in.glb";
    options.output = folder / "out.xgc";
    options.patchFaces = 512;
    options.pages.tiers = 8;
    options.pages.pageBytes = 32 * 1024;
    bake::BakeReport report;
    bake::Status s = bake::exportModel(bake::makeModel(which, faces), options.input);
    if (s.ok()) s = bake::bake(options, report);
    if (s.ok()) s = bake::readFile(options.output, out.file);
    out.failure = s.message;
    fs::remove_all(folder);
    if (!s.ok()) return;
    if (const Status opened = openTables(out.file.span(), out.tables); !opened.ok()) out.failure = opened.message;
}

/// A disk that gives so many bytes a frame, in order.
class Disk {
public:
    explicit Disk(std::span<const std::byte> file) : file_(file) {}
    PageReader reader() {
        return {[](void* user, const PageRequest& r) {
                    auto& disk = *static_cast<Disk*>(user);
                    disk.queue_.push_back({r, disk.frame_ + kLatency});
                },
                this};
    }
    void step(Residency& residency, uint64_t bytes) {
        ++frame_;
        credit_ = std::min(credit_ + bytes, 4 * bytes);
        while (!queue_.empty() && queue_.front().due <= frame_ && queue_.front().request.storedBytes <= credit_) {
            const PageRequest& r = queue_.front().request;
            std::copy_n(file_.data() + r.offset, r.storedBytes, r.out.data());
            credit_ -= r.storedBytes;
            residency.complete(r.ticket, true);
            queue_.pop_front();
        }
    }

private:
    struct Waiting {
        PageRequest request;
        uint64_t due;
    };
    std::span<const std::byte> file_;
    std::deque<Waiting> queue_;
    uint64_t frame_ = 0, credit_ = 0;
};

struct Camera {
    View view;
    Frustum frustum;
};

/// Low over the ground and round, at a third of the asset's radius.
Camera cameraAt(const format::AssetRecord& asset, uint32_t frame) {
    const float t = 6.2831853f * float(frame) / float(kFrames), radius = asset.sphereRadius;
    const glm::vec3 center(asset.sphereCenter[0], asset.sphereCenter[1], asset.sphereCenter[2]);
    const glm::vec3 around(std::cos(t), 0.25f, std::sin(t)), ahead(-std::sin(t), -0.1f, std::cos(t));
    const glm::vec3 eye = center + 0.45f * radius * around;
    constexpr float kFov = 1, kHeight = 1080, kAspect = 16.0f / 9;
    Camera camera{makeView(eye, kFov, kHeight), {}};
    camera.view.nearest = 0.01f * radius;
    const glm::vec3 forward = glm::normalize(ahead), right = glm::normalize(glm::cross(forward, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(right, forward);
    const float y = std::tan(kFov / 2), x = y * kAspect;
    const glm::vec3 sides[] = {x * forward + right, x * forward - right, y * forward + up, y * forward - up};
    for (const glm::vec3& n : sides) {
        const glm::vec3 unit = glm::normalize(n);
        camera.frustum.planes[camera.frustum.planeCount++] = glm::vec4(unit, -glm::dot(unit, eye));
    }
    return camera;
}

struct Flown {
    // Means of frames.
    double triangles = 0;
    double worst = 0;      ///< of the largest error
    double percentile = 0; ///< of the error that one patch in twenty is above
    double within = 0;     ///< of the share of patches that are as asked for
    ResidencyStats stats;
    uint32_t firstFrame = 0; ///< in which the asset was drawn
};

class Flight {
public:
    Flight(const Baked& baked, uint64_t budget) : baked_(baked), disk_(baked.file.span()) {
        const PageLimits limits = pageLimits(baked.tables);
        ResidencyConfig config;
        config.pageBytes = limits.bytes;
        config.pageRows = limits.rows;
        config.budgetBytes = budget;
        config.readBytes = 1 << 20;
        config.reader = disk_.reader();
        ok_ = residency_.create(config).ok() && residency_.addAsset(baked.tables, asset_).ok();
        DrawListConfig list;
        list.domainCapacity = baked.tables.record->domainCount;
        ok_ = ok_ && scene_.create(list.scene).ok() && selection_.create(list.scene).ok() && draws_.create(list).ok();
        ok_ = ok_ && cache_.create({.arenaBytes = 256u << 20, .keyBytes = 16u << 20}).ok();
    }

    bool ok() const { return ok_; }

    /// `wait`: every frame for all that it wants.
    Flown fly(bool wait) {
        Flown flown;
        while (!residency_.ready(asset_) && flown.firstFrame < 100000) {
            residency_.update();
            disk_.step(residency_, wait ? UINT64_MAX / 8 : kDiskBytes);
            ++flown.firstFrame;
        }
        uint32_t id = 0, instance = 0;
        const AssetView& view = residency_.view(asset_);
        ok_ = scene_.addAsset({&view}, id).ok() && cache_.addAsset(id, view).ok() &&
              scene_.addInstance(id, {}, instance).ok();
        for (uint32_t frame = 0; ok_ && frame < kFrames; ++frame) {
            SelectionDesc desc;
            const Camera camera = cameraAt(*baked_.tables.record, frame);
            desc.view = camera.view;
            desc.frustum = camera.frustum;
            desc.pixels = kPixels;
            do {
                residency_.want(scene_, selection_, desc);
                residency_.update();
                disk_.step(residency_, wait ? UINT64_MAX / 8 : kDiskBytes);
                selection_.update(scene_, desc);
                if (!wait) break;
            } while (residency_.stats().wantedPages > 0);
            cache_.beginFrame(staging_);
            draws_.update(scene_, selection_, cache_);
            cache_.endFrame();
            residency_.drawn(scene_, draws_);
            if (frame >= kWarmFrames) add(desc, instance, flown);
        }
        for (double* sum : {&flown.triangles, &flown.worst, &flown.percentile, &flown.within})
            *sum /= kFrames - kWarmFrames;
        flown.stats = residency_.stats();
        return flown;
    }

private:
    /// The frame's errors on screen, of what is drawn and in sight.
    void add(const SelectionDesc& desc, uint32_t instance, Flown& flown) {
        const AssetView& v = baked_.tables;
        flown.triangles += double(draws_.stats().triangles);
        if (draws_.kind(instance) != InstanceKind::mixed) return;
        const Levels levels = draws_.levels(instance);
        const std::span<const uint8_t> visible = selection_.visible(instance);
        errors_.clear();
        for (uint32_t p = 0; p < levels.size(); ++p) {
            if (!visible[p]) continue;
            const format::PatchRecord& patch = v.patches[p];
            const glm::vec3 center(patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2]);
            const float distance =
                std::max(glm::distance(center, desc.view.eye) - patch.sphereRadius, desc.view.nearest);
            errors_.push_back(v.error(p, levels[p]) * desc.view.pixelsPerUnit / distance);
        }
        if (errors_.empty()) return;
        std::sort(errors_.begin(), errors_.end());
        flown.worst += double(errors_.back());
        flown.percentile += double(errors_[errors_.size() * 19 / 20]);
        const auto above = std::upper_bound(errors_.begin(), errors_.end(), kPixels * 1.0001f);
        flown.within += double(above - errors_.begin()) / double(errors_.size());
    }

    const Baked& baked_;
    Disk disk_;
    Residency residency_;
    Scene scene_;
    Selection selection_;
    IndexCache cache_;
    DrawList draws_;
    std::vector<std::byte> staging_ = std::vector<std::byte>(16u << 20);
    std::vector<float> errors_; ///< of a frame
    uint32_t asset_ = 0;
    bool ok_ = false;
};

int flyModel(const std::string& name, bake::BundledModel which, uint32_t faces, Csv& csv) {
    Baked baked;
    bakeModel(which, faces, baked);
    if (!baked.failure.empty()) {
        fmt::print(stderr, "{}: {}\n", name, baked.failure);
        return 1;
    }
    const PageLimits limits = pageLimits(baked.tables);
    uint64_t pageBytes = 0;
    for (const format::PageRecord& page : baked.tables.pages) pageBytes += page.rawBytes;
    const uint64_t slot = uint64_t(limits.bytes) + limits.rows, slots = baked.tables.pages.size();
    fmt::print("{}: {} faces, {} pages, {:.2f} MB in pages of at most {} bytes, {:.2f} MB of tables\n", name,
               baked.tables.record->faceCount, slots, double(pageBytes) / 1e6, limits.bytes,
               double(baked.file.size - pageBytes) / 1e6);
    fmt::print("{:>9} {:>10} {:>10} {:>9} {:>9} {:>11} {:>10} {:>10} {:>8} {:>7}\n", "budget", "budget MB", "read MB",
               "installs", "evicted", "triangles", "worst px", "95% px", "within", "first");
    for (const double share : {0.05, 0.1, 0.2, 0.4, 1.1, 0.0}) {
        const bool whole = share == 0;
        const auto budget = uint64_t((whole ? 1.1 : share) * double(slots * (slot + 64)));
        Flight flight(baked, budget);
        if (!flight.ok()) {
            fmt::print("{:>9} too small for the first pages\n", share);
            continue;
        }
        const Flown f = flight.fly(whole);
        const std::string label = whole ? "resident" : fmt::format("{:.2f}", share);
        fmt::print("{:>9} {:>10.2f} {:>10.2f} {:>9} {:>9} {:>11.0f} {:>10.3f} {:>10.2f} {:>7.1f}% {:>7}\n", label,
                   double(budget) / 1e6, double(f.stats.readBytes) / 1e6, f.stats.installs, f.stats.evictions,
                   f.triangles, f.worst, f.percentile, 100 * f.within, f.firstFrame);
        csv.row(fmt::format("{},{},{},{},{},{},{:.0f},{:.4f},{:.3f},{:.4f},{}", name, label, budget, f.stats.readBytes,
                            f.stats.installs, f.stats.evictions, f.triangles, f.worst, f.percentile, f.within,
                            f.firstFrame));
    }
    return 0;
}

int fly(const Flags& flags) {
    Csv csv(flags, "streaming",
            "model,budget,budget_bytes,read_bytes,installs,evictions,triangles,worst_error_px,"
            "error_px_of_95_percent,patches_within_1px,first_frame");
    int code = 0;
    if (flags.wantsModel("terrain")) code |= flyModel("terrain", bake::BundledModel::terrain, 2'000'000, csv);
    if (flags.wantsModel("temple")) code |= flyModel("temple", bake::BundledModel::temple, 1'000'000, csv);
    return code;
}

} // namespace

int main(int argc, char** argv) {
    return runSections(argc, argv, {{"streaming", fly}});
}
