#include "commands.h"
#include "open_asset.h"
#include "progress.h"

#include <xgc/bake/import.h>
#include <xgc/bake/mesh.h>
#include <xgc/bake/snap.h>
#include <xgc/bake/verify.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include <cmath>
#include <memory>
#include <optional>

namespace xgc::tool {
namespace {

constexpr uint32_t kTightnessSamples = 1000;

struct VerifyArguments {
    std::string file, source;
    bake::VerifyOptions options;
    float weldTolerance = 0;
    uint32_t jobs = 0;
    bool error = false;
    bool json = false;
    bool quiet = false;
};

void printJson(const bake::VerifyReport& r) {
    nlohmann::ordered_json json{{"ok", r.ok()},
                                {"states", r.states},
                                {"faces", r.faces},
                                {"flips", r.flips},
                                {"oddEdges", r.oddEdges},
                                {"fourUseEdges", r.fourUseEdges},
                                {"mismatches", r.mismatches},
                                {"degenerate", r.degenerate},
                                {"miscounted", r.miscounted},
                                {"fallingErrors", r.fallingErrors},
                                {"errorSamples", r.errorSamples},
                                {"errorViolations", r.errorViolations},
                                {"worstErrorRatio", r.worstErrorRatio},
                                {"errorTightness", r.errorTightness},
                                {"sourceMismatches", r.sourceMismatches}};
    fmt::print("{}\n", json.dump(2));
}

void printText(const std::string& file, const bake::VerifyReport& r) {
    fmt::print("{}: {}\n", file, r.ok() ? "every promise held" : "A PROMISE IS BROKEN");
    fmt::print("  {} states, {} faces drawn\n", r.states, r.faces);
    fmt::print("  flipped faces               {}\n", r.flips);
    fmt::print("  odd edges (cracks)          {}\n", r.oddEdges);
    fmt::print("  edges used four times       {} (harmless)\n", r.fourUseEdges);
    fmt::print("  degenerate triangles        {}\n", r.degenerate);
    fmt::print("  differing from definition   {}\n", r.mismatches);
    fmt::print("  wrong counts of triangles   {}\n", r.miscounted);
    fmt::print("  errors that fall            {}\n", r.fallingErrors);
    fmt::print("  error samples               {}, beyond the promise {}, worst ratio {:.3f}\n", r.errorSamples,
               r.errorViolations, r.worstErrorRatio);
    if (r.errorTightness > 0) fmt::print("  error over largest sample   {:.3f} (median)\n", r.errorTightness);
    fmt::print("  differing from the source   {}\n", r.sourceMismatches);
}

bake::Status compareSource(const VerifyArguments& arguments, const AssetView& asset, bake::VerifyReport& report) {
    bake::Model model;
    if (bake::Status s = bake::importModel(arguments.source, model); !s.ok()) return s;
    const float step = asset.record->positionStep;
    if (step > 0 && std::isfinite(step)) bake::snapPositions(model, step);
    bake::Mesh mesh;
    bake::WeldReport weld;
    if (bake::Status s = bake::weld(model, {.tolerance = arguments.weldTolerance}, mesh, weld); !s.ok()) return s;
    bake::verifySource(asset, mesh, report);
    return {};
}

bake::Status runVerify(VerifyArguments& arguments) {
    std::optional<tbb::global_control> limit;
    if (arguments.jobs > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, arguments.jobs);
    OpenAsset asset;
    if (bake::Status s = openAsset(arguments.file, asset); !s.ok()) return s;
    if (arguments.error) {
        arguments.options.errorStates = ~0u;
        arguments.options.tightnessSamples = kTightnessSamples;
    }
    bake::VerifyReport report;
    if (!arguments.source.empty()) {
        if (bake::Status s = compareSource(arguments, asset.view, report); !s.ok()) return s;
    }
    {
        Progress progress(arguments.quiet || arguments.json);
        arguments.options.progress = [&](double fraction) { progress.show("verify", fraction); };
        bake::verifyAsset(asset.view, arguments.options, report);
    }
    if (arguments.json)
        printJson(report);
    else if (!arguments.quiet)
        printText(arguments.file, report);
    if (report.ok()) return {};
    return {bake::Outcome::promiseBroken, fmt::format("{}: a promise is broken", arguments.file)};
}

} // namespace

void addVerify(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* verify = app.add_subcommand("verify", "Check an asset's promises over uniform and random states");
    verify->add_option("FILE", arguments->file, "An .xgc file")->required();
    verify->add_option("--source", arguments->source, "The model it was baked from: level 0 must equal it");
    verify->add_option("--weld", arguments->weldTolerance, "Grid spacing that the bake welded with")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    verify->add_option("--states", arguments->options.states, "Random states besides the uniform ones")
        ->check(CLI::Range(0u, 1000000u))
        ->capture_default_str();
    verify->add_option("--seed", arguments->options.seed, "Of the random states")->capture_default_str();
    verify->add_option("--error-states", arguments->options.errorStates, "States whose error is sampled; 0: none")
        ->capture_default_str();
    verify->add_flag("--error", arguments->error,
                     "Sample the error of all states, uniform and random, and measure how tight the errors are");
    verify->add_option("--jobs", arguments->jobs, "Threads; 0: all cores")->capture_default_str();
    verify->add_flag("--json", arguments->json, "Print JSON (documented in tools/README.md)");
    verify->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
    verify->footer("Example: xgc verify creature.xgc --source creature.glb --states 100");
    verify->callback([arguments, &run] { run = [arguments] { return runVerify(*arguments); }; });
}

} // namespace xgc::tool
