#include "peers.h"

#include <xgc/bake/export.h>
#include <xgc/bake/import.h>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cstdlib>

#include <unistd.h>

namespace xgc::bench {
namespace {

bake::Model modelOf(const Surface& s) {
    bake::Model model;
    model.positions = s.points;
    model.attributes.normals = s.normals;
    model.attributes.uvs[0] = s.uvs;
    model.triangles = s.triangles;
    model.triangleFace.resize(s.triangles.size());
    for (uint32_t f = 0; f < s.faceCount(); ++f) model.triangleFace[f] = f;
    model.triangleMaterial.assign(s.triangles.size(), 0);
    model.triangleNode.assign(s.triangles.size(), bake::kNone);
    model.inputFaceCount = s.faceCount();
    model.materials.resize(1);
    return model;
}

void report(const bake::Status& status) {
    if (!status.ok()) fmt::print(stderr, "{}\n", status.message);
}

} // namespace

Peers::Peers(const Flags& flags, const std::string& model, const Surface& surface)
    : flags_(flags), surface_(surface),
      work_(std::filesystem::temp_directory_path() / fmt::format("xgc-bench-{}-{}", model, getpid())) {
    std::filesystem::create_directories(work_);
    if (!flags.outside.empty()) report(writePly(work_ / "in.ply", surface));
    if (!flags.gltfpack.empty()) report(bake::exportModel(modelOf(surface), work_ / "in.glb"));
}

Peers::~Peers() {
    std::error_code ignored;
    std::filesystem::remove_all(work_, ignored);
}

Surface Peers::meshoptimizer(uint32_t faces) const {
    constexpr float kNoLimit = 1e10f;
    Surface out = surface_;
    const size_t indices = meshopt_simplify(
        &out.triangles[0].x, &surface_.triangles[0].x, 3 * surface_.triangles.size(), &surface_.points[0].x,
        surface_.points.size(), sizeof(glm::vec3), 3 * size_t(faces), kNoLimit, 0, nullptr);
    out.triangles.resize(indices / 3);
    return out;
}

bool Peers::gltfpack(uint32_t faces, Surface& out) const {
    const std::string command =
        fmt::format("'{}' -i '{}' -o '{}' -si {:.9f} -se 1 -noq -kv >/dev/null 2>&1", flags_.gltfpack.string(),
                    (work_ / "in.glb").string(), (work_ / "out.glb").string(), (faces + 0.5) / surface_.faceCount());
    bake::Model model;
    if (std::system(command.c_str()) != 0 || !bake::importModel(work_ / "out.glb", model).ok()) return false;
    out = surfaceOf(model);
    return true;
}

std::vector<Peer> Peers::at(uint32_t faces) const {
    std::vector<Peer> peers;
    peers.push_back({"meshopt_simplify 0.18", meshoptimizer(faces)});
    Surface surface;
    if (!flags_.gltfpack.empty() && gltfpack(faces, surface)) peers.push_back({"gltfpack", surface});
    if (!flags_.outside.empty()) addOutside(faces, peers);
    return peers;
}

void Peers::addOutside(uint32_t faces, std::vector<Peer>& peers) const {
    const std::filesystem::path folder = work_ / "outside";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    const std::string command =
        fmt::format("{} '{}' {} '{}'", flags_.outside, (work_ / "in.ply").string(), faces, folder.string());
    if (std::system(command.c_str()) != 0) fmt::print(stderr, "failed: {}\n", command);
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".ply") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    for (const std::filesystem::path& file : files) {
        Surface surface;
        const bake::Status read = readPly(file, surface);
        report(read);
        if (read.ok()) peers.push_back({file.stem().string(), std::move(surface)});
    }
}

} // namespace xgc::bench
