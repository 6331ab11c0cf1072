#include "image_difference.h"
#include "outside_cut.h"
#include "photographer.h"
#include "plot.h"
#include "runtime_sections.h"
#include "view_scenes.h"

#include <xgc/draw_list.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

// What levels inside a mesh are worth: along a flight at 1080p, all methods hold one pixel of error (by their own
// bounds) everywhere, without culling:
//
//   mesh    one level for each instance
//   part    one for each part of it
//   patch   one for each patch, as the runtime chooses them
//   cut     clusters of another program's DAG, by its own error at one pixel and at other thresholds (--outside)
//
// Triangles and bytes are of every frame; pictures, beside one of full detail, of every eighth.

namespace xgc::bench {
namespace {

constexpr uint32_t kWidth = 1920, kHeight = 1080;
constexpr float kFovY = 1.0f;
constexpr uint32_t kPictureEvery = 8;
/// Of the other program; the first is its own.
constexpr float kThresholds[] = {1, 0.125f, 0.25f, 0.5f, 0.7f, 1.4f, 2, 2.8f, 4};

enum Method : uint32_t { kMesh, kPart, kPatch, kMethodCount };
constexpr const char* kMethodNames[] = {"mesh", "part", "patch"};

struct FrameFigures {
    uint64_t triangles[kMethodCount] = {};
    uint64_t uploadBytes[kMethodCount] = {};
    double microseconds = 0; ///< of `patch`: selection, index building and draw list
    std::optional<ImageDifference> picture[kMethodCount];
    // The other program's, by threshold; none without it.
    std::vector<uint64_t> cutTriangles, cutBytes;
    std::vector<double> cutMicroseconds;
    std::vector<ImageDifference> cutPicture;
};

vulkan::Camera cameraOf(const ViewScene& scene, const Pose& pose) {
    vulkan::Camera camera;
    camera.eye = pose.eye;
    camera.target = pose.target;
    camera.fovY = kFovY;
    camera.aspect = float(kWidth) / float(kHeight);
    camera.nearPlane = scene.nearest;
    return camera;
}

View viewOf(const ViewScene& scene, const Pose& pose) {
    View view = makeView(pose.eye, kFovY, float(kHeight));
    view.nearest = scene.nearest;
    return view;
}

/// The runtime of one method along one flight: its levels, what it draws and what it uploads.
class Runner {
public:
    bool create(const ViewScene& scene, Method method) {
        scene_ = &scene;
        method_ = method;
        const AssetView& asset = scene.asset.view;
        const auto count = uint32_t(scene.instances.size());
        SceneConfig config;
        config.assetCapacity = 1;
        config.instanceCapacity = count;
        config.assetPatchCapacity = asset.patchCount();
        config.patchCapacity = count * asset.patchCount();
        IndexCacheConfig cache;
        cache.arenaBytes =
            uint32_t(std::min<uint64_t>(48ull * asset.record->faceCount * std::min(count, 20u), 1u << 30));
        cache.slotCapacity = std::max(cache.slotCapacity, scratchCapacity(asset));
        staging_.resize(64ull * asset.record->faceCount);
        uint32_t id = 0;
        bool ok = world_.create(config).ok() && selection_.create(config).ok() &&
                  list_.create({.scene = config}).ok() && cache_.create(cache).ok() &&
                  world_.addAsset({.asset = &asset}, id).ok() && cache_.addAsset(id, asset).ok();
        for (const Placement& placement : scene.instances) {
            uint32_t instance = 0;
            ok = ok && world_.addInstance(id, placement, instance).ok();
        }
        return ok;
    }

    void frame(const Pose& pose, FrameFigures& out) {
        const AssetView& asset = scene_->asset.view;
        const View view = viewOf(*scene_, pose);
        const auto start = std::chrono::steady_clock::now();
        if (method_ == kPatch) {
            SelectionDesc desc;
            desc.view = view;
            selection_.update(world_, desc);
        } else {
            std::vector<uint8_t> levels(asset.patchCount());
            for (uint32_t i = 0; i < scene_->instances.size(); ++i) {
                select(asset, scene_->instances[i], view, ErrorPixels{1}, levels);
                method_ == kMesh ? flatten(levels, 0, asset.patchCount()) : flattenParts(levels);
                selection_.set(world_, i, levels);
            }
        }
        cache_.beginFrame(staging_);
        list_.update(world_, selection_, cache_);
        cache_.endFrame();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        if (method_ == kPatch) out.microseconds = 1e6 * took.count();
        out.triangles[method_] = list_.stats().triangles;
        out.uploadBytes[method_] = cache_.stats().uploadBytes;
    }

