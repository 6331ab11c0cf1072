#include "sections.h"

#include <fmt/format.h>

/// Judges the default hierarchy by the figures that people choose a simplifier by, beside other programs. Without
/// arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    struct Section {
        const char* name;
        int (*run)(const Flags&);
    };
    const std::vector<Section> sections{{"quality", benchQuality},       {"optimal", benchOptimal},
                                        {"attributes", benchAttributes}, {"parts", benchParts},
                                        {"speed", benchSpeed},           {"memory", benchMemory},
                                        {"indices", benchIndices},       {"foliage", benchFoliage}};
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
