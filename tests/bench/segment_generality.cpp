#include "meshes/builders.h"
#include "perceptual_run.h"
#include "segment_sections.h"
#include "subjects.h"

#include <xgc/bake/import.h>
#include <xgc/bake/models.h>

#include <algorithm>
#include <functional>

namespace xgc::bench {
namespace {

/// A mesh of some kind, made when its turn comes.
struct Kind {
    std::string name;
    std::function<bake::Status(bake::Model&)> make;
};

Kind made(std::string name, std::function<bake::Model()> make) {
    return {std::move(name), [make = std::move(make)](bake::Model& model) {
                model = make();
                return bake::Status{};
            }};
}

Kind fromFile(const std::filesystem::path& file) {
    return {file.filename().string(), [file](bake::Model& model) { return bake::importModel(file, model); }};
}

bake::Model tetrahedron() {
    return test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

bake::Model triangle() {
    return test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
}

/// Radii of 1 and .35, n by n quads.
bake::Model torus(uint32_t n) {
    bake::Model sheet = test::grid(n);
    for (glm::vec3& p : sheet.positions) {
        const float u = 6.2831853f * (p.x < 1 ? p.x : 0), v = 6.2831853f * (p.y < 1 ? p.y : 0);
        const float out = 1 + 0.35f * std::cos(v);
        p = {out * std::cos(u), out * std::sin(u), 0.35f * std::sin(v)};
    }
    return sheet;
}

std::vector<Kind> simpleShapes() {
    return {made("triangle", triangle),
            made("tetrahedron", tetrahedron),
            made("cube", [] { return test::cube(1); }),
            made("cube, fine", [] { return test::cube(40); }),
            made("sphere", [] { return test::sphere(32); }),
            made("torus", [] { return torus(80); }),
            made("flat sheet", [] { return test::grid(80); })};
}

std::vector<Kind> bundledModels() {
    using bake::BundledModel;
    std::vector<Kind> kinds;
    const std::vector<std::pair<std::string, BundledModel>> models = {{"creature", BundledModel::creature},
                                                                      {"shaft", BundledModel::shaft},
                                                                      {"terrain", BundledModel::terrain},
                                                                      {"temple", BundledModel::temple},
                                                                      {"tree", BundledModel::tree}};
    for (const auto& [name, which] : models) {
        for (const uint32_t faces : {5'000u, 60'000u, 500'000u}) {
            kinds.push_back(made(name, [which = which, faces] { return bake::makeModel(which, faces); }));
        }
    }
    return kinds;
}

/// Every mesh of data/mesh and data/gltf, and the dragon.
std::vector<Kind> files(const Flags& flags) {
    std::vector<std::filesystem::path> found;
    for (const char* folder : {"mesh", "gltf"}) {
        std::error_code absent;
        for (const auto& entry : std::filesystem::directory_iterator(flags.data / folder, absent)) {
            if (entry.is_regular_file()) found.push_back(entry.path());
        }
    }
    std::ranges::sort(found);
    found.push_back(helmet(flags.data).file);
    for (const Source& source : dragon()) found.push_back(source.file);
    std::vector<Kind> kinds;
    for (const auto& file : found) kinds.push_back(fromFile(file));
    return kinds;
}

} // namespace

int sweepGenerality(const Flags& flags) {
    std::vector<Kind> kinds = simpleShapes();
    for (Kind& kind : bundledModels()) kinds.push_back(std::move(kind));
    if (!flags.data.empty()) {
        for (Kind& kind : files(flags)) kinds.push_back(std::move(kind));
    }
    fmt::print("{:<22} {:>8} {:>10} {:>6} {:>9}   (one thread)\n", "", "faces", "components", "parts", "seconds");
    bool failed = false;
    for (const Kind& kind : kinds) {
        if (!flags.wantsModel(kind.name)) continue;
        bake::Model model;
        PerceptualRun run;
        bake::Status status = kind.make(model);
        model.attributes = {};
        if (status.ok()) status = segmentOnce(model, 1, run);
        if (!status.ok()) {
            fmt::print("{:<22} FAILED: {}\n", kind.name, status.message);
            failed = true;
            continue;
        }
        fmt::print("{:<22} {:>8} {:>10} {:>6} {:>9.4f}\n", kind.name, run.mesh.faceCount(), run.topology.componentCount,
                   run.parts.partCount(), run.seconds);
    }
    return failed ? 1 : 0;
}

} // namespace xgc::bench
