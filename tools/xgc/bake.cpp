#include "commands.h"
#include "part_options.h"
#include "progress.h"

#include <xgc/bake/bake.h>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>

namespace xgc::tool {
namespace {

constexpr uint32_t kPlotSamples = 20'000;

std::atomic<bool> interrupted{false};

struct BakeArguments {
    std::string input, output, report, plot;
    std::string preset = "default", placement = "subset", curvature = "trace", normals = "keep", importanceColor;
    std::vector<std::string> lockedParts, importances;
    PartOptions parts;
    uint32_t jobs = 0, pageKilobytes = 64;
    bool quiet = false, verbose = false;
    bake::BakeOptions options;
};

bake::Status parseParts(BakeArguments& arguments, bake::BakeOptions& options) {
    if (bake::Status s = parse(arguments.parts); !s.ok()) return s;
    options.parts = arguments.parts.source;
    if (options.parts == bake::PartSource::labels) options.labels = arguments.parts.parts;
    options.perceptual.partsCount = options.segment.partsCount = arguments.parts.count;
    options.perceptual.detail = arguments.parts.detail;
    return {};
}

/// PART=FACTOR, and parts to lock.
bake::Status parseImportance(const BakeArguments& arguments, bake::BakeOptions& options) {
    for (const std::string& text : arguments.importances) {
        const size_t equals = text.rfind('=');
        char* end = nullptr;
        const float factor = equals == std::string::npos ? 0 : std::strtof(text.c_str() + equals + 1, &end);
        if (!(factor > 0) || *end != 0 || equals == 0) {
            return bake::usageError(fmt::format("--importance {}: expected PART=FACTOR with a factor above 0", text));
        }
        options.importance.push_back({text.substr(0, equals), factor});
    }
    for (const std::string& part : arguments.lockedParts) {
        options.importance.push_back({part, std::numeric_limits<float>::infinity()});
    }
    if (!arguments.importanceColor.empty()) {
        options.importanceChannel = int(std::string_view("rgba").find(arguments.importanceColor));
    }
    return {};
}

bake::Status parse(BakeArguments& arguments, bake::BakeOptions& options) {
    if (bake::Status s = parseParts(arguments, options); !s.ok()) return s;
    if (bake::Status s = parseImportance(arguments, options); !s.ok()) return s;
    options.preset = arguments.preset == "thesis" ? bake::Preset::thesis : bake::Preset::standard;
    options.hierarchy.placement = arguments.placement == "optimal"    ? bake::Placement::optimal
                                  : arguments.placement == "midpoint" ? bake::Placement::midpoint
                                                                      : bake::Placement::subset;
    options.thesis.curvature = arguments.curvature == "sum"         ? bake::CurvatureNorm::sum
                               : arguments.curvature == "frobenius" ? bake::CurvatureNorm::frobenius
                                                                    : bake::CurvatureNorm::trace;
    options.normals = arguments.normals == "smooth" ? bake::NormalSource::smooth : bake::NormalSource::keep;
    if (!arguments.plot.empty()) {
        if (std::filesystem::path(arguments.plot).extension() != ".svg")
            return bake::usageError(fmt::format("--plot {}: the picture must end in .svg", arguments.plot));
        options.rmsSamples = kPlotSamples;
    }
    options.input = arguments.input;
    options.output = arguments.output;
    if (options.output.extension() != ".xgc") {
        return bake::usageError(fmt::format("{}: the output must end in .xgc", arguments.output));
    }
    const std::filesystem::path folder = options.output.has_parent_path() ? options.output.parent_path() : ".";
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
        return bake::badInput(fmt::format("{}: no such folder: make it first", folder.string()));
    }
    if (std::filesystem::is_directory(options.output, error)) {
        return bake::badInput(fmt::format("{}: is a folder: name a file", arguments.output));
    }
    return {};
}

void printStages(const bake::BakeReport& report) {
    fmt::print(stderr, "{:<10} {:>8} {:>10}\n", "stage", "seconds", "peak MiB");
    for (const bake::StageReport& s : report.stages)
        fmt::print(stderr, "{:<10} {:>8.2f} {:>10.0f}\n", s.name, s.seconds, double(s.peakBytes) / 0x1p20);
}

/// What each level has, and what kept it from having less.
void printLevels(const bake::BakeReport& report) {
    fmt::print(stderr, "{:>5} {:>10} {:>7} {:>11} {:>10} {:>9} {:>9} {:>9} {:>8}\n", "level", "faces", "%", "error",
               "collapses", "no link", "no flip", "no seam", "seconds");
    for (size_t l = 0; l < report.levels.size(); ++l) {
        const bake::HierarchyLevelReport& level = report.levels[l];
        fmt::print(stderr, "{:>5} {:>10} {:>7.2f} {:>11.4g} {:>10} {:>9} {:>9} {:>9} {:>8.3f}\n", l, level.faces,
                   100.0 * level.faces / std::max(1u, report.faces),
                   l < report.levelErrors.size() ? report.levelErrors[l] : 0.0f, level.collapses, level.linkRefused,
                   level.flipRefused, level.wedgeRefused, level.seconds);
    }
}

/// Streams in full, sections as one line.
void printSizes(const bake::BakeReport& report) {
    uint64_t raw = 0, stored = 0;
    for (const bake::SizeReport& s : report.sizes.sections) {
        raw += s.rawBytes;
        stored += s.storedBytes;
    }
    const auto line = [&](const std::string& name, uint64_t rawBytes, uint64_t storedBytes) {
        fmt::print(stderr, "{:<14} {:>12} {:>12} {:>7.1f}\n", name, rawBytes, storedBytes,
                   100.0 * double(storedBytes) / double(std::max<uint64_t>(1, report.fileBytes)));
    };
    fmt::print(stderr, "{:<14} {:>12} {:>12} {:>7}\n", "stream", "bytes", "in file", "%");
    for (const bake::SizeReport& s : report.sizes.streams)
        line(s.set > 0 ? fmt::format("{} {}", s.name, s.set) : s.name, s.rawBytes, s.storedBytes);
    line("tables", raw, stored);
}

void printSummary(const bake::BakeOptions& options, const bake::BakeReport& report) {
    double seconds = 0;
    for (const bake::StageReport& s : report.stages) seconds += s.seconds;
    fmt::print(stderr, "{}: {} faces, {} parts, {} patches, {} levels, {} bytes ({:.1f} a face), {:.2f} s\n",
               options.output.string(), report.faces, report.parts, report.patches, report.levels.size(),
               report.fileBytes, double(report.fileBytes) / std::max(1u, report.faces), seconds);
    for (const bake::Verdict& v : report.verdicts) {
        const char* severity = v.severity == bake::Severity::warning ? "warning" : "note";
        fmt::print(stderr, "{}: {}: {} ({})\n", severity, v.where, v.what, v.remedy);
    }
}

void print(const BakeArguments& arguments, const bake::BakeReport& report) {
    if (arguments.quiet) return;
    if (arguments.verbose) {
        printStages(report);
        printLevels(report);
        printSizes(report);
    }
    printSummary(arguments.options, report);
}

bake::Status writeReports(const BakeArguments& arguments, const bake::BakeReport& report) {
    const auto write = [](const std::string& file, const std::string& text) {
        return bake::writeFileAtomically(file, std::as_bytes(std::span(text)));
    };
    bake::Status status;
    if (!arguments.report.empty()) status = write(arguments.report, bake::reportJson(arguments.options, report));
    if (status.ok() && !arguments.plot.empty())
        status = write(arguments.plot, bake::reportPlot(arguments.options, report));
    return status;
}

bake::Status runBake(BakeArguments& arguments) {
    bake::BakeOptions& options = arguments.options;
    if (bake::Status s = parse(arguments, options); !s.ok()) return s;
    std::optional<tbb::global_control> limit;
    if (arguments.jobs > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, arguments.jobs);
    std::signal(SIGINT, [](int) { interrupted = true; });
    std::signal(SIGTERM, [](int) { interrupted = true; });
    options.cancelled = &interrupted;
    bake::BakeReport report;
    bake::Status status;
    {
        Progress progress(arguments.quiet);
        options.progress = [&](const char* stage, double fraction) { progress.show(stage, fraction); };
        options.pages.pageBytes = arguments.pageKilobytes * 1024;
        status = bake::bake(options, report);
    }
    const bool graded = status.ok() || status.outcome == bake::Outcome::promiseBroken;
    if (!graded) return status;
    print(arguments, report);
    const bake::Status written = writeReports(arguments, report);
    return status.ok() ? written : status;
}

} // namespace

