#include "outside_cut.h"
#include "runtime_sections.h"
#include "sampled_distance.h"
#include "view_scenes.h"

#include <xgc/selection.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

// One instance far away, where it is drawn as a whole: how many triangles that takes beside the cut of another
// program's cluster hierarchy (--outside) whose surface deviates as much, as sampled both ways. Its thresholds lie a
// quarter of an octave apart; between two of them the triangles go straight over the logarithms of both.

namespace xgc::bench {
namespace {

constexpr float kHeights[] = {400, 200, 100, 50, 25}; ///< of the model's bounds, pixels
constexpr float kViewport = 1080;
constexpr uint32_t kSamples = 40'000;

std::vector<float> thresholds() {
    std::vector<float> out;
    for (int i = -16; i <= 12; ++i) out.push_back(std::exp2(float(i) / 4));
    return out;
}

Surface surfaceOf(const AssetView& asset, const std::vector<uint32_t>& indices) {
    Surface out;
    out.points.assign(asset.positions.begin(), asset.positions.end());
    for (size_t i = 0; i + 2 < indices.size(); i += 3) {
        out.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    }
    return out;
}

std::vector<uint32_t> indicesAt(const AssetView& asset, Levels levels) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), all, own;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        own.resize(indexCapacity(asset, p, levels));
        own.resize(buildIndices(asset, p, levels, scratch, own));
        all.insert(all.end(), own.begin(), own.end());
    }
    return all;
}

/// The model seen so high.
View viewAt(const AssetView& asset, float height) {
    const float* c = asset.record->sphereCenter;
    const float radius = asset.record->sphereRadius;
    View view = makeView({}, 1, kViewport);
    const float away = 2 * radius * view.pixelsPerUnit / height;
    view.eye = glm::vec3(c[0], c[1], c[2]) + away * glm::normalize(glm::vec3(0.5f, 0.4f, 1));
    return view;
}

/// The levels that the runtime chooses at one pixel.
bool chosen(const AssetView& asset, const View& view, std::vector<uint8_t>& levels) {
    const SceneConfig config{.assetCapacity = 1,
                             .instanceCapacity = 1,
                             .assetPatchCapacity = asset.patchCount(),
                             .patchCapacity = asset.patchCount()};
    Scene scene;
    Selection selection;
    uint32_t id = 0, instance = 0;
    if (!scene.create(config).ok() || !selection.create(config).ok()) return false;
    if (!scene.addAsset({.asset = &asset}, id).ok() || !scene.addInstance(id, {}, instance).ok()) return false;
    SelectionDesc desc;
    desc.view = view;
    selection.update(scene, desc);
    levels.resize(asset.patchCount());
    if (selection.kind(instance) == InstanceKind::whole) {
        scene.wholeLevels(id, selection.wholeState(instance), levels);
    } else {
        levels.assign(selection.levels(instance).begin(), selection.levels(instance).end());
    }
    return true;
}

struct Point {
    double triangles, error;
};

/// Triangles at which the points reach the error; none where they do not.
std::optional<double> trianglesAt(std::vector<Point> points, double error) {
    std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.error < b.error; });
    for (size_t i = 1; i < points.size(); ++i) {
        const Point &a = points[i - 1], &b = points[i];
        if (error < a.error || error > b.error || a.error <= 0) continue;
        const double t = b.error > a.error ? std::log(error / a.error) / std::log(b.error / a.error) : 0;
        return std::exp(std::log(a.triangles) + t * (std::log(b.triangles) - std::log(a.triangles)));
    }
    return {};
}

int benchModel(const ViewScene& scene, const Flags& flags, Csv& csv) {
    const AssetView& asset = scene.asset.view;
    const std::vector<float> pixels = thresholds();
    std::vector<OutsideCut> cuts;
    if (!flags.outside.empty()) {
        std::vector<OutsideCamera> cameras;
        for (const float height : kHeights) {
            for (const float p : pixels) cameras.push_back(outsideCamera({}, viewAt(asset, height), p));
        }
        if (const bake::Status run = runOutsideCut(flags.outside, asset, cameras, cuts); !run.ok()) {
            fmt::print(stderr, "{}\n", run.message);
            return 1;
        }
    }
    const std::vector<uint8_t> finest(asset.patchCount(), 0);
    const DistanceReference reference(surfaceOf(asset, indicesAt(asset, finest)), kSamples);
    for (size_t h = 0; h < std::size(kHeights); ++h) {
        std::vector<uint8_t> levels;
        if (!chosen(asset, viewAt(asset, kHeights[h]), levels)) return 1;
        const std::vector<uint32_t> own = indicesAt(asset, levels);
        const double error = reference.compare(surfaceOf(asset, own)).rms();
        std::vector<Point> points;
        for (size_t k = 0; k < pixels.size() && !cuts.empty(); ++k) {
            const std::vector<uint32_t>& indices = cuts[h * pixels.size() + k].indices;
            if (indices.empty()) continue;
            points.push_back({double(indices.size() / 3), reference.compare(surfaceOf(asset, indices)).rms()});
        }
        const std::optional<double> cut = trianglesAt(points, error);
        const std::string equal = cut ? fmt::format("{:.0f}", *cut) : "";
        const std::string ratio = cut ? fmt::format("{:.2f}", double(own.size() / 3) / *cut) : "";
        fmt::print("{:<12}{:>8.0f}{:>12}{:>14.5f}{:>12}{:>8}\n", scene.name, double(kHeights[h]), own.size() / 3,
                   100 * error / reference.diagonal(), equal, ratio);
        csv.row(fmt::format("{},{},{},{:.6f},{},{}", scene.name, kHeights[h], own.size() / 3,
                            100 * error / reference.diagonal(), equal, ratio));
    }
    return 0;
}

} // namespace

int benchFar(const Flags& flags) {
    std::vector<std::unique_ptr<ViewScene>> scenes;
    if (const bake::Status made = viewScenes(flags, scenes); !made.ok()) {
        fmt::print(stderr, "{}\n", made.message);
        return 1;
    }
    if (flags.outside.empty()) fmt::print("SKIPPED: another program's cut (no --outside)\n");
    fmt::print("{:<12}{:>8}{:>12}{:>14}{:>12}{:>8}\n", "", "pixels", "triangles", "RMS, % diag.", "clusters", "ratio");
    Csv csv(flags, "far", "model,pixels,triangles,rms_percent_of_diagonal,triangles_cut_equal_rms,ratio");
    for (const auto& scene : scenes) {
        if (const int failed = benchModel(*scene, flags, csv); failed != 0) return failed;
    }
    return 0;
}

} // namespace xgc::bench
