#include "asset.h"
#include "sections.h"

#include <xgc/indices.h>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <random>

namespace xgc::bench {
namespace {

/// Seconds of the fastest of some runs.
double fastest(const std::function<void()>& work) {
    double best = 1e9;
    for (int run = 0; run < 9; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

// ACMR: misses of a FIFO of 16 a triangle, the patches one after the other. Best: meshopt_optimizeVertexCache on the
// same triangles, of all patches at once and of each patch on its own.

/// Patches are built into one buffer one after the other, as a frame does it into staging.
class Lists {
public:
    explicit Lists(const AssetView& asset)
        : asset_(asset), scratch_(scratchCapacity(asset)), out_(3 * size_t(asset.record->faceCount)),
          copy_(out_.size()), ends_(asset.patchCount()) {}

    std::span<const uint32_t> build(Levels levels) {
        size_t used = 0;
        for (uint32_t p = 0; p < asset_.patchCount(); ++p) {
            used += buildIndices(asset_, p, levels, scratch_, std::span(out_).subspan(used));
            ends_[p] = used;
        }
        return std::span(out_).first(used);
    }
    /// What was built, each patch ordered for the cache on its own.
    std::vector<uint32_t> optimizedByPatch() const {
        std::vector<uint32_t> best(ends_.back());
        size_t first = 0;
        for (const size_t end : ends_) {
            if (end > first)
                meshopt_optimizeVertexCache(best.data() + first, out_.data() + first, end - first,
                                            asset_.positions.size());
            first = end;
        }
        return best;
    }
    double copySeconds(size_t count) {
        return fastest([&] { std::memcpy(copy_.data(), out_.data(), count * sizeof(uint32_t)); });
    }

private:
    const AssetView& asset_;
    std::vector<uint32_t> scratch_, out_, copy_;
    std::vector<size_t> ends_; ///< of each patch in out_
};

struct Figures {
    double triangles = 0, acmr = 0, bestAcmr = 0, bestByPatch = 0, overfetch = 0;
    double buildSeconds = 0, copySeconds = 0;
};

/// Misses of a FIFO of 16 a triangle.
double acmrOf(std::span<const uint32_t> indices, size_t vertices) {
    return double(meshopt_analyzeVertexCache(indices.data(), indices.size(), vertices, 16, 0, 0).acmr);
}

Figures measure(const AssetView& asset, Lists& lists, Levels levels) {
    const std::span<const uint32_t> list = lists.build(levels);
    const size_t vertices = asset.positions.size();
    Figures f;
    f.triangles = double(list.size()) / 3;
    std::vector<uint32_t> best(list.size());
    meshopt_optimizeVertexCache(best.data(), list.data(), list.size(), vertices);
    f.acmr = acmrOf(list, vertices);
    f.bestAcmr = acmrOf(best, vertices);
    f.bestByPatch = acmrOf(lists.optimizedByPatch(), vertices);
    f.overfetch = double(meshopt_analyzeVertexFetch(list.data(), list.size(), vertices, sizeof(glm::vec3)).overfetch);
    f.buildSeconds = fastest([&] { lists.build(levels); });
    f.copySeconds = lists.copySeconds(list.size());
    return f;
}

void print(const std::string& state, const Figures& f) {
    fmt::print("{:>8} {:>10.0f} {:>7.3f} {:>7.3f} {:>6.2f} {:>9.3f} {:>6.2f} {:>10.2f} {:>8.1f} {:>8.1f} {:>6.2f}\n",
               state, f.triangles, f.acmr, f.bestAcmr, f.acmr / f.bestAcmr, f.bestByPatch, f.acmr / f.bestByPatch,
               f.overfetch, f.triangles / f.buildSeconds * 1e-6, f.triangles / f.copySeconds * 1e-6,
               f.copySeconds / f.buildSeconds);
}

void measureAll(const std::string& name, const AssetView& asset, Csv& csv) {
    fmt::print("\n{}: {} faces, {} patches\n", name, asset.record->faceCount, asset.patchCount());
    fmt::print("   level  triangles    ACMR    best  ratio  by patch  ratio  overfetch   Mtri/s   memcpy  ratio\n");
    Lists lists(asset);
    std::vector<uint8_t> levels(asset.patchCount());
    std::vector<double> ratios, ratiosByPatch;
    double worstOverfetch = 0, speedRatio = 0;
    const auto record = [&](const std::string& state) {
        const Figures f = measure(asset, lists, levels);
        print(state, f);
        csv.row(fmt::format("{},{},{:.0f},{:.4f},{:.4f},{:.4f},{:.4f},{:.2f},{:.2f}", name, state, f.triangles, f.acmr,
                            f.bestAcmr, f.bestByPatch, f.overfetch, f.triangles / f.buildSeconds * 1e-6,
                            f.triangles / f.copySeconds * 1e-6));
        return f;
    };
    for (uint32_t level = 0; level < asset.levelCount(); ++level) {
        std::ranges::fill(levels, uint8_t(level));
        const Figures f = record(std::to_string(level));
        if (f.triangles == 0) continue;
        ratios.push_back(f.acmr / f.bestAcmr);
        ratiosByPatch.push_back(f.acmr / f.bestByPatch);
        if (f.triangles >= 0.05 * asset.record->faceCount) worstOverfetch = std::max(worstOverfetch, f.overfetch);
        if (level == 0) speedRatio = f.copySeconds / f.buildSeconds;
    }
    std::minstd_rand random(1);
    for (uint8_t& l : levels) l = uint8_t(random() % asset.levelCount());
    record("random");
    fmt::print("ACMR over the best: {:.2f} in the mean, {:.2f} at worst (within patches: {:.2f}, {:.2f}); overfetch "
               "down to 5 % of the faces: {:.2f} at worst; speed at level 0: {:.2f} of memcpy's\n",
               mean(ratios), std::ranges::max(ratios), mean(ratiosByPatch), std::ranges::max(ratiosByPatch),
               worstOverfetch, speedRatio);
}

} // namespace

int benchIndices(const Flags& flags) {
    Csv csv(flags, "indices",
            "model,level,triangles,acmr,best_acmr,best_acmr_by_patch,overfetch,"
            "million_triangles_a_second,memcpy_million_triangles_a_second");
    std::vector<Source> sources{{"terrain4M", {}, 4'000'000, true}};
    for (const Source& s : dragon()) sources.push_back({s.name, s.file, 0, true});
    if (!flags.data.empty()) {
        sources.push_back({"psb304", flags.data / "psb/off/304.off"});
        sources.push_back(helmet(flags.data));
    }
    for (const Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        Subject subject;
        OpenAsset asset;
        bake::Status status = load(source, subject);
        if (status.ok()) status = layOut(subject, subject.parts, build(subject, subject.parts), asset);
        if (!status.ok()) {
            fmt::print(stderr, "{}\n", status.message);
            return int(status.outcome);
        }
        measureAll(source.name, asset.view, csv);
    }
    return 0;
}

} // namespace xgc::bench
