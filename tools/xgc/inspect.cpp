#include "commands.h"
#include "open_asset.h"

#include <xgc/bake/asset_sizes.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>

namespace xgc::tool {
namespace {

using Json = nlohmann::ordered_json;

const char* codecName(format::Codec codec) {
    constexpr const char* kNames[] = {"none", "zstd", "meshopt", "rows", "faces", "parents"};
    return uint32_t(codec) < std::size(kNames) ? kNames[uint32_t(codec)] : "unknown";
}

/// Bytes of the installed image: the tables and the decoded pages.
uint64_t memoryBytes(const AssetView& asset) {
    uint64_t bytes = reinterpret_cast<const format::FileHeader*>(asset.bytes.data())->tableBytes;
    for (const format::PageRecord& page : asset.pages) bytes += page.rawBytes;
    return bytes;
}

/// Bytes of the plain mesh: float3 positions of level 0's vertices and u32 indices.
uint64_t baseBytes(const AssetView& asset) {
    return 12ull * asset.record->baseVertexCount + 12ull * asset.record->faceCount;
}

/// Bytes of positions and topology with all levels: what stands against the plain mesh.
uint64_t geometryBytes(const AssetView& asset) {
    uint64_t bytes = memoryBytes(asset);
    for (const format::StreamRecord& s : asset.streams) {
        const bool isAttribute = s.kind >= format::StreamKind::normal && s.kind <= format::StreamKind::weights;
        if (isAttribute) bytes -= s.rawBytes;
    }
    return bytes;
}

Json boxJson(const format::PartShape& shape) {
    return {{"center", shape.boxCenter}, {"axes", shape.boxAxes}, {"halfSizes", shape.boxHalfSizes}};
}

Json mergesJson(const AssetView& asset) {
    Json merges = Json::array();
    for (const format::MergeRecord& m : asset.merges) merges.push_back({{"a", m.a}, {"b", m.b}, {"cost", m.cost}});
    return merges;
}

Json partsJson(const AssetView& asset) {
    Json parts = Json::array();
    for (uint32_t p = 0; p < asset.parts.size(); ++p) {
        const format::PartRecord& part = asset.parts[p];
        parts.push_back({{"id", p},
                         {"name", std::string(asset.text(part.name))},
                         {"stableId", fmt::format("{:016x}", part.stableId)},
                         {"faces", part.faceCount},
                         {"firstPatch", part.firstPatch},
                         {"patches", part.patchCount},
                         {"area", part.area},
                         {"centroid", {part.centroid[0], part.centroid[1], part.centroid[2]}},
                         {"neighbours", asset.neighboursOf(p)}});
        if (!asset.contours.empty()) parts.back()["contours"] = asset.contoursOf(p);
        if (asset.partShapes.empty()) continue;
        parts.back()["box"] = boxJson(asset.partShapes[p]);
        parts.back()["salience"] = asset.partShapes[p].salience;
    }
    return parts;
}

Json inspectJson(const OpenAsset& opened) {
    const AssetView& asset = opened.view;
    const format::AssetRecord& record = *asset.record;
    Json json;
    json["faces"] = record.faceCount;
    json["vertices"] = record.baseVertexCount;
    json["positions"] = record.positionCount;
    json["madeVertices"] = record.vertexCount - record.baseVertexCount;
    json["parts"] = record.partCount;
    json["patches"] = record.patchCount;
    json["domains"] = record.domainCount;
    json["materials"] = record.materialCount;
    json["closed"] = (record.flags & format::kInputIsClosed) != 0;
    json["errorIsEstimate"] = (record.flags & format::kErrorIsEstimate) != 0;
    json["bounds"] = {{"min", record.boundsMin},
                      {"max", record.boundsMax},
                      {"center", record.sphereCenter},
                      {"radius", record.sphereRadius}};
    json["levels"] = Json::array();
    for (const format::LevelRecord& level : asset.levels) {
        json["levels"].push_back({{"faces", level.faceCount}, {"error", level.maxError}});
    }
    json["bytes"] = {{"file", opened.fileBytes},
                     {"memory", memoryBytes(asset)},
                     {"geometry", geometryBytes(asset)},
                     {"base", baseBytes(asset)}};
    json["streams"] = Json::array();
    for (const format::StreamRecord& s : opened.streams) {
        json["streams"].push_back({{"name", bake::streamName(s.kind)},
                                   {"set", s.set},
                                   {"count", s.count},
                                   {"bytes", s.rawBytes},
                                   {"codec", codecName(s.codec)},
                                   {"storedBytes", s.storedBytes}});
    }
    json["positionStep"] = record.positionStep;
    json["partList"] = partsJson(asset);
    json["merges"] = mergesJson(asset);
    json["provenance"] = Json::parse(asset.provenance, nullptr, false);
    if (json["provenance"].is_discarded()) json["provenance"] = nullptr;
    return json;
}

void printStreams(const OpenAsset& opened, double faces) {
    fmt::print("{:>16} {:>8} {:>18} {:>18}\n", "stream", "codec", "stored bytes/face", "in memory");
    for (const format::StreamRecord& s : opened.streams) {
        fmt::print("{:>14} {} {:>8} {:>18.2f} {:>18.2f}\n", bake::streamName(s.kind), s.set, codecName(s.codec),
                   double(s.storedBytes) / faces, double(s.rawBytes) / faces);
    }
}

std::string vectorText(const float (&v)[3]) {
    return fmt::format("({:.4g} {:.4g} {:.4g})", v[0], v[1], v[2]);
}

void printPart(const AssetView& asset, uint32_t p) {
    const format::PartRecord& part = asset.parts[p];
    fmt::print("{}  {}: {} faces, area {:.4g}, centroid {}\n", p, asset.text(part.name), part.faceCount, part.area,
               vectorText(part.centroid));
    if (!asset.partShapes.empty()) {
        const format::PartShape& shape = asset.partShapes[p];
        fmt::print("    box at {}, half sizes {}, along {} {} {}\n", vectorText(shape.boxCenter),
                   vectorText(shape.boxHalfSizes), vectorText(shape.boxAxes[0]), vectorText(shape.boxAxes[1]),
                   vectorText(shape.boxAxes[2]));
        fmt::print("    salience {:.3f}\n", shape.salience);
    }
    const std::span<const uint32_t> neighbours = asset.neighboursOf(p);
    const std::span<const float> contours = asset.contoursOf(p);
    for (size_t n = 0; n < neighbours.size(); ++n) {
        fmt::print("    beside {} {}", neighbours[n], asset.text(asset.parts[neighbours[n]].name));
        if (!contours.empty()) fmt::print(": contour {:.4g}", contours[n]);
        fmt::print("\n");
    }
}

void printPartList(const AssetView& asset) {
    for (uint32_t p = 0; p < asset.parts.size(); ++p) printPart(asset, p);
    if (asset.merges.empty()) {
        fmt::print("no parts join\n");
        return;
    }
    fmt::print("{:>6} {:>8}  {}\n", "parts", "cost", "by joining");
    auto left = uint32_t(asset.parts.size());
    for (const format::MergeRecord& m : asset.merges) {
        fmt::print("{:>6} {:>8.3f}  {} {} and {} {}\n", --left, m.cost, m.a, asset.text(asset.parts[m.a].name), m.b,
                   asset.text(asset.parts[m.b].name));
    }
}

void printText(const std::string& file, const OpenAsset& opened) {
    const AssetView& asset = opened.view;
    const format::AssetRecord& record = *asset.record;
    const double faces = std::max(1u, record.faceCount);
    fmt::print("{}: {} faces, {} vertices ({} positions, {} made), {} parts, {} patches, {}\n", file, record.faceCount,
               record.baseVertexCount, record.positionCount, record.vertexCount - record.baseVertexCount,
               record.partCount, record.patchCount, record.flags & format::kInputIsClosed ? "closed" : "open");
    fmt::print("bytes a face: file {:.1f}, memory {:.1f}, positions and topology {:.1f}, plain mesh {:.1f}\n",
               double(opened.fileBytes) / faces, double(memoryBytes(asset)) / faces,
               double(geometryBytes(asset)) / faces, double(baseBytes(asset)) / faces);
    if (record.positionStep > 0) fmt::print("positions on a grid of {:.4g}\n", record.positionStep);
    printStreams(opened, faces);
    fmt::print("{:>6} {:>12} {:>8} {:>12}\n", "level", "faces", "%", "error");
    for (uint32_t l = 0; l < asset.levelCount(); ++l) {
        fmt::print("{:>6} {:>12} {:>8.2f} {:>12.4g}\n", l, asset.levels[l].faceCount,
                   100 * asset.levels[l].faceCount / faces, asset.levels[l].maxError);
    }
    if (record.flags & format::kErrorIsEstimate) fmt::print("errors are estimates, not bounds\n");
    fmt::print("{:>6} {:>10} {:>8} {:>10}  {}\n", "part", "faces", "patches", "neighbours", "name");
    for (uint32_t p = 0; p < record.partCount; ++p) {
        const format::PartRecord& part = asset.parts[p];
        fmt::print("{:>6} {:>10} {:>8} {:>10}  {}\n", p, part.faceCount, part.patchCount, part.neighbourCount,
                   asset.text(part.name));
    }
}

struct InspectArguments {
    std::string file;
    bool json = false;
    bool parts = false;
};

bake::Status runInspect(const InspectArguments& arguments) {
    OpenAsset asset;
    if (bake::Status s = openAsset(arguments.file, asset); !s.ok()) return s;
    if (arguments.json)
        fmt::print("{}\n", inspectJson(asset).dump(2, ' ', false, Json::error_handler_t::replace));
    else if (arguments.parts)
        printPartList(asset.view);
    else
        printText(arguments.file, asset);
    return {};
}

} // namespace

void addInspect(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<InspectArguments>();
    CLI::App* inspect = app.add_subcommand("inspect", "Print what an asset holds: sizes, levels, parts");
    inspect->add_option("FILE", arguments->file, "An .xgc file")->required();
    inspect->add_flag("--json", arguments->json, "Print JSON (documented in tools/README.md)");
    inspect->add_flag("--parts", arguments->parts,
                      "Print each part's area, centroid, box, salience and contours, and how parts would join");
    inspect->footer("Example: xgc inspect creature.xgc");
    inspect->callback([arguments, &run] { run = [arguments] { return runInspect(*arguments); }; });
}

} // namespace xgc::tool
