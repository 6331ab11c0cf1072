#include "models.h"

#include <xgc/bake/import.h>
#include <xgc/bake/models.h>
#include <xgc/bake/normals.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>

namespace xgc::bench {
namespace {

Source princeton(const std::filesystem::path& data, uint32_t number) {
    return {fmt::format("psb{}", number), data / "psb" / "off" / fmt::format("{}.off", number)};
}

bake::BundledModel bundledModel(const std::string& name) {
    using bake::BundledModel;
    constexpr std::array<std::pair<const char*, BundledModel>, 4> kOthers{{{"creature", BundledModel::creature},
                                                                           {"shaft", BundledModel::shaft},
                                                                           {"temple", BundledModel::temple},
                                                                           {"tree", BundledModel::tree}}};
    for (const auto& [other, which] : kOthers) {
        if (name == other) return which;
    }
    return BundledModel::terrain;
}

/// Grows regions breadth first from their seeds: region of each face and the order in which faces were reached.
std::vector<uint32_t> grow(const bake::Topology& topology, std::span<const uint32_t> seeds,
                           std::vector<uint32_t>& region) {
    std::vector<uint32_t> order(seeds.begin(), seeds.end());
    std::fill(region.begin(), region.end(), bake::kNone);
    for (uint32_t r = 0; r < seeds.size(); ++r) region[seeds[r]] = r;
    for (size_t i = 0; i < order.size(); ++i) {
        const glm::uvec3 edges = topology.faceEdges[order[i]];
        for (int k = 0; k < 3; ++k) {
            for (const uint32_t next : topology.facesOfEdge(edges[k])) {
                if (region[next] != bake::kNone) continue;
                region[next] = region[order[i]];
                order.push_back(next);
            }
        }
    }
    return order;
}

/// The face of each region farthest from its rim: the last one reached when growing inwards.
std::vector<uint32_t> middles(const bake::Topology& topology, std::span<const uint32_t> region,
                              std::span<const uint32_t> seeds) {
    std::vector<uint32_t> middle(seeds.begin(), seeds.end()), queue;
    std::vector<uint8_t> seen(region.size());
    const auto push = [&](uint32_t face) {
        if (seen[face]) return;
        seen[face] = 1;
        queue.push_back(face);
    };
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const auto faces = topology.facesOfEdge(e);
        const bool rim = std::ranges::any_of(faces, [&](uint32_t f) { return region[f] != region[faces[0]]; });
        if (rim) std::ranges::for_each(faces, push);
    }
    for (size_t i = 0; i < queue.size(); ++i) {
        const uint32_t face = queue[i];
        if (region[face] != bake::kNone) middle[region[face]] = face;
        for (int k = 0; k < 3; ++k) {
            for (const uint32_t next : topology.facesOfEdge(topology.faceEdges[face][k])) {
                if (region[next] == region[face]) push(next);
            }
        }
    }
    return middle;
}

} // namespace

std::vector<Source> princetonSample(const std::filesystem::path& data) {
    constexpr std::array<uint32_t, 20> kNumbers{16,  27,  50,  67,  93,  113, 136, 144, 170, 187,
                                                207, 230, 259, 284, 304, 310, 324, 350, 370, 390};
    std::vector<Source> sources;
    for (const uint32_t n : kNumbers) sources.push_back(princeton(data, n));
    return sources;
}

std::vector<Source> princetonAll(const std::filesystem::path& data) {
    std::vector<Source> sources;
    for (uint32_t n = 1; n <= 400; ++n) {
        if (Source s = princeton(data, n); std::filesystem::exists(s.file)) sources.push_back(std::move(s));
    }
    return sources;
}

Source helmet(const std::filesystem::path& data) {
    return {"helmet", data / "gltf/FlightHelmet/FlightHelmet.gltf"};
}

std::vector<Source> dragon() {
    const std::filesystem::path file = std::filesystem::path(XGC_SOURCE_DIR) / "build/npm/dragon.ply";
    if (!std::filesystem::exists(file)) return {};
    return {{"dragon", file}};
}

bake::Status load(const Source& source, Subject& out) {
    bake::Model model;
    if (!source.file.empty()) {
        if (bake::Status s = bake::importModel(source.file, model); !s.ok()) return s;
    } else {
        model = bake::makeModel(bundledModel(source.name), source.faces);
    }
    out.name = source.name;
    if (source.plain) model.attributes = {};
    if (bake::Status s = bake::weld(model, {}, out.mesh, out.weld); !s.ok()) return s;
    out.topology = bake::buildTopology(out.mesh);
    if (source.normals) bake::addMissingNormals(out.mesh, out.topology);
    out.parts = source.plain ? bake::segmentNone(out.mesh) : bake::segmentThesis(out.mesh, out.topology, {});
    return {};
}

bake::Segmentation randomPieces(const bake::Mesh& mesh, const bake::Topology& topology, uint32_t count) {
    constexpr int kRounds = 3;
    std::vector<uint32_t> seeds, region(mesh.faceCount());
    std::vector<uint32_t> faces(mesh.faceCount());
    for (uint32_t f = 0; f < faces.size(); ++f) faces[f] = f;
    std::minstd_rand random(1);
    for (uint32_t i = 0; i < std::min(count, mesh.faceCount()); ++i) { // drawn without repetition
        std::swap(faces[i], faces[i + random() % (faces.size() - i)]);
        seeds.push_back(faces[i]);
    }
    grow(topology, seeds, region);
    for (int round = 0; round < kRounds; ++round) {
        seeds = middles(topology, region, seeds);
        grow(topology, seeds, region);
    }
    bake::Segmentation pieces;
    std::vector<uint32_t> ofComponent(topology.componentCount, bake::kNone);
    auto next = uint32_t(seeds.size());
    for (uint32_t f = 0; f < region.size(); ++f) {
        if (region[f] != bake::kNone) continue;
        uint32_t& piece = ofComponent[topology.faceComponent[f]];
        if (piece == bake::kNone) piece = next++;
        region[f] = piece;
    }
    pieces.facePart = std::move(region);
    for (uint32_t p = 0; p < next; ++p) pieces.partNames.push_back(fmt::format("piece-{}", p));
    return pieces;
}

} // namespace xgc::bench
