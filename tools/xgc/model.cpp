#include "commands.h"

#include <xgc/bake/export.h>
#include <xgc/bake/models.h>

#include <fmt/format.h>

#include <map>
#include <memory>

namespace xgc::tool {
namespace {

const std::map<std::string, bake::BundledModel> kModels = {
    {"creature", bake::BundledModel::creature}, {"shaft", bake::BundledModel::shaft},
    {"terrain", bake::BundledModel::terrain},   {"temple", bake::BundledModel::temple},
    {"tree", bake::BundledModel::tree},
};

struct Options {
    std::string model;
    std::string output;
    uint64_t faces = 60000;
    bool quiet = false;
};

bake::Status makeAndWrite(const Options& options) {
    if (options.faces < bake::kLeastModelFaces || options.faces > bake::kMostModelFaces) {
        return bake::usageError(fmt::format("--faces {}: ask for {} to {} faces", options.faces, bake::kLeastModelFaces,
                                            bake::kMostModelFaces));
    }
    bake::Status status = bake::checkExportName(options.output);
    if (!status.ok()) return status;
    const bake::Model model = bake::makeModel(kModels.at(options.model), uint32_t(options.faces));
    status = bake::exportModel(model, options.output);
    if (status.ok() && !options.quiet) {
        fmt::print(stderr, "{}: {} faces, {} vertices, {} materials\n", options.output, model.triangles.size(),
                   model.positions.size(), model.materials.size());
    }
    return status;
}

} // namespace

void addModel(CLI::App& app, Run& run) {
    CLI::App* sub = app.add_subcommand("model", "Make one of the bundled models");
    const auto options = std::make_shared<Options>();
    sub->add_option("model", options->model, "creature, shaft, terrain, temple or tree")
        ->required()
        ->check(CLI::IsMember(std::vector<std::string>{"creature", "shaft", "terrain", "temple", "tree"}));
    sub->add_option("-o,--output", options->output, "File to write: .glb, .obj or .ply")->required();
    sub->add_option("--faces", options->faces, "About how many triangles")->capture_default_str();
    sub->add_flag("--quiet", options->quiet, "Print nothing but errors");
    sub->footer("Example: xgc model creature -o creature.glb --faces 200000");
    sub->callback([options, &run] { run = [options] { return makeAndWrite(*options); }; });
}

} // namespace xgc::tool
