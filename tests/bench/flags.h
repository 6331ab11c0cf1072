#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace xgc::bench {

/// What `bench_hierarchy` and `sweep_hierarchy` are asked for.
struct Flags {
    std::vector<std::string> sections; ///< as --names; empty: all
    std::vector<std::string> models;   ///< by name; empty: all
    bool each = false;                 ///< a line for every model too
    uint32_t states = 20;              ///< random ones a mesh
    uint32_t runs = 5;                 ///< of what is timed
    std::filesystem::path data;        ///< the real meshes; empty where absent
    std::filesystem::path csv;         ///< folder for results; empty: none
    std::filesystem::path plots;       ///< folder for pictures of results; empty: none
    std::string outside;               ///< command that runs other simplifiers, see Peers; empty: none
    std::string beside;                ///< command timed in turn with the builder, see hierarchy_speed.cpp
    std::filesystem::path gltfpack;    ///< program; empty where absent
    std::string commit = "unknown";
    std::string machine = "unknown";

    bool wants(const std::string& section) const;
    bool wantsModel(const std::string& name) const;
};

/// False, with the usage on stderr, where an argument is not known.
bool parseFlags(int argc, char** argv, const std::vector<std::string>& sections, Flags& flags);

/// A part of a benchmark's program.
struct Section {
    const char* name;
    int (*run)(const Flags&); ///< prints its table; 0 or the exit code of a failure
};
/// The `main` of a program of sections: those that the arguments name, or all;
/// one that fails does not stop the others.
int runSections(int argc, char** argv, const std::vector<Section>& sections);

/// Rows of one section, written to FOLDER/<section>.csv below a line that names commit and machine; nothing without a
/// folder.
class Csv {
public:
    Csv(const Flags& flags, const std::string& section, const std::string& columns);
    void row(const std::string& cells);

private:
    std::ofstream out_;
};

double median(std::vector<double> values);
double mean(const std::vector<double>& values);

} // namespace xgc::bench