    std::vector<Posed> posed() const {
        std::vector<Posed> out;
        for (uint32_t i = 0; i < scene_->instances.size(); ++i) {
            Posed one{&scene_->grey, scene_->instances[i], std::vector<uint8_t>(scene_->asset.view.patchCount())};
            if (list_.kind(i) == InstanceKind::whole) {
                world_.wholeLevels(world_.assetOf(i), list_.wholeState(i), one.levels);
            } else {
                std::copy(list_.levels(i).begin(), list_.levels(i).end(), one.levels.begin());
            }
            out.push_back(std::move(one));
        }
        return out;
    }

private:
    static void flatten(std::vector<uint8_t>& levels, uint32_t first, uint32_t count) {
        const auto begin = levels.begin() + first;
        std::fill_n(begin, count, *std::min_element(begin, begin + count));
    }
    void flattenParts(std::vector<uint8_t>& levels) const {
        for (const format::PartRecord& part : scene_->asset.view.parts) {
            if (part.patchCount > 0) flatten(levels, part.firstPatch, part.patchCount);
        }
    }

    const ViewScene* scene_ = nullptr;
    Method method_ = kMesh;
    Scene world_;
    Selection selection_;
    DrawList list_;
    IndexCache cache_;
    std::vector<std::byte> staging_;
};

std::vector<Posed> inFull(const ViewScene& scene) {
    std::vector<Posed> out;
    const std::vector<uint8_t> finest(scene.asset.view.patchCount(), 0);
    for (const Placement& placement : scene.instances) out.push_back({&scene.grey, placement, finest});
    return out;
}

class Flight {
public:
    Flight(const Flags& flags, const ViewScene& scene, Photographer* photographer)
        : flags_(flags), scene_(scene), photographer_(photographer), frames_(scene.flight.size()) {}

    /// An error message, or nothing.
    std::string run() {
        for (const Method method : {kMesh, kPart, kPatch}) {
            Runner one;
            if (!one.create(scene_, method)) return "not enough memory";
            for (size_t f = 0; f < frames_.size(); ++f) {
                one.frame(scene_.flight[f], frames_[f]);
                if (pictured(f)) posed_[method].push_back(one.posed());
            }
        }
        std::string failed = runOutside();
        if (failed.empty() && photographer_) failed = takePictures();
        return failed;
    }
    const std::vector<FrameFigures>& frames() const { return frames_; }

private:
    bool pictured(size_t frame) const { return photographer_ && frame % kPictureEvery == kPictureEvery - 1; }

    std::string runOutside() {
        if (flags_.outside.empty()) return {};
        std::vector<OutsideCamera> cameras;
        for (const Pose& pose : scene_.flight) {
            for (const float pixels : kThresholds) {
                for (const Placement& placement : scene_.instances) {
                    cameras.push_back(outsideCamera(placement, viewOf(scene_, pose), pixels));
                }
            }
        }
        const bake::Status status = runOutsideCut(flags_.outside, scene_.asset.view, cameras, cuts_);
        if (!status.ok()) return status.message;
        size_t next = 0;
        for (FrameFigures& frame : frames_) {
            for (size_t k = 0; k < std::size(kThresholds); ++k) {
                uint64_t triangles = 0, clusters = 0;
                double microseconds = 0;
                for (size_t i = 0; i < scene_.instances.size(); ++i, ++next) {
                    triangles += cuts_[next].indices.size() / 3;
                    clusters += cuts_[next].clusterCount;
                    microseconds += double(cuts_[next].microseconds);
                }
                frame.cutTriangles.push_back(triangles);
                frame.cutBytes.push_back(8 * clusters); // a cluster's and its instance's number
                frame.cutMicroseconds.push_back(microseconds);
            }
        }
        return {};
    }

    std::string takePictures() {
        const AssetView* assets[] = {&scene_.grey};
        Status status = photographer_->begin(assets, uint32_t(scene_.instances.size()));
        size_t picture = 0;
        for (size_t f = 0; f < frames_.size() && status.ok(); ++f) {
            if (!pictured(f)) continue;
            const vulkan::Camera camera = cameraOf(scene_, scene_.flight[f]);
            bake::Image truth, image;
            status = photographer_->take(inFull(scene_), camera, truth);
            for (const Method method : {kMesh, kPart, kPatch}) {
                if (status.ok()) status = photographer_->take(posed_[method][picture], camera, image);
                if (status.ok()) frames_[f].picture[method] = imageDifference(truth, image);
            }
            for (size_t k = 0; k < std::size(kThresholds) && !cuts_.empty() && status.ok(); ++k) {
                status = takeCut(f, k, camera, image);
                if (status.ok()) frames_[f].cutPicture.push_back(imageDifference(truth, image));
            }
            ++picture;
        }
        return status.ok() ? "" : status.message;
    }

