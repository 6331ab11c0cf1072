#include "verdicts.h"

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {
namespace {

void judgeInput(const BakeOptions& options, BakeReport& report) {
    const WeldReport& weld = report.weld;
    const auto warn = [&](uint32_t count, const char* what, const char* remedy) {
        if (count > 0) {
            report.verdicts.push_back({Severity::warning, fmt::format("{} {}", count, what), "input", remedy});
        }
    };
    const auto note = [&](uint32_t count, const char* what, const char* remedy) {
        if (count > 0) report.verdicts.push_back({Severity::note, fmt::format("{} {}", count, what), "input", remedy});
    };
    note(weld.repeatedPositionFaces, "faces with a repeated position dropped", "none needed");
    note(weld.duplicateFaces, "duplicate faces dropped", "none needed");
    note(weld.backToBackPairs, "back-to-back face pairs kept", "use a double-sided material instead");
    note(weld.zeroAreaFaces, "faces without area kept", "remove them in the modelling tool");
    const bool locks = options.preset == Preset::thesis;
    warn(weld.nonManifoldEdges,
         locks ? "edges with more than two faces: locked, they hold detail up"
               : "edges with more than two faces: they coarsen along themselves only",
         "separate the sheets that meet there");
    warn(weld.inconsistentEdges,
         locks ? "edges whose faces wind differently: locked, they hold detail up"
               : "edges whose faces wind differently: they hold detail up",
         "make the winding consistent");
    if (locks) note(weld.borderEdges, "border edges: locked by the thesis preset", "close holes that nobody sees into");
}

void judgeSegmentation(BakeReport& report) {
    if (report.segment.noisy) {
        report.verdicts.push_back(
            {Severity::note,
             fmt::format("noisy surface: {} smoothing rounds for the segmentation", report.segment.smoothingRounds),
             "segment", "none needed: positions are unchanged"});
    }
    if (report.segment.noisyAfterSmoothing) {
        report.verdicts.push_back({Severity::warning, "still noisy after the last smoothing round", "segment",
                                   "look at the parts; give labels with --parts FILE.seg if they are not sensible"});
    }
}

/// Positions with several wedges are seams, which coarsen along themselves only, or not at all (thesis).
void judgeSeams(const BakeOptions& options, BakeReport& report) {
    const double split = double(report.vertices) / std::max(1u, report.positions) - 1;
    if (split < 0.5) return;
    report.verdicts.push_back(
        {Severity::warning,
         fmt::format("{:.1f} vertices a position: normals or UVs are split nearly everywhere, and seams {}", 1 + split,
                     options.preset == Preset::thesis ? "are locked" : "coarsen along themselves only"),
         "weld", "bake with --normals smooth if the normals are flat by accident"});
}

/// Says what holds an asset up that does not become small.
void judgeFloor(const BakeOptions& options, BakeReport& report) {
    if (report.levels.size() < 2 || report.faces == 0) {
        report.verdicts.push_back({Severity::warning, "no vertex may collapse: the asset has one level", "build",
                                   "every vertex lies on a boundary, seam or crease; use fewer parts"});
        return;
    }
    const double left = 100.0 * report.levels.back().faces / report.faces;
    if (options.preset == Preset::thesis) {
        if (left <= 50) return;
        report.verdicts.push_back({Severity::warning,
                                   fmt::format("{:.1f} % of the faces stay at the coarsest level", left), "build",
                                   "boundaries of parts, seams and sharp features are locked; use fewer parts"});
    }
}

} // namespace

void judge(const BakeOptions& options, BakeReport& report) {
    judgeInput(options, report);
    judgeSeams(options, report);
    judgeSegmentation(report);
    judgeFloor(options, report);
}

} // namespace xgc::bake