void addBake(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<BakeArguments>();
    CLI::App* bake = app.add_subcommand("bake", "Bake a model file into one .xgc asset");
    bake->add_option("IN", arguments->input, "Model: glTF, GLB, OBJ, PLY, OFF, STL, ...")->required();
    bake->add_option("-o,--output", arguments->output, "The asset to write, ending in .xgc")->required();
    bake->add_option("--preset", arguments->preset, "Hierarchy: default, or thesis (boundaries and creases locked)")
        ->check(CLI::IsMember({"default", "thesis"}))
        ->capture_default_str();
    addPartOptions(*bake, arguments->parts);
    bake->add_option("--curvature", arguments->curvature, "Of --preset thesis: norm that locks creases and apices")
        ->check(CLI::IsMember({"trace", "sum", "frobenius"}))
        ->capture_default_str();
    bake->add_option("--placement", arguments->placement,
                     "Of collapsed vertices: subset of the input's, or optimal or midpoint ones, for more memory")
        ->check(CLI::IsMember({"subset", "optimal", "midpoint"}))
        ->capture_default_str();
    bake->add_option("--patch-faces", arguments->options.patchFaces, "Faces a patch, about; 0: a patch a part")
        ->capture_default_str();
    bake->add_option("--levels", arguments->options.hierarchy.maxLevels, "Levels above the input's, at most")
        ->check(CLI::Range(1, 200))
        ->capture_default_str();
    bake->add_option("--normal-weight", arguments->options.hierarchy.normalWeight,
                     "Cost of a normal of the input turned by 1 rad, in diagonals of the model")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    bake->add_option("--uv-weight", arguments->options.hierarchy.uvWeight, "Cost of a UV moved by 1, in diagonals")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    bake->add_option("--color-weight", arguments->options.hierarchy.colorWeight,
                     "Cost of a vertex colour changed by 1, in diagonals")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    bake->add_option("--lock-part", arguments->lockedParts, "Part (name or number) whose vertices stay at all levels");
    bake->add_option("--importance", arguments->importances, "PART=FACTOR: errors of the part count FACTOR times");
    bake->add_option("--importance-color", arguments->importanceColor,
                     "Channel of the vertex colours with painted importance: 0 none, 1 locks")
        ->check(CLI::IsMember({"r", "g", "b", "a"}));
    bake->add_option("--normals", arguments->normals,
                     "keep the input's, or make smooth ones with creases at 60 degrees")
        ->check(CLI::IsMember({"keep", "smooth"}))
        ->capture_default_str();
    bake->add_option("--weld", arguments->options.weld.tolerance, "Grid spacing of the weld, mesh units; 0: exact")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    bake->add_option(
            "--tiers", arguments->options.pages.tiers,
            "cut the file into pages for streaming, in so many tiers of levels (1: one page; 6 is a good start)")
        ->check(CLI::Range(1u, format::kMaxTiers));
    bake->add_option("--page-kb", arguments->pageKilobytes,
                     "with --tiers: most bytes of a page, uncompressed (a patch is never cut)")
        ->check(CLI::Range(1u, 1u << 20));
    bake->add_flag("--compress", arguments->options.compress,
                   "Compress the file: a third of the size, decoded by xgc::load; without it, it can be mapped");
    bake->add_option(
            "--position-bits", arguments->options.positionBits,
            "Snap positions to a grid of BITS along the longest side before building; 0: keep them as they are")
        ->check(CLI::Range(0u, 24u))
        ->capture_default_str();
    bake->add_option("--normal-bits", arguments->options.rounding.normalBits, "Round octahedral normals to these bits")
        ->check(CLI::Range(8u, 16u))
        ->capture_default_str();
    bake->add_option("--uv-bits", arguments->options.rounding.uvBits,
                     "Round UVs to multiples of 2^-BITS; 0: keep them as they are")
        ->check(CLI::Range(0u, 23u))
        ->capture_default_str();
    bake->add_option("--report", arguments->report, "Write a report as JSON");
    bake->add_option("--plot", arguments->plot, "Draw faces against error, bound and sampled RMS, as a FILE.svg");
    bake->add_option("--jobs", arguments->jobs, "Threads; 0: all cores")->capture_default_str();
    bake->add_flag("--strict", arguments->options.strict,
                   "Warnings fail the bake: exit code 1, nothing written but the report");
    CLI::Option* verbose = bake->add_flag("--verbose", arguments->verbose, "Print stages, levels and sizes as well");
    bake->add_flag("--quiet", arguments->quiet, "Print nothing but errors")->excludes(verbose);
    bake->footer("Example: xgc bake creature.glb -o creature.xgc --report creature.json");
    bake->callback([arguments, &run] { run = [arguments] { return runBake(*arguments); }; });
}

} // namespace xgc::tool