    Status takeCut(size_t frame, size_t threshold, const vulkan::Camera& camera, bake::Image& image) {
        const size_t count = scene_.instances.size(), first = (frame * std::size(kThresholds) + threshold) * count;
        std::vector<std::unique_ptr<CutAsset>> assets;
        std::vector<Posed> scene;
        for (size_t i = 0; i < count; ++i) {
            assets.push_back(std::make_unique<CutAsset>(scene_.grey, cuts_[first + i].indices));
            scene.push_back({&assets.back()->view, scene_.instances[i], {0}});
        }
        std::vector<const AssetView*> views;
        for (const auto& asset : assets) views.push_back(&asset->view);
        const Status begun = photographer_->begin(views, 1);
        const Status taken = begun.ok() ? photographer_->take(scene, camera, image) : begun;
        const AssetView* own[] = {&scene_.grey};
        const Status restored = photographer_->begin(own, uint32_t(count));
        return taken.ok() ? restored : taken;
    }

    const Flags& flags_;
    const ViewScene& scene_;
    Photographer* photographer_;
    std::vector<FrameFigures> frames_;
    std::vector<std::vector<Posed>> posed_[kMethodCount]; ///< of the pictured frames
    std::vector<OutsideCut> cuts_;                        ///< frame, threshold, instance
};

/// Triangles of the other program at the error of a picture: between its thresholds on straight lines of triangles'
/// logarithm over decibels; none where it lies outside of them.
std::optional<double> trianglesAt(const FrameFigures& frame, double psnr) {
    std::vector<std::pair<double, double>> points;
    for (size_t k = 0; k < frame.cutPicture.size(); ++k) {
        points.emplace_back(frame.cutPicture[k].psnr, std::log(double(std::max<uint64_t>(frame.cutTriangles[k], 1))));
    }
    std::sort(points.begin(), points.end());
    for (size_t i = 1; i < points.size(); ++i) {
        const auto& [x0, y0] = points[i - 1];
        const auto& [x1, y1] = points[i];
        if (psnr >= x0 && psnr <= x1) return std::exp(y0 + (x1 > x0 ? (psnr - x0) / (x1 - x0) : 0) * (y1 - y0));
    }
    return {};
}

struct Sums {
    double triangles[kMethodCount] = {}, bytes[kMethodCount] = {}, cut = 0, cutBytes = 0;
    std::vector<double> psnr[kMethodCount], ssim[kMethodCount], cutPsnr, cutSsim, atEqual;
};

void print(const ViewScene& scene, const std::vector<FrameFigures>& frames) {
    Sums all, close;
    for (size_t f = 0; f < frames.size(); ++f) {
        for (Sums* sums : {&all, &close}) {
            if (sums == &close && !scene.close[f]) continue;
            for (uint32_t m = 0; m < kMethodCount; ++m) {
                sums->triangles[m] += double(frames[f].triangles[m]);
                sums->bytes[m] += double(frames[f].uploadBytes[m]);
                if (!frames[f].picture[m]) continue;
                sums->psnr[m].push_back(frames[f].picture[m]->psnr);
                sums->ssim[m].push_back(frames[f].picture[m]->ssim);
            }
            if (!frames[f].cutTriangles.empty()) {
                sums->cut += double(frames[f].cutTriangles[0]);
                sums->cutBytes += double(frames[f].cutBytes[0]);
            }
            if (frames[f].cutPicture.empty()) continue;
            sums->cutPsnr.push_back(frames[f].cutPicture[0].psnr);
            sums->cutSsim.push_back(frames[f].cutPicture[0].ssim);
            const std::optional<double> equal = trianglesAt(frames[f], frames[f].picture[kPatch]->psnr);
            if (equal) sums->atEqual.push_back(double(frames[f].triangles[kPatch]) / *equal);
        }
    }
    const double n = double(frames.size());
    for (uint32_t m = 0; m < kMethodCount; ++m) {
        fmt::print("{:<11}{:<7}{:>12.0f}{:>9.3f}{:>9.3f}{:>12.0f}{:>8.2f}{:>9.5f}\n", scene.name, kMethodNames[m],
                   all.triangles[m] / n, all.triangles[m] / all.triangles[kMesh],
                   close.triangles[kMesh] > 0 ? close.triangles[m] / close.triangles[kMesh] : 0, all.bytes[m] / n,
                   mean(all.psnr[m]), mean(all.ssim[m]));
    }
    if (all.cut == 0) return;
    fmt::print("{:<11}{:<7}{:>12.0f}{:>9.3f}{:>9.3f}{:>12.0f}{:>8.2f}{:>9.5f}\n", scene.name, "cut", all.cut / n,
               all.cut / all.triangles[kMesh], close.cut > 0 ? close.cut / close.triangles[kMesh] : 0, all.cutBytes / n,
               mean(all.cutPsnr), mean(all.cutSsim));
    std::vector<double> own, cut;
    for (const FrameFigures& frame : frames) {
        own.push_back(frame.microseconds);
        cut.push_back(frame.cutMicroseconds[0]);
    }
    fmt::print(
        "{:<11}patch over cut: {:.3f} at one pixel each, {:.3f} (median of {} pictures) at equal PSNR; {:.0f} and "
        "{:.0f} microseconds (medians)\n",
        scene.name, all.triangles[kPatch] / all.cut, all.atEqual.empty() ? 0 : median(all.atEqual), all.atEqual.size(),
        median(own), median(cut));
}

void write(const Flags& flags, const ViewScene& scene, const std::vector<FrameFigures>& frames) {
    Csv csv(flags, "view-" + scene.name,
            "frame,close,mesh,part,patch,cut,mesh_bytes,part_bytes,patch_bytes,cut_bytes,patch_us,cut_us,mesh_psnr,"
            "part_psnr,"
            "patch_psnr,cut_psnr,mesh_ssim,part_ssim,patch_ssim,cut_ssim,cut_at_equal_psnr");
    const auto number = [](const auto& values, const char* form = "{}") {
        return values.empty() ? std::string() : fmt::format(fmt::runtime(form), values.front());
    };
    for (size_t f = 0; f < frames.size(); ++f) {
        const FrameFigures& r = frames[f];
        std::string row = fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{:.1f},{}", f, int(scene.close[f]), r.triangles[kMesh], r.triangles[kPart],
            r.triangles[kPatch], number(r.cutTriangles), r.uploadBytes[kMesh], r.uploadBytes[kPart],
            r.uploadBytes[kPatch], number(r.cutBytes), r.microseconds, number(r.cutMicroseconds, "{:.1f}"));
        for (const bool similarity : {false, true}) {
            const auto of = [&](const ImageDifference& d) { return similarity ? d.ssim : d.psnr; };
            for (const auto& picture : r.picture) row += picture ? fmt::format(",{:.6g}", of(*picture)) : ",";
            row += r.cutPicture.empty() ? "," : fmt::format(",{:.6g}", of(r.cutPicture[0]));
        }
        const std::optional<double> equal =
            r.cutPicture.empty() ? std::nullopt : trianglesAt(r, r.picture[kPatch]->psnr);
        row += equal ? fmt::format(",{:.0f}", *equal) : ",";
        csv.row(row);
    }
}

void draw(const Flags& flags, const ViewScene& scene, const std::vector<FrameFigures>& frames) {
    if (flags.plots.empty()) return;
    Plot plot;
    plot.title = scene.name;
    plot.xName = "frame";
    plot.yName = "triangles";
    plot.lines = {
        {"a mesh", "#8a8f98", {}}, {"a part", "#c9705f", {}}, {"a patch", "#2f6db5", {}}, {"clusters", "#5a9a4a", {}}};
    for (const FrameFigures& frame : frames) {
        for (uint32_t m = 0; m < kMethodCount; ++m) plot.lines[m].values.push_back(double(frame.triangles[m]));
        if (!frame.cutTriangles.empty()) plot.lines[3].values.push_back(double(frame.cutTriangles[0]));
    }
    writePlot(plot, flags.plots / fmt::format("view-{}.svg", scene.name));
}

} // namespace

int benchView(const Flags& flags) {
    std::vector<std::unique_ptr<ViewScene>> scenes;
    if (const bake::Status status = viewScenes(flags, scenes); !status.ok()) {
        fmt::print(stderr, "{}\n", status.message);
        return 1;
    }
    Photographer photographer;
    const Status device = photographer.create(kWidth, kHeight);
    if (!device.ok()) fmt::print("SKIPPED: pictures ({})\n", device.message);
    if (flags.outside.empty()) fmt::print("SKIPPED: another program's cut (no --outside)\n");
    fmt::print("{:<11}{:<7}{:>12}{:>9}{:>9}{:>12}{:>8}{:>9}\n", "scene", "level a", "triangles", "/ mesh", "close",
               "bytes", "PSNR", "SSIM");
    for (const auto& scene : scenes) {
        Flight flight(flags, *scene, device.ok() ? &photographer : nullptr);
        if (const std::string failed = flight.run(); !failed.empty()) {
            fmt::print(stderr, "{}: {}\n", scene->name, failed);
            return 1;
        }
        print(*scene, flight.frames());
        write(flags, *scene, flight.frames());
        draw(flags, *scene, flight.frames());
    }
    return 0;
}

} // namespace xgc::bench
