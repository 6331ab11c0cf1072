#include "segment_sections.h"

#include <fmt/format.h>

/// The perceptual segmentation on meshes of every kind, on changed ones, and with any number of threads. Without
/// arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    struct Section {
        const char* name;
        int (*run)(const Flags&);
    };
    const std::vector<Section> sections{
        {"generality", sweepGenerality}, {"stability", sweepStability}, {"determinism", sweepDeterminism}};
    std::vector<std::string> names;
    for (const Section& s : sections) names.push_back(s.name);
    Flags flags;
    if (!parseFlags(argc, argv, names, flags)) return 2;
    if (flags.data.empty()) fmt::print("SKIPPED: real meshes (no XGC_DATA)\n");
    int failed = 0;
    for (const Section& s : sections) {
        if (!flags.wants(s.name)) continue;
        fmt::print("\n-- {}\n", s.name);
        if (const int result = s.run(flags); result != 0) failed = result;
    }
    return failed;
}
