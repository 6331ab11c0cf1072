#include "runtime_sections.h"

#include <fmt/format.h>

/// Judges what a renderer does each frame: selection, draw lists, uploads, and what levels inside a mesh are worth.
/// Without arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    struct Section {
        const char* name;
        int (*run)(const Flags&);
    };
    const std::vector<Section> sections{{"crowd", benchCrowd}, {"view", benchView}};
    std::vector<std::string> names;
    for (const Section& s : sections) names.push_back(s.name);
    Flags flags;
    if (!parseFlags(argc, argv, names, flags)) return 2;
    if (flags.data.empty()) fmt::print("SKIPPED: real meshes (no XGC_DATA)\n");
    for (const Section& s : sections) {
        if (!flags.wants(s.name)) continue;
        fmt::print("\n-- {}\n", s.name);
        if (const int failed = s.run(flags); failed != 0) return failed;
    }
    return 0;
}
