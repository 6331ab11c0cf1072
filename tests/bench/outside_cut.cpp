#include "outside_cut.h"

#include <xgc/indices.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace xgc::bench {
namespace {

template <typename T>
void put(std::ofstream& out, const T* values, size_t count) {
    out.write(reinterpret_cast<const char*>(values), std::streamsize(count * sizeof(T)));
}

template <typename T>
bool get(std::ifstream& in, T* values, size_t count) {
    return bool(in.read(reinterpret_cast<char*>(values), std::streamsize(count * sizeof(T))));
}

/// Unit normals of the rows; zero where the asset has none.
std::vector<glm::vec3> normalsOf(const AssetView& asset) {
    std::vector<glm::vec3> out(asset.positions.size(), glm::vec3(0));
    for (uint32_t i = 0; i < asset.vertexStreamCount; ++i) {
        const VertexStream& stream = asset.vertexStreams[i];
        if (stream.kind != format::StreamKind::normal || stream.format != format::StreamFormat::snorm16x2) continue;
        for (uint32_t row = 0; row < stream.count; ++row) {
            int16_t packed[2];
            std::memcpy(packed, stream.bytes.data() + size_t(row) * stream.stride, sizeof(packed));
            const glm::vec2 e = glm::max(glm::vec2(packed[0], packed[1]) / 32767.0f, glm::vec2(-1));
            glm::vec3 n(e, 1 - std::fabs(e.x) - std::fabs(e.y));
            const float fold = std::max(-n.z, 0.0f);
            n.x += n.x >= 0 ? -fold : fold;
            n.y += n.y >= 0 ? -fold : fold;
            out[row] = glm::normalize(n);
        }
    }
    return out;
}

void writeMesh(const std::filesystem::path& file, const AssetView& asset) {
    const std::vector<uint8_t> finest(asset.patchCount(), 0);
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices, own;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        own.resize(indexCapacity(asset, p, finest));
        own.resize(buildIndices(asset, p, finest, scratch, own));
        indices.insert(indices.end(), own.begin(), own.end());
    }
    const uint32_t counts[] = {uint32_t(asset.positions.size()), uint32_t(indices.size())};
    std::ofstream out(file, std::ios::binary);
    put(out, counts, 2);
    put(out, asset.positions.data(), asset.positions.size());
    const std::vector<glm::vec3> normals = normalsOf(asset);
    put(out, normals.data(), normals.size());
    put(out, indices.data(), indices.size());
}

bool readCuts(const std::filesystem::path& file, size_t count, std::vector<OutsideCut>& cuts) {
    std::ifstream in(file, std::ios::binary);
    cuts.assign(count, {});
    for (OutsideCut& cut : cuts) {
        uint32_t counts[2];
        if (!get(in, counts, 2) || !get(in, &cut.microseconds, 1)) return false;
        cut.clusterCount = counts[0];
        cut.indices.resize(counts[1]);
        if (!get(in, cut.indices.data(), cut.indices.size())) return false;
    }
    return true;
}

} // namespace

OutsideCamera outsideCamera(const Placement& placement, const View& view, float pixels) {
    const glm::mat3 linear(placement.toWorld);
    const glm::vec3 eye = glm::inverse(linear) * (view.eye - placement.toWorld[3]);
    // Errors and distances scale alike, so a pixel stays a pixel.
    return {{eye.x, eye.y, eye.z}, view.pixelsPerUnit, view.nearest / placement.maxScale, pixels};
}

bake::Status runOutsideCut(const std::string& command, const AssetView& asset,
                           const std::vector<OutsideCamera>& cameras, std::vector<OutsideCut>& cuts) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / fmt::format("xgc-cut-{}", uint32_t(getpid()));
    std::filesystem::create_directories(folder);
    writeMesh(folder / "mesh.bin", asset);
    {
        std::ofstream out(folder / "cameras.bin", std::ios::binary);
        const auto count = uint32_t(cameras.size());
        put(out, &count, 1);
        put(out, cameras.data(), cameras.size());
    }
    const bool ran = std::system(fmt::format("{} '{}'", command, folder.string()).c_str()) == 0;
    const bool read = ran && readCuts(folder / "cut.bin", cameras.size(), cuts);
    std::filesystem::remove_all(folder);
    return read ? bake::Status{} : bake::systemError(fmt::format("{}: failed, or wrote no cuts", command));
}

CutAsset::CutAsset(const AssetView& source, const std::vector<uint32_t>& indices) : view(source), corners_(indices) {
    const auto rows = uint32_t(source.positions.size()), faces = uint32_t(indices.size() / 3);
    record_ = *source.record;
    record_.levelCount = record_.listCount = record_.patchCount = record_.partCount = 1;
    record_.domainCount = 0;
    record_.faceCount = record_.maxPatchFaces = faces;
    record_.maxPatchSlots = rows;
    level_.faceCount = faces;
    patch_ = source.patches[0];
    patch_.part = patch_.firstDomain = patch_.domainCount = patch_.firstCorner = patch_.firstParent = 0;
    patch_.slotCount = rows;
    patch_.faceCount = patch_.listedFaceCount = faces;
    patch_.flags = format::kWideSlots;
    part_ = source.parts[0];
    part_.firstPatch = 0;
    part_.patchCount = 1;
    part_.firstNeighbour = part_.neighbourCount = 0;
    list_ = {0, faces};
    range_ = {0, rows};
    collapse_.assign(rows, format::kNever);
    parents_.assign(rows, 0);

    view.record = &record_;
    view.levels = {&level_, 1};
    view.domains = {};
    view.domainPatches = view.patchDomains = view.patchSlots = {};
    view.vertexRanges = {&range_, 1};
    view.patches = {&patch_, 1};
    view.patchErrors = {&error_, 1};
    view.patchFaceCounts = {};
    view.faceLists = {&list_, 1};
    view.parts = {&part_, 1};
    view.partNeighbours = {};
    view.contours = {};
    view.partShapes = {};
    view.merges = {};
    view.collapseLevels = collapse_;
    view.birthLevels = {};
    view.parentsWide = parents_;
    view.cornersWide = corners_;
    view.parentsNarrow = view.cornersNarrow = {};
}

} // namespace xgc::bench
