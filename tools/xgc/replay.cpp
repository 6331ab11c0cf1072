#include "commands.h"
#include "open_asset.h"

#include <xgc/bake/flight.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace xgc::tool {
namespace {

struct ReplayArguments {
    std::string file;
    bool json = false;
    bool quiet = false;
};

/// As given, or beside the flight.
std::filesystem::path assetFile(const std::filesystem::path& flight, const std::string& name) {
    const std::filesystem::path beside = flight.parent_path() / name;
    return std::filesystem::exists(beside) ? beside : std::filesystem::path(name);
}

bake::Status openAssets(const std::string& file, const bake::Flight& flight,
                        std::vector<std::unique_ptr<OpenAsset>>& assets) {
    for (const bake::Flight::Asset& wanted : flight.assets) {
        const std::string name = assetFile(file, wanted.file).string();
        assets.push_back(std::make_unique<OpenAsset>());
        const bake::Status status = openAsset(name, *assets.back());
        if (!status.ok()) return status;
        if (bake::imageHash(assets.back()->view) != wanted.hash) {
            return bake::badInput(fmt::format("{}: another asset than the flight {} was recorded with: bake that one "
                                              "again, or record the flight again",
                                              name, file));
        }
    }
    return {};
}

void report(const ReplayArguments& arguments, const bake::Flight& flight, const std::vector<uint32_t>& differing) {
    if (arguments.json) {
        const nlohmann::ordered_json json{
            {"frames", flight.frames.size()}, {"instances", flight.instances.size()}, {"differing", differing}};
        fmt::print("{}\n", json.dump(2));
    } else if (!arguments.quiet) {
        fmt::print("{}: {} frames of {} instances, {}\n", arguments.file, flight.frames.size(), flight.instances.size(),
                   differing.empty() ? "all as recorded"
                                     : fmt::format("{} differ, the first is {}", differing.size(), differing.front()));
    }
}

bake::Status replay(const ReplayArguments& arguments) {
    bake::Flight flight;
    bake::Status status = bake::readFlight(arguments.file, flight);
    std::vector<std::unique_ptr<OpenAsset>> assets;
    if (status.ok()) status = openAssets(arguments.file, flight, assets);
    if (!status.ok()) return status;
    std::vector<const AssetView*> views;
    for (const auto& asset : assets) views.push_back(&asset->view);
    std::vector<uint32_t> differing;
    status = bake::replayFlight(flight, views, differing);
    if (!status.ok()) return status;
    report(arguments, flight, differing);
    return differing.empty() ? bake::Status{} : bake::Status{bake::Outcome::promiseBroken, "frames differ"};
}

} // namespace

void addReplay(CLI::App& app, Run& run) {
    const auto arguments = std::make_shared<ReplayArguments>();
    CLI::App* command = app.add_subcommand("replay", "Play a recorded flight again and compare every frame");
    command->footer("Example: xgc_headless creature.xgc -o frames --record flight.json; xgc replay flight.json\n"
                    "Levels, draws and copies must be the same to the bit. Exit code 1 where a frame differs.");
    command->add_option("flight", arguments->file, "The flight, as xgc_headless --record writes it")->required();
    command->add_flag("--json", arguments->json, "Print the result as JSON");
    command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
    command->callback([arguments, &run] { run = [arguments] { return replay(*arguments); }; });
}

} // namespace xgc::tool
