#include "flags.h"

#include "meshes/builders.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>

namespace xgc::bench {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
    return names.empty() || std::ranges::find(names, name) != names.end();
}

void printUsage(const char* program, const std::vector<std::string>& sections) {
    fmt::print(stderr, "usage: {}", program);
    for (const std::string& section : sections) fmt::print(stderr, " [--{}]", section);
    fmt::print(stderr, " [OPTION]...\n");
    fmt::print(stderr, "  --models A,B      only these; no CSV then\n"
                       "  --each            a line for every model too\n"
                       "  --states N        random states a mesh\n"
                       "  --runs N          of what is timed\n"
                       "  --data FOLDER     the real meshes (default: $XGC_DATA, ../shared/data)\n"
                       "  --csv FOLDER      write results there, with --commit TEXT and --machine TEXT\n"
                       "  --plots FOLDER    draw results there, as SVG\n"
                       "  --outside COMMAND compare with other simplifiers too: given a PLY file, a count of faces\n"
                       "                    and a folder, it writes FOLDER/PROGRAM.ply for each of them; for the\n"
                       "                    section view see outside_cut.h\n"
                       "  --beside COMMAND  time it in turn with the builder: given a PLY file, it prints the\n"
                       "                    seconds that it took on the clock and of the processor\n"
                       "  --gltfpack FILE   the program\n");
}

} // namespace

bool Flags::wants(const std::string& section) const {
    return holds(sections, section);
}

bool Flags::wantsModel(const std::string& name) const {
    return holds(models, name);
}

bool parseFlags(int argc, char** argv, const std::vector<std::string>& sections, Flags& flags) {
    flags.data = test::dataDir(XGC_SOURCE_DIR);
    for (int i = 1; i < argc; ++i) {
        const std::string arg = argv[i];
        const std::string name = arg.starts_with("--") ? arg.substr(2) : "";
        if (std::ranges::find(sections, name) != sections.end()) {
            flags.sections.push_back(name);
            continue;
        }
        if (name == "each") {
            flags.each = true;
            continue;
        }
        const std::string value = i + 1 < argc ? argv[++i] : "";
        if (value.empty()) return printUsage(argv[0], sections), false;
        if (name == "models") {
            std::istringstream list(value);
            for (std::string model; std::getline(list, model, ',');) flags.models.push_back(model);
        } else if (name == "states") {
            flags.states = uint32_t(std::stoul(value));
        } else if (name == "runs") {
            flags.runs = uint32_t(std::stoul(value));
        } else if (name == "data") {
            flags.data = value;
        } else if (name == "csv") {
            flags.csv = value;
        } else if (name == "plots") {
            flags.plots = value;
        } else if (name == "outside") {
            flags.outside = value;
        } else if (name == "beside") {
            flags.beside = value;
        } else if (name == "gltfpack") {
            flags.gltfpack = value;
        } else if (name == "commit") {
            flags.commit = value;
        } else if (name == "machine") {
            flags.machine = value;
        } else {
            return printUsage(argv[0], sections), false;
        }
    }
    if (!flags.models.empty()) flags.csv.clear(); // results are of all models
    return true;
}

int runSections(int argc, char** argv, const std::vector<Section>& sections) {
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

Csv::Csv(const Flags& flags, const std::string& section, const std::string& columns) {
    if (flags.csv.empty()) return;
    std::filesystem::create_directories(flags.csv);
    out_.open(flags.csv / (section + ".csv"));
    out_ << "# commit " << flags.commit << ", " << flags.machine << '\n' << columns << '\n';
}

void Csv::row(const std::string& cells) {
    if (out_.is_open()) out_ << cells << '\n';
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const size_t n = values.size();
    return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

double mean(const std::vector<double>& values) {
    return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

} // namespace xgc::bench
