#include "commands.h"
#include "open_asset.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/export.h>
#include <xgc/bake/from_asset.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

namespace xgc::tool {
namespace {

struct Options {
    std::string input;
    std::string output;
    std::optional<uint64_t> level;
    std::vector<uint64_t> levels;
    std::optional<uint64_t> random;
    bool quiet = false;
};

/// SplitMix64, by S. Vigna: the same states from a seed on any machine.
uint64_t nextRandom(uint64_t& state) {
    uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

bake::Status chooseLevels(const Options& options, const AssetView& asset, std::vector<uint8_t>& out) {
    const uint32_t count = asset.levelCount();
    const auto tooHigh = [&](const char* option, uint64_t level) {
        return bake::usageError(fmt::format("{} {}: {} has levels 0 to {}", option, level, options.input, count - 1));
    };
    if (options.random) {
        uint64_t state = *options.random;
        for (uint32_t p = 0; p < asset.patchCount(); ++p) out.push_back(uint8_t(nextRandom(state) % count));
        return {};
    }
    if (options.levels.empty()) {
        const uint64_t level = options.level.value_or(0);
        if (level >= count) return tooHigh("--level", level);
        out.assign(asset.patchCount(), uint8_t(level));
        return {};
    }
    if (options.levels.size() != asset.patchCount()) {
        return bake::usageError(fmt::format("--levels: {} given, {} has {} patches and wants one for each",
                                            options.levels.size(), options.input, asset.patchCount()));
    }
    for (const uint64_t level : options.levels) {
        if (level >= count) return tooHigh("--levels", level);
        out.push_back(uint8_t(level));
    }
    return {};
}

bake::Status extract(const Options& options) {
    bake::Status status = bake::checkExportName(options.output);
    OpenAsset opened;
    if (status.ok()) status = openAsset(options.input, opened);
    if (!status.ok()) return status;
    const AssetView& asset = opened.view;
    std::vector<uint8_t> levels;
    bake::Model model;
    status = chooseLevels(options, asset, levels);
    if (status.ok()) status = bake::modelFromAsset(asset, levels, model);
    if (status.ok() && model.triangles.empty()) {
        return bake::badInput(fmt::format("{}: no face is left at these levels: ask for finer ones", options.input));
    }
    if (status.ok()) status = bake::exportModel(model, options.output);
    if (status.ok() && !options.quiet) {
        fmt::print(stderr, "{}: {} faces, {} vertices\n", options.output, model.triangles.size(),
                   model.positions.size());
    }
    return status;
}

} // namespace

void addExtract(CLI::App& app, Run& run) {
    CLI::App* sub = app.add_subcommand("extract", "Write the surface of an asset at a state for other tools");
    const auto options = std::make_shared<Options>();
    sub->add_option("input", options->input, "Asset (.xgc)")->required();
    sub->add_option("-o,--output", options->output, "File to write: .glb, .obj or .ply")->required();
    auto* level = sub->add_option("--level", options->level, "One level for all patches (default 0)");
    auto* levels =
        sub->add_option("--levels", options->levels, "A level for each patch, by patch id: 0,2,1,...")->delimiter(',');
    auto* random = sub->add_option("--random", options->random, "Random levels from this seed");
    level->excludes(levels)->excludes(random);
    levels->excludes(random);
    sub->add_flag("--quiet", options->quiet, "Print nothing but errors");
    sub->footer("Example: xgc extract dragon.xgc -o dragon.ply --level 3");
    sub->callback([options, &run] { run = [options] { return extract(*options); }; });
}

} // namespace xgc::tool
