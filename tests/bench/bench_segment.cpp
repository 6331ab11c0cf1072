#include "meshes/off.h"

#include <xgc/bake/segment.h>
#include <xgc/bake/segmentation_metrics.h>

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <set>

/// The thesis's segmentation against people's on the Princeton segmentation benchmark: mean Rand index error (Chen,
/// Golovinskiy, Funkhouser 2009, section 4.4; lower is better).
///
///     bench_segment [--data DIR] [--flat-tolerance T] [--each] [--people]
namespace {

using namespace xgc;
using namespace xgc::bake;

struct Flags {
    bool each = false;   ///< a line a model
    bool people = false; ///< the error of people among themselves too
};

struct Totals {
    double error = 0;
    double peopleError = 0;
    uint32_t models = 0;
    uint32_t noisy = 0;
    uint32_t endless = 0; ///< still noisy after the last round
    double seconds = 0;
};

/// Number of a model, or 0.
uint32_t modelNumber(const std::filesystem::path& file) {
    return file.extension() == ".off" ? uint32_t(std::strtoul(file.stem().c_str(), nullptr, 10)) : 0;
}

Status readPeople(const std::filesystem::path& psb, uint32_t number, uint32_t faces,
                  std::vector<std::vector<uint32_t>>& people) {
    for (;;) {
        const auto file = psb / "seg" / std::to_string(number) / fmt::format("{}_{}.seg", number, people.size());
        if (!std::filesystem::exists(file)) break;
        std::vector<uint32_t> labels;
        if (Status s = readSegFile(file, faces, labels); !s.ok()) return s;
        people.push_back(std::move(labels));
    }
    if (!people.empty()) return {};
    return badInput(fmt::format("{}: no segmentations of model {}", psb.string(), number));
}

/// Mean over the people.
double errorAgainst(const MetricSurface& surface, const MetricLabels& labels, std::span<const MetricLabels> people) {
    double sum = 0;
    for (const MetricLabels& p : people) sum += compareLabels(surface, labels, p).randIndex;
    return sum / double(people.size());
}

/// Mean over the pairs of people: what the metrics themselves are checked with.
double errorAmong(const MetricSurface& surface, std::span<const MetricLabels> people) {
    double sum = 0;
    for (size_t i = 1; i < people.size(); ++i) sum += errorAgainst(surface, people[i], people.first(i)) * double(i);
    return sum / (double(people.size()) * double(people.size() - 1) / 2);
}

Status measure(const std::filesystem::path& psb, uint32_t number, const ThesisSegmentOptions& options, Flags flags,
               Totals& totals) {
    const Model model = test::readOff(psb / "off" / fmt::format("{}.off", number));
    Mesh mesh;
    WeldReport weldReport;
    if (Status s = weld(model, {}, mesh, weldReport); !s.ok()) return s;
    const auto start = std::chrono::steady_clock::now();
    ThesisSegmentTrace trace;
    const Topology topology = buildTopology(mesh);
    const Segmentation parts = segmentThesis(mesh, topology, options, &trace);
    totals.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::vector<uint32_t> ours = inputLabels(mesh, parts);

    std::vector<std::vector<uint32_t>> people;
    if (Status s = readPeople(psb, number, mesh.inputFaceCount, people); !s.ok()) return s;
    const MetricSurface surface = prepareSurface(mesh, topology);
    std::vector<MetricLabels> prepared;
    for (const std::vector<uint32_t>& p : people) prepared.push_back(prepareLabels(surface, p));
    const double error = errorAgainst(surface, prepareLabels(surface, ours), prepared);
    totals.error += error;
    if (flags.people) totals.peopleError += errorAmong(surface, prepared);
    ++totals.models;
    totals.noisy += trace.noisy;
    totals.endless += trace.noisyAfterSmoothing;
    if (flags.each) {
        fmt::print("{:4} RI {:.4f} filled {:6} n {:3} parts {:3} rounds {}\n", number, error, trace.filledCount,
                   trace.equationCount, parts.partCount(), trace.smoothingRounds);
    }
    return {};
}

} // namespace

int main(int argc, char** argv) {
    std::filesystem::path data = test::dataDir(XGC_SOURCE_DIR);
    ThesisSegmentOptions options;
    Flags flags;
    for (int i = 1; i < argc; ++i) {
        const std::string_view arg = argv[i];
        if (arg == "--each") flags.each = true;
        if (arg == "--people") flags.people = true;
        if (arg == "--data" && i + 1 < argc) data = argv[++i];
        if (arg == "--flat-tolerance" && i + 1 < argc) options.flatTolerance = std::strtof(argv[++i], nullptr);
    }
    if (!std::filesystem::is_directory(data / "psb" / "off")) {
        fmt::print("SKIPPED: Princeton segmentation benchmark (no XGC_DATA)\n");
        return 0;
    }
    std::set<uint32_t> numbers;
    for (const auto& entry : std::filesystem::directory_iterator(data / "psb" / "off")) {
        if (const uint32_t n = modelNumber(entry.path())) numbers.insert(n);
    }
    Totals totals;
    for (const uint32_t n : numbers) {
        if (const Status s = measure(data / "psb", n, options, flags, totals); !s.ok()) {
            fmt::print(stderr, "bench_segment: {}\n", s.message);
            return int(s.outcome);
        }
    }
    fmt::print("models {}, flat tolerance {}: RI {:.4f}, noisy {}, noisy to the end {}, {:.2f} s\n", totals.models,
               options.flatTolerance, totals.error / totals.models, totals.noisy, totals.endless, totals.seconds);
    if (flags.people) fmt::print("people among themselves: RI {:.4f}\n", totals.peopleError / totals.models);
    return 0;
}
