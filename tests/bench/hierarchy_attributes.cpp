#include "comparison.h"
#include "sections.h"
#include "subjects.h"

#include <fmt/format.h>

namespace xgc::bench {
namespace {

std::vector<Source> sourcesOf(const Flags& flags) {
    std::vector<Source> sources{{"temple", {}, 60'000}, {"terrain", {}, 60'000, false, true}};
    if (flags.data.empty()) return sources;
    sources.push_back(helmet(flags.data));
    for (const char* name : {"boat", "koala", "armadillo", "fandisk"})
        sources.push_back({name, flags.data / "mesh" / fmt::format("{}.obj", name), 0, false, true});
    return sources;
}

void print(const Comparison& c) {
    const AttributeDeviation &a = c.ours.attributes, &b = c.theirs.attributes;
    fmt::print("{:<8} {:>5} % {:>6} faces  {:<26} {:>6}  RMS {:.2f}  normals {:.2f} ({:.2f} deg)  UV {:.2f}  stretch "
               "{:.2f} ({:.3f})\n",
               c.model, c.target, c.ours.faces, c.program, c.theirs.faces, c.ours.rms / c.theirs.rms,
               b.normalDegrees > 0 ? a.normalDegrees / b.normalDegrees : 0, a.normalDegrees,
               b.uvRms > 0 ? a.uvRms / b.uvRms : 0, b.stretch > 0 ? a.stretch / b.stretch : 0, a.stretch);
}

} // namespace

int benchAttributes(const Flags& flags) {
    Csv csv(
        flags, "attributes",
        "placement,model,target_percent,level,faces,rms,normal_degrees,uv,stretch,program,program_faces,program_rms,"
        "program_normal_degrees,program_uv,program_stretch");
    for (const bake::Placement p : {bake::Placement::subset, bake::Placement::optimal}) {
        const char* placement = p == bake::Placement::optimal ? "optimal" : "subset";
        std::vector<Comparison> all;
        const auto compare = [&](const Subject& subject) {
            bake::HierarchyOptions options;
            options.placement = p;
            for (const Comparison& c : compareLevels(flags, subject, options, true)) {
                if (flags.each) print(c);
                const AttributeDeviation &a = c.ours.attributes, &b = c.theirs.attributes;
                csv.row(fmt::format("{},{},{},{},{},{:.6e},{:.4f},{:.6e},{:.5f},{},{},{:.6e},{:.4f},{:.6e},{:.5f}",
                                    placement, c.model, c.target, c.level, c.ours.faces, c.ours.rms, a.normalDegrees,
                                    a.uvRms, a.stretch, c.program, c.theirs.faces, c.theirs.rms, b.normalDegrees,
                                    b.uvRms, b.stretch));
                all.push_back(c);
            }
        };
        if (const int failed = forSubjects(flags, sourcesOf(flags), compare); failed != 0) return failed;
        const std::string over = fmt::format(", {} placement, over", placement);
        printRatios("normal deviation" + over,
                    ratiosOf(all, [](const Quality& q) { return q.attributes.normalDegrees; }));
        printRatios("UV deviation" + over, ratiosOf(all, [](const Quality& q) { return q.attributes.uvRms; }));
        printRatios("UV stretch" + over, ratiosOf(all, [](const Quality& q) { return q.attributes.stretch; }));
        printRatios("RMS" + over, ratiosOf(all, [](const Quality& q) { return q.rms; }));
    }
    return 0;
}

} // namespace xgc::bench
