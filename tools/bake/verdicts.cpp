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

/// A few dozen triangles: what any asset should be able to fall to.
constexpr uint32_t kSmallFloor = 64;
/// Faces that a part keeps for one reason before it is named.
constexpr uint32_t kManyFaces = 32;
constexpr uint32_t kNamedParts = 4;

bool isSmall(const BakeOptions& options, const BakeReport& report) {
    return options.preset == Preset::standard && report.floor.faces <= kSmallFloor;
}

/// Positions with several wedges are seams, which coarsen along themselves only, or not at all (thesis).
void judgeSeams(const BakeOptions& options, BakeReport& report) {
    const double split = double(report.vertices) / std::max(1u, report.positions) - 1;
    if (split < 0.5 || isSmall(options, report)) return;
    const bool locks = options.preset == Preset::thesis;
    if (!locks && 2 * report.floor.held[size_t(Hold::seam)] < report.floor.faces) return;
    report.verdicts.push_back(
        {Severity::warning,
         fmt::format("{:.1f} vertices a position: normals or UVs are split nearly everywhere, and seams {}", 1 + split,
                     locks ? "are locked" : "coarsen along themselves only"),
         "weld", "bake with --normals smooth if the normals are flat by accident"});
}

struct HoldText {
    const char* what;
    const char* remedy;
};

HoldText textOf(Hold hold) {
    switch (hold) {
    case Hold::locked:
        return {"locked vertices", "unlock what need not stay at any distance"};
    case Hold::nonManifold:
        return {"edges of more than two faces", "separate the sheets that meet there"};
    case Hold::piece:
        return {"loose pieces, too large or too far from others to vanish", "join them to what they belong to"};
    case Hold::handle:
        return {"handles and holes", "close those that nobody sees through"};
    case Hold::seam:
        return {"seams of normals, UVs or colours", "use fewer and larger UV charts, or --normals smooth"};
    case Hold::boundary:
        return {"boundaries of parts or patches", "use fewer parts (--parts), or larger patches (--patch-faces)"};
    case Hold::fold:
        return {"faces that would turn over", "look for thin or folded sheets there"};
    case Hold::error:
        break;
    }
    return {"its shape", "allow more levels (--levels)"};
}

Severity severityOf(Hold hold) {
    return hold == Hold::locked || hold == Hold::error ? Severity::note : Severity::warning;
}

/// Names the parts that keep most of the coarsest level, and sums up the rest by reason.
void judgeParts(BakeReport& report) {
    std::array<uint32_t, kHoldCount> rest = report.floor.held;
    uint32_t named = 0;
    for (const PartFloor& part : report.floor.parts) {
        const uint32_t held = part.heldBy(part.hold);
        if (named == kNamedParts || held < kManyFaces || 8 * held < report.floor.faces) continue;
        const HoldText text = textOf(part.hold);
        report.verdicts.push_back({severityOf(part.hold),
                                   fmt::format("{} of {} faces stay at the coarsest level, {} of them held by {}",
                                               part.faces, part.baseFaces, held, text.what),
                                   fmt::format("part '{}' near ({:.4g}, {:.4g}, {:.4g})", report.partNames[part.part],
                                               part.place.x, part.place.y, part.place.z),
                                   text.remedy});
        rest[size_t(part.hold)] -= held;
        ++named;
    }
    for (uint32_t h = 0; h < kHoldCount; ++h) {
        if (rest[h] <= kSmallFloor) continue;
        const HoldText text = textOf(Hold(h));
        report.verdicts.push_back({severityOf(Hold(h)),
                                   fmt::format("{} faces stay at the coarsest level in {}parts, held by {}", rest[h],
                                               named > 0 ? "other " : "", text.what),
                                   "build", text.remedy});
    }
}

/// Errors of a few pixels where the asset is 128 high.
constexpr double kFewPixels = 4.0 / 128;
/// Area that small open pieces should keep there; and their share of the whole from which on they matter.
constexpr double kKeptArea = 0.9, kFoliageShare = 0.05;

/// Names the level at which leaves and the like are thinnest while the error is still small.
void judgeFoliage(BakeReport& report) {
    const std::vector<HierarchyLevelReport>& levels = report.levels;
    if (levels.empty() || levels[0].sheetArea <= kFoliageShare * levels[0].area) return;
    size_t thinnest = 0;
    for (size_t l = 0; l < levels.size() && report.levelErrors[l] <= kFewPixels * report.diagonal; ++l) {
        if (levels[l].sheetArea < levels[thinnest].sheetArea) thinnest = l;
    }
    const double kept = levels[thinnest].sheetArea / levels[0].sheetArea;
    if (kept >= kKeptArea) return;
    report.verdicts.push_back(
        {Severity::warning,
         fmt::format("small open pieces thin out: level {} keeps {:.0f} % of their area", thinnest, 100 * kept),
         "build", "give leaves one normal and UV a corner, and parts of many (--parts material)"});
}

/// Pieces that the segmentation leaves apart make patches of their own.
void judgePartCount(const BakeOptions& options, BakeReport& report) {
    constexpr uint32_t kManyParts = 1000, kFewFaces = 16;
    if (options.parts == PartSource::material || report.parts < kManyParts) return;
    if (report.parts > report.faces / kFewFaces) {
        report.verdicts.push_back(
            {Severity::warning,
             fmt::format("{} parts for {} faces: each loose piece is one", report.parts, report.faces), "segment",
             "bake with --parts material"});
    }
}

/// Says what holds an asset up that does not become small.
void judgeFloor(const BakeOptions& options, BakeReport& report) {
    if (report.faces > 0 && !isSmall(options, report) && report.levels.size() < 2) {
        report.verdicts.push_back({Severity::warning, "no vertex may collapse: the asset has one level", "build",
                                   "every vertex lies on a boundary, seam or crease; use fewer parts"});
        return;
    }
    if (options.preset == Preset::standard) {
        if (!isSmall(options, report)) judgeParts(report);
        return;
    }
    const double left = 100.0 * report.levels.back().faces / std::max(1u, report.faces);
    if (left <= 50) return;
    report.verdicts.push_back({Severity::warning, fmt::format("{:.1f} % of the faces stay at the coarsest level", left),
                               "build", "boundaries of parts, seams and sharp features are locked; use fewer parts"});
}

} // namespace

void judge(const BakeOptions& options, BakeReport& report) {
    judgeInput(options, report);
    judgeSeams(options, report);
    judgeSegmentation(report);
    judgePartCount(options, report);
    judgeFoliage(report);
    judgeFloor(options, report);
}

} // namespace xgc::bake
