#include "changed_surface.h"
#include "perceptual_run.h"
#include "segment_sections.h"
#include "subjects.h"

#include <xgc/bake/segmentation_metrics.h>

#include <functional>

namespace xgc::bench {
namespace {

/// One way to change a surface, and how the parts came out.
struct Change {
    std::string name;
    double target; ///< mean Rand index error below which parts count as stable
    std::function<ChangedSurface(const Surface&, uint32_t seed)> apply;
    std::vector<double> errors, parts;
    double worst = -1;
    std::string worstModel;
};

std::vector<Change> changes() {
    const auto of = [](const auto& change, auto... arguments) {
        return [=](const Surface& s, uint32_t) { return change(s, arguments...); };
    };
    const auto noise = [](double share) {
        return [share](const Surface& s, uint32_t seed) { return noisy(s, share, seed); };
    };
    return {{"scaled by 1024", 0, of(scaled, 1024.0f), {}, {}, -1, {}},
            {"moved and scaled", 0.003, of(movedAndScaled), {}, {}, -1, {}},
            {"rotated and shuffled", 0.01, rotatedAndShuffled, {}, {}, -1, {}},
            {"decimated to 50 %", 0.035, of(decimated, 0.5), {}, {}, -1, {}},
            {"decimated to 25 %", 0.035, of(decimated, 0.25), {}, {}, -1, {}},
            {"subdivided by 4", 0.03, of(subdivided, 1), {}, {}, -1, {}},
            {"subdivided by 16", 0.03, of(subdivided, 2), {}, {}, -1, {}},
            {"noise of .1 %", 0.025, noise(0.001), {}, {}, -1, {}},
            {"noise of .2 %", 0.035, noise(0.002), {}, {}, -1, {}}};
}

/// Over the faces of the changed mesh: its own labels beside those of the faces that they come from.
double errorOf(const ChangedSurface& changed, const PerceptualRun& run, std::span<const uint32_t> originalLabels) {
    const std::vector<uint32_t> own = bake::inputLabels(run.mesh, run.parts);
    std::vector<uint32_t> original;
    for (const uint32_t f : changed.from) original.push_back(originalLabels[f]);
    const bake::MetricSurface surface = bake::prepareSurface(run.mesh, run.topology);
    return bake::compareLabels(surface, bake::prepareLabels(surface, own), bake::prepareLabels(surface, original))
        .randIndex;
}

/// Every fifth model of the benchmark.
std::vector<Source> sample(const Flags& flags) {
    std::vector<Source> sources;
    const std::vector<Source> all = princetonAll(flags.data);
    for (size_t i = 0; i < all.size(); i += 5) {
        sources.push_back(all[i]);
        sources.back().plain = true;
    }
    return sources;
}

bool tryChange(const Flags& flags, const Subject& subject, const Surface& surface, std::span<const uint32_t> labels,
               Change& change) {
    const auto seed = uint32_t(change.errors.size() + 1);
    const ChangedSurface changed = change.apply(surface, seed);
    PerceptualRun run;
    if (const bake::Status s = segmentOnce(bareModel(changed.surface), 0, run); !s.ok()) {
        fmt::print("{} {}: FAILED: {}\n", subject.name, change.name, s.message);
        return false;
    }
    const double error = errorOf(changed, run, labels);
    change.errors.push_back(error);
    change.parts.push_back(double(run.parts.partCount()));
    if (error > change.worst) {
        change.worst = error;
        change.worstModel = subject.name;
    }
    if (flags.each)
        fmt::print("{:<8} {:<21} {:>8} faces {:>4} parts  {:.4f}\n", subject.name, change.name, run.mesh.faceCount(),
                   run.parts.partCount(), error);
    return true;
}

} // namespace

int sweepStability(const Flags& flags) {
    if (flags.data.empty()) return 0;
    std::vector<Change> all = changes();
    std::vector<double> parts;
    bool failed = false;
    const int loaded = forSubjects(flags, sample(flags), [&](const Subject& subject) {
        const Surface surface = surfaceOf(subject.mesh);
        const PerceptualRun run = segmentOnce(subject.mesh, 0);
        parts.push_back(double(run.parts.partCount()));
        for (Change& change : all) failed |= !tryChange(flags, subject, surface, run.parts.facePart, change);
    });
    if (loaded != 0) return loaded;
    fmt::print("Rand index error against the parts of the original, {} models, {:.2f} parts in the mean:\n",
               parts.size(), mean(parts));
    fmt::print("{:<21} {:>7} {:>7} {:>7} {:>7} {:<8} {:>6}\n", "", "target", "mean", "median", "worst", "", "parts");
    for (const Change& c : all) {
        fmt::print("{:<21} {:>7.4f} {:>7.4f} {:>7.4f} {:>7.4f} {:<8} {:>6.2f}{}\n", c.name, c.target, mean(c.errors),
                   median(c.errors), c.worst, c.worstModel, mean(c.parts), mean(c.errors) > c.target ? "  above" : "");
    }
    return failed ? 1 : 0;
}

} // namespace xgc::bench
