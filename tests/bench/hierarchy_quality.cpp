#include "comparison.h"
#include "sections.h"
#include "subjects.h"

#include <fmt/format.h>

namespace xgc::bench {
namespace {

std::vector<Source> sourcesOf(const Flags& flags) {
    std::vector<Source> sources;
    if (!flags.data.empty()) {
        sources = princetonSample(flags.data);
        sources.push_back(helmet(flags.data));
    }
    for (Source& s : dragon()) sources.push_back(std::move(s));
    return sources;
}

void printEach(const std::vector<Comparison>& all) {
    for (const Comparison& c : all) {
        fmt::print("{:<8} {:>5} % level {:>2} {:>7} faces  {:<28} {:>7} faces  RMS {:.3f} max {:.3f}{}\n", c.model,
                   c.target, c.level, c.ours.faces, c.program, c.theirs.faces, c.ours.rms / c.theirs.rms,
                   c.ours.max / c.theirs.max, c.equalFaces() ? "" : "  (counts differ: left out)");
    }
}

void writeRow(const Comparison& c, Csv& csv) {
    csv.row(fmt::format("{},{},{},{},{:.6e},{:.6e},{},{},{:.6e},{:.6e}", c.model, c.target, c.level, c.ours.faces,
                        c.ours.rms, c.ours.max, c.program, c.theirs.faces, c.theirs.rms, c.theirs.max));
}

int measure(const Flags& flags, bake::Placement placement, Csv& csv) {
    bake::HierarchyOptions options;
    options.placement = placement;
    std::vector<Comparison> all;
    const auto compare = [&](const Subject& subject) {
        const std::vector<Comparison> some = compareLevels(flags, subject, options, false);
        if (flags.each) printEach(some);
        for (const Comparison& c : some) writeRow(c, csv);
        all.insert(all.end(), some.begin(), some.end());
    };
    if (const int failed = forSubjects(flags, sourcesOf(flags), compare); failed != 0) return failed;
    printRatios("RMS over that of", ratiosOf(all, [](const Quality& q) { return q.rms; }));
    printRatios("maximum over that of", ratiosOf(all, [](const Quality& q) { return q.max; }));
    return 0;
}

constexpr const char* kColumns =
    "model,target_percent,level,faces,rms,max,program,program_faces,program_rms,program_max";

} // namespace

int benchQuality(const Flags& flags) {
    Csv csv(flags, "quality", kColumns);
    return measure(flags, bake::Placement::subset, csv);
}

int benchOptimal(const Flags& flags) {
    Csv csv(flags, "optimal", kColumns);
    return measure(flags, bake::Placement::optimal, csv);
}

} // namespace xgc::bench
