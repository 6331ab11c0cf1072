#include "commands.h"
#include "eval_pictures.h"
#include "progress.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/evaluate.h>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

namespace xgc::tool {
namespace {

struct EvalArguments {
    std::string off, seg, models, partsCount = "automatic", json, pictures;
    std::vector<std::string> presets, labels;
    uint32_t jobs = 0;
    bool quiet = false;
    bool jsonAsked = false;
    bake::EvalOptions options;
};

std::string presetNames() {
    std::string names;
    for (const bake::SegmentPreset& preset : bake::segmentPresets()) {
        if (!names.empty()) names += ", ";
        names += preset.name;
    }
    return names;
}

bake::Status addPresets(const EvalArguments& arguments, std::vector<bake::EvalMethod>& methods) {
    const auto presets = bake::segmentPresets();
    for (const std::string& name : arguments.presets) {
        const auto found = std::find_if(presets.begin(), presets.end(), [&](const auto& p) { return p.name == name; });
        if (found == presets.end()) {
            return bake::usageError(fmt::format("--preset {}: expected one of {}", name, presetNames()));
        }
        methods.push_back(bake::presetMethod(*found));
    }
    return {};
}

bake::Status addLabels(const EvalArguments& arguments, std::vector<bake::EvalMethod>& methods) {
    for (const std::string& argument : arguments.labels) {
        const size_t equals = argument.find('=');
        const std::string folder = equals == std::string::npos ? argument : argument.substr(equals + 1);
        const std::string name = equals == std::string::npos ? "labels" : argument.substr(0, equals);
        if (name.empty() || folder.empty()) {
            return bake::usageError(fmt::format("--labels {}: expected NAME=DIR, or DIR", argument));
        }
        if (bake::Status s = bake::labelsMethod(name, folder, methods.emplace_back()); !s.ok()) return s;
    }
    return {};
}

bake::Status findMethods(EvalArguments& arguments) {
    std::vector<bake::EvalMethod>& methods = arguments.options.methods;
    if (arguments.presets.empty() && arguments.labels.empty()) {
        arguments.presets.emplace_back(bake::segmentPresets().front().name);
    }
    if (bake::Status s = addPresets(arguments, methods); !s.ok()) return s;
    if (bake::Status s = addLabels(arguments, methods); !s.ok()) return s;
    for (size_t m = 0; m < methods.size(); ++m) {
        const auto sameName = [&](const bake::EvalMethod& other) { return other.name == methods[m].name; };
        if (std::none_of(methods.begin(), methods.begin() + std::ptrdiff_t(m), sameName)) continue;
        return bake::usageError(
            fmt::format("two methods are called '{}': give each --preset once and each --labels a NAME of its own",
                        methods[m].name));
    }
    return {};
}

bake::Status parsePartsCount(EvalArguments& arguments) {
    const std::string& text = arguments.partsCount;
    if (text == "automatic") return {};
    if (text == "ground-truth") {
        arguments.options.partsCount = bake::PartsCount::people;
        return {};
    }
    uint32_t& count = arguments.options.fixedPartsCount;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || end != text.data() + text.size() || count == 0) {
        return bake::usageError(
            fmt::format("--parts-count {}: expected automatic, ground-truth or a number from 1 on", text));
    }
    arguments.options.partsCount = bake::PartsCount::fixed;
    return {};
}

bake::Status report(const EvalArguments& arguments, const bake::Evaluation& evaluation) {
    if (!arguments.json.empty()) {
        const std::string json = bake::evaluationJson(evaluation);
        if (bake::Status s = bake::writeFileAtomically(arguments.json, std::as_bytes(std::span(json))); !s.ok())
            return s;
    } else if (arguments.jsonAsked) {
        fmt::print("{}", bake::evaluationJson(evaluation));
        return {};
    }
    if (!arguments.quiet) fmt::print("{}", bake::evaluationTable(evaluation));
    return {};
}

bake::Status runPsb(EvalArguments& arguments) {
    std::optional<tbb::global_control> limit;
    if (arguments.jobs > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, arguments.jobs);
    bake::EvalOptions& options = arguments.options;
    options.folders = {arguments.off, arguments.seg};
    if (bake::Status s = findMethods(arguments); !s.ok()) return s;
    if (bake::Status s = parsePartsCount(arguments); !s.ok()) return s;
    if (bake::Status s = bake::listPsbModels(arguments.off, arguments.models, options.numbers); !s.ok()) return s;
    std::optional<EvalPictures> pictures;
    if (!arguments.pictures.empty()) {
        pictures.emplace(arguments.pictures, options);
        if (bake::Status s = pictures->begin(); !s.ok()) return s;
        options.visit = [&](const auto& model, auto labels) { return pictures->draw(model, labels); };
    }
    bake::Evaluation evaluation;
    {
        Progress progress(arguments.quiet);
        options.progress = [&](double fraction) { progress.show("eval", fraction); };
        if (bake::Status s = bake::evaluate(options, evaluation); !s.ok()) return s;
    }
    if (pictures) {
        if (bake::Status s = pictures->finish(); !s.ok()) return s;
    }
    return report(arguments, evaluation);
}

} // namespace

void addEval(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<EvalArguments>();
    CLI::App* eval = app.add_subcommand("eval", "Measure segmentations against people's");
    eval->require_subcommand(1);
    CLI::App* psb = eval->add_subcommand("psb", "On the Princeton segmentation benchmark");
    psb->add_option("--off", arguments->off, "Folder of its models: 1.off, 2.off, ...")->required();
    psb->add_option("--seg", arguments->seg, "Folder of people's labels: 1/1_0.seg, 1/1_1.seg, ...")->required();
    psb->add_option("--models", arguments->models, "Some models: numbers, ranges and categories, as 1-20,Cup,61");
    psb->add_option("--preset", arguments->presets, "A way of finding parts: " + presetNames() + "; may be repeated");
    psb->add_option("--labels", arguments->labels,
                    "Labels made elsewhere, NAME=DIR: DIR/1.seg, ... (seconds in DIR/seconds.txt); may be repeated");
    psb->add_option("--parts-count", arguments->partsCount,
                    "automatic, ground-truth (as people most often have) or a number")
        ->capture_default_str();
    psb->add_option("--jobs", arguments->jobs, "Threads; 0: all cores (1 for seconds to compare)")
        ->capture_default_str();
    CLI::Option* json = psb->add_option("--json", arguments->json, "Write JSON to a file; without a name print it");
    json->expected(0, 1);
    psb->add_option(
        "--pictures", arguments->pictures,
        "Folder for a picture of each model's parts beside two people's, and contact.png of all categories");
    psb->add_flag("--quiet", arguments->quiet, "Print nothing but errors, and JSON if asked for");
    const std::string example = "Example: xgc eval psb --off psb/off --seg psb/seg --preset thesis --models 1-20,Cup";
    eval->footer(example);
    psb->footer(example);
    psb->callback([arguments, json, &run] {
        arguments->jsonAsked = json->count() > 0;
        run = [arguments] { return runPsb(*arguments); };
    });
}

} // namespace xgc::tool
