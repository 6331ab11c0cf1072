#include "bench/thesis_pictures.h"
#include "meshes/builders.h"

#include <xgc/bake/import.h>
#include <xgc/bake/thesis_hierarchy.h>

#include <fmt/format.h>

#include <chrono>

// The thesis's figures of chapter 4 beside ours: faces that remain, memory and time per level, for the human (4.9), the
// chair (4.10) and the Armadillo (4.7) of the Princeton benchmark with the thesis's own parts.

using namespace xgc;
using namespace xgc::bake;

namespace {

constexpr uint32_t kLevels = 7;

struct Example {
    const char* file;
    std::array<const char*, kLevels + 1> remaining; ///< percent of the faces, by the thesis
};
constexpr std::array<Example, 3> kExamples{{
    {"mesh/psb11.off", {"100", "", "33", "", "19", "", "16", ""}},
    {"psb/off/101.off", {"100", "", "34", "", "22", "", "19", ""}},
    {"psb/off/281.off", {"100", "", "34.5", "", "18.8", "", "", ""}},
}};

struct Subject {
    Mesh mesh;
    Topology topology;
    PatchAssignment patches;
    uint32_t parts = 0;
};

bool load(const std::filesystem::path& file, Subject& s) {
    Model model;
    WeldReport report;
    Status status = importModel(file, model);
    if (status.ok()) status = weld(model, {}, s.mesh, report);
    if (!status.ok()) {
        fmt::print(stderr, "{}\n", status.message);
        return false;
    }
    s.topology = buildTopology(s.mesh);
    const Segmentation parts = segmentThesis(s.mesh, s.topology, {});
    s.parts = parts.partCount();
    s.patches = patchesOfParts(s.mesh, parts);
    return true;
}

XgcMesh meshOf(const Subject& s, CurvatureNorm norm) {
    XgcOptions options;
    options.curvature = norm;
    return XgcMesh(s.mesh, s.topology, s.patches.facePatch, uint32_t(s.patches.patches.size()), options);
}

double secondsOf(auto&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void printRow(std::string_view name, auto&& cell) {
    fmt::print("  {:<28}", name);
    for (uint32_t level = 0; level <= kLevels; ++level) fmt::print("{:>9}", cell(level));
    fmt::print("\n");
}

void printRemaining(const Subject& s, const Example& example) {
    printRow("faces left, %: thesis", [&](uint32_t level) { return example.remaining[level]; });
    constexpr std::array<std::pair<const char*, CurvatureNorm>, 3> kNorms{
        {{"trace", CurvatureNorm::trace}, {"sum", CurvatureNorm::sum}, {"frobenius", CurvatureNorm::frobenius}}};
    for (const auto& [name, norm] : kNorms) {
        XgcMesh x = meshOf(s, norm);
        printRow(fmt::format("  {}", name), [&](uint32_t level) {
            if (level > 0) x.simplifyAll();
            return fmt::format("{:.1f}", 100.0 * x.faceCount() / s.mesh.faceCount());
        });
    }
}

/// Bytes by the thesis's formula (88 + 2k) f, k the mean degree of a vertex.
double thesisBytes(const Subject& s) {
    const double degree = 2.0 * double(s.topology.edges.size()) / double(s.mesh.positions.size());
    return (88 + 2 * degree) * s.mesh.faceCount();
}

void printMemoryAndTime(const Subject& s) {
    XgcMesh x = meshOf(s, CurvatureNorm::trace);
    std::array<double, kLevels + 1> bytes{}, up{}, down{};
    bytes[0] = double(x.memoryBytes());
    for (uint32_t level = 1; level <= kLevels; ++level) {
        up[level] = secondsOf([&] { x.simplifyAll(); });
        bytes[level] = double(x.memoryBytes());
    }
    for (uint32_t level = kLevels; level > 0; --level) {
        down[level] = secondsOf([&] {
            for (uint32_t segment = 0; segment < x.segmentCount(); ++segment) {
                if (x.level(segment) >= level) x.refine(segment);
            }
        });
    }
    const double faces = s.mesh.faceCount();
    printRow("memory, %: thesis", [](uint32_t level) { return level == kLevels ? "133" : level == 0 ? "100" : ""; });
    printRow("  ours", [&](uint32_t level) { return fmt::format("{:.1f}", 100 * bytes[level] / bytes[0]); });
    printRow("  bytes a face", [&](uint32_t level) { return fmt::format("{:.1f}", bytes[level] / faces); });
    fmt::print("  thesis's formula, level 0: {:.1f} bytes a face; the plain mesh (float3, u32): {:.1f}\n",
               thesisBytes(s) / faces, (12.0 * double(s.mesh.positions.size()) + 12 * faces) / faces);
    printRow("simplify to it, ms", [&](uint32_t level) { return fmt::format("{:.1f}", 1e3 * up[level]); });
    printRow("refine from it, ms", [&](uint32_t level) { return fmt::format("{:.1f}", 1e3 * down[level]); });
}

} // namespace

int main(int argc, char** argv) {
    const std::span<char*> arguments(argv, size_t(argc));
    const bool pictures = arguments.size() == 3 && std::string_view(arguments[1]) == "--pictures";
    if (arguments.size() != 1 && !pictures) {
        fmt::print(stderr, "usage: sweep_thesis [--pictures FOLDER]\n");
        return 2;
    }
    const std::filesystem::path data = test::dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        fmt::print("SKIPPED: the thesis's models (no XGC_DATA)\n");
        return 0;
    }
    for (const Example& example : kExamples) {
        Subject s;
        if (!load(data / example.file, s)) return 3;
        fmt::print("\n{}: {} faces, {} parts\n", example.file, s.mesh.faceCount(), s.parts);
        printRow("level", [](uint32_t level) { return level; });
        printRemaining(s, example);
        printMemoryAndTime(s);
    }
    if (!pictures) return 0;
    const Status status = test::drawThesisPictures(data, arguments[2]);
    if (!status.ok()) fmt::print(stderr, "{}\n", status.message);
    return int(status.outcome);
}
