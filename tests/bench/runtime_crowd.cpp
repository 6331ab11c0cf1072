#include "asset.h"
#include "runtime_sections.h"

#include <xgc/bake/models.h>
#include <xgc/draw_list.h>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>

// A hundred by a hundred creatures on a plain; the camera flies between them, turns, rises and comes down again. All
// that a frame does on the CPU is timed by stage: selection, draw list and index building (with what the index cache
// writes), and beside them a pass that reads what selection of the near instances reads, and does nothing with it.

namespace xgc::bench {
namespace {

constexpr uint32_t kSide = 100, kFrames = 400;
constexpr float kSpacing = 3; ///< radii
constexpr uint32_t kPatches = 200;

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
}

/// The creature in about kPatches patches.
bake::Status makeAsset(OpenAsset& out) {
    Subject subject;
    const bake::Status loaded = load({"creature", {}, 60'000}, subject);
    if (!loaded.ok()) return loaded;
    const uint32_t patchFaces = uint32_t(subject.mesh.faceCount()) / (kPatches * 4 / 5);
    const bake::Hierarchy hierarchy = build(subject, subject.parts, {}, patchFaces);
    return layOut(subject, subject.parts, hierarchy, measureErrors(subject, hierarchy), out);
}

struct Stages {
    double select = 0, draw = 0, plain = 0;
    uint64_t considered = 0, visible = 0, whole = 0, triangles = 0, uploadBytes = 0, draws = 0;
};

class Crowd {
public:
    bool create(const AssetView& asset) {
        asset_ = &asset;
        SceneConfig config;
        config.assetCapacity = 1;
        config.instanceCapacity = kSide * kSide;
        config.assetPatchCapacity = asset.patchCount();
        config.patchCapacity = kSide * kSide * asset.patchCount();
        IndexCacheConfig cache;
        cache.arenaBytes = 512u << 20;
        cache.rangeCapacity = 1u << 18;
        cache.keyBytes = 32u << 20;
        staging_.resize(64u << 20);
        uint32_t id = 0;
        const bool created = scene_.create(config).ok() && selection_.create(config).ok() &&
                             list_.create({.scene = config}).ok() && cache_.create(cache).ok() &&
                             scene_.addAsset({.asset = &asset}, id).ok() && cache_.addAsset(id, asset).ok();
        if (!created) return false;
        radius_ = asset.record->sphereRadius;
        const float* c = asset.record->sphereCenter;
        for (uint32_t i = 0; i < kSide * kSide; ++i) {
            const glm::vec3 place(kSpacing * radius_ * float(i % kSide), 0, kSpacing * radius_ * float(i / kSide));
            glm::mat4 m = glm::translate(glm::mat4(1), place);
            m = glm::rotate(m, float(i), glm::vec3(0, 1, 0));
            m = glm::translate(m, -glm::vec3(c[0], c[1], c[2]));
            uint32_t instance = 0;
            if (!scene_.addInstance(id, makePlacement(m), instance).ok()) return false;
        }
        return true;
    }

    SelectionDesc at(uint32_t frame) const {
        const float t = float(frame) / float(kFrames - 1), side = kSpacing * radius_ * float(kSide);
        const glm::vec3 eye(side * (0.1f + 0.8f * t), radius_ * (1.2f + 12 * std::max(0.0f, std::sin(9 * t))),
                            side * (0.5f + 0.2f * std::sin(4 * t)));
        const glm::vec3 towards(std::cos(3 * t), -0.15f, std::sin(3 * t));
        SelectionDesc desc;
        desc.view = makeView(eye, 1, 1080);
        desc.view.nearest = 0.05f * radius_;
        desc.frustum = makeFrustum(glm::perspectiveRH_ZO(1.0f, 16.0f / 9, desc.view.nearest, 1e4f * radius_) *
                                   glm::lookAt(eye, eye + towards, glm::vec3(0, 1, 0)));
        desc.hysteresis = 0.05f;
        desc.cullBackfaces = true;
        desc.pixels = 1;
        return desc;
    }

    void frame(uint32_t number, bool wholes, Stages& out) {
        SelectionDesc desc = at(number);
        if (!wholes) desc.wholeBeyond = std::numeric_limits<float>::infinity();
        const Clock::time_point start = Clock::now();
        selection_.update(scene_, desc);
        out.select = seconds(start);
        const Clock::time_point drawing = Clock::now();
        if (wholes || number % 20 == 0) { // a tenth of a second where each patch is on its own
            cache_.beginFrame(staging_);
            list_.update(scene_, selection_, cache_);
            cache_.endFrame();
            out.draw = seconds(drawing);
        }
        const Clock::time_point reading = Clock::now();
        sink_ = sink_ + plainPass();
        out.plain = seconds(reading);
        out.considered = selection_.stats().consideredPatches;
        out.visible = selection_.stats().visibleInstances;
        out.whole = selection_.stats().wholeInstances;
        out.triangles = list_.stats().triangles;
        out.draws = list_.draws().size();
        out.uploadBytes = cache_.stats().uploadBytes;
    }

private:
    /// Reads every instance, and of the mixed ones each patch's sphere, cone, level and the errors beside it.
    float plainPass() const {
        float sum = 0;
        for (uint32_t id = 0; id < scene_.instanceEnd(); ++id) {
            sum += scene_.placement(id).toWorld[3].x;
            if (selection_.kind(id) != InstanceKind::mixed) continue;
            const Levels levels = selection_.levels(id);
            const std::span<const uint8_t> visible = selection_.visible(id);
            for (uint32_t p = 0; p < asset_->patchCount(); ++p) {
                const format::PatchRecord& patch = asset_->patches[p];
                const uint32_t next = std::min<uint32_t>(levels[p] + 1, asset_->levelCount() - 1);
                sum += patch.sphereCenter[0] + patch.sphereCenter[1] + patch.sphereCenter[2] + patch.sphereRadius +
                       patch.coneAxis[0] + patch.coneAxis[1] + patch.coneAxis[2] + patch.coneCosine +
                       asset_->error(p, levels[p]) + asset_->error(p, next) + float(visible[p]);
            }
        }
        return sum;
    }

    const AssetView* asset_ = nullptr;
    Scene scene_;
    Selection selection_;
    DrawList list_;
    IndexCache cache_;
    std::vector<std::byte> staging_;
    float radius_ = 1;
    volatile float sink_ = 0;
};

double medianOf(const std::vector<Stages>& frames, double Stages::*stage) {
    std::vector<double> values;
    for (const Stages& f : frames) {
        if (f.*stage > 0) values.push_back(f.*stage); // was run in this frame
    }
    return median(values);
}

double worstOf(const std::vector<Stages>& frames, double Stages::*stage) {
    double worst = 0;
    for (const Stages& f : frames) worst = std::max(worst, f.*stage);
    return worst;
}

double meanOf(const std::vector<Stages>& frames, uint64_t Stages::*count) {
    double sum = 0;
    for (const Stages& f : frames) sum += double(f.*count);
    return sum / double(frames.size());
}

/// The flight, each frame at the medians of some runs. Uploads are the first run's, which starts with nothing.
std::vector<Stages> fly(const AssetView& asset, bool wholes, uint32_t runCount) {
    std::vector<std::vector<Stages>> runs(runCount);
    for (std::vector<Stages>& run : runs) {
        Crowd crowd;
        if (!crowd.create(asset)) return {};
        for (uint32_t f = 0; f < kFrames; ++f) crowd.frame(f, wholes, run.emplace_back());
    }
    std::vector<Stages> frames = runs.front();
    for (size_t f = 0; f < frames.size(); ++f) {
        for (double Stages::*stage : {&Stages::select, &Stages::draw, &Stages::plain}) {
            std::vector<double> values;
            for (const std::vector<Stages>& run : runs) values.push_back(run[f].*stage);
            frames[f].*stage = median(values);
        }
    }
    return frames;
}

void print(const std::vector<Stages>& frames) {
    fmt::print("mean: {:.0f} instances in sight, {:.0f} whole, {:.0f} patches considered, {:.0f} triangles, {:.0f} "
               "draws, {:.0f} bytes uploaded\n",
               meanOf(frames, &Stages::visible), meanOf(frames, &Stages::whole), meanOf(frames, &Stages::considered),
               meanOf(frames, &Stages::triangles), meanOf(frames, &Stages::draws),
               meanOf(frames, &Stages::uploadBytes));
    fmt::print("{:<26}{:>12}{:>12}\n", "microseconds a frame", "median", "worst");
    const auto row = [&](const char* name, double Stages::*stage) {
        fmt::print("{:<26}{:>12.0f}{:>12.0f}\n", name, 1e6 * medianOf(frames, stage), 1e6 * worstOf(frames, stage));
    };
    row("selection", &Stages::select);
    row("draw list and indices", &Stages::draw);
    row("reading the same records", &Stages::plain);
}

} // namespace

int benchCrowd(const Flags& flags) {
    OpenAsset asset;
    if (const bake::Status made = makeAsset(asset); !made.ok()) {
        fmt::print(stderr, "{}\n", made.message);
        return 1;
    }
    const double patches = double(kSide) * kSide * asset.view.patchCount();
    fmt::print("{} instances of {} patches, {} levels, at 1080p and 1 pixel\n", kSide * kSide, asset.view.patchCount(),
               asset.view.levelCount());

    const std::vector<Stages> frames = fly(asset.view, true, flags.runs);
    if (frames.empty()) return 1;
    fmt::print("\nAs it is, {} frames\n", frames.size());
    print(frames);
    fmt::print("selection: {:.2f} ns a patch of the scene, {:.0f} ns an instance\n",
               1e9 * medianOf(frames, &Stages::select) / patches,
               1e9 * medianOf(frames, &Stages::select) / (kSide * kSide));

    const std::vector<Stages> each = fly(asset.view, false, flags.runs);
    if (each.empty()) return 1;
    std::vector<double> perPatch, ratio;
    for (const Stages& f : each) {
        perPatch.push_back(1e9 * f.select / double(f.considered));
        ratio.push_back(f.select / f.plain);
    }
    fmt::print("\nEach patch on its own (no instance as a whole), {} frames\n", each.size());
    print(each);
    fmt::print("selection: {:.1f} ns a patch considered, {:.2f} times the reading pass\n", median(perPatch),
               median(ratio));

    Csv csv(flags, "crowd", "frame,select_us,draw_us,read_us,visible,whole,considered,triangles,draws,upload_bytes");
    for (uint32_t f = 0; f < frames.size(); f += 10) {
        const Stages& s = frames[f];
        csv.row(fmt::format("{},{:.1f},{:.1f},{:.1f},{},{},{},{},{},{}", f, 1e6 * s.select, 1e6 * s.draw, 1e6 * s.plain,
                            s.visible, s.whole, s.considered, s.triangles, s.draws, s.uploadBytes));
    }
    return 0;
}

} // namespace xgc::bench
