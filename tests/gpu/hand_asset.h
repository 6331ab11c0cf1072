#pragma once

#include <xgc/asset.h>

#include <glm/glm.hpp>

#include <algorithm>
#include <vector>

namespace xgc::test {

/// An asset view over triangles, without a file: one level, a patch for each run of `facesPerPatch` triangles, each
/// with corners of its own (three slots a face). For tests of drawing, not of levels.
class HandAsset {
public:
    HandAsset(const std::vector<glm::vec3>& points, const std::vector<glm::uvec3>& triangles, uint32_t facesPerPatch) {
        const auto faceCount = uint32_t(triangles.size());
        for (uint32_t first = 0; first < faceCount; first += facesPerPatch) {
            addPatch(points, {triangles.data() + first, std::min(facesPerPatch, faceCount - first)});
        }
        finishRecords(faceCount);
        finishView();
    }
    HandAsset(const HandAsset&) = delete;
    HandAsset& operator=(const HandAsset&) = delete;

    AssetView view;

private:
    void addPatch(const std::vector<glm::vec3>& points, std::span<const glm::uvec3> faces) {
        const auto slots = uint32_t(3 * faces.size());
        format::PatchRecord patch{};
        patch.slotCount = slots;
        patch.faceCount = patch.listedFaceCount = uint32_t(faces.size());
        patch.firstCorner = uint32_t(corners_.size());
        patch.firstParent = uint32_t(parents_.size());
        patch.flags = format::kWideSlots;
        ranges_.push_back({uint32_t(positions_.size()), slots});
        for (uint32_t i = 0; i < slots; ++i) {
            positions_.push_back(points[faces[i / 3][int(i % 3)]]);
            corners_.push_back(i);
            parents_.push_back(0);
        }
        patches_.push_back(patch);
        lists_.push_back({0, uint32_t(faces.size())});
    }

    void finishRecords(uint32_t faceCount) {
        record_.levelCount = 1;
        record_.listCount = 1;
        record_.patchCount = uint32_t(patches_.size());
        record_.partCount = 1;
        record_.materialCount = 1;
        record_.vertexCount = uint32_t(positions_.size());
        record_.faceCount = faceCount;
        for (const format::PatchRecord& p : patches_) {
            record_.maxPatchSlots = std::max(record_.maxPatchSlots, p.slotCount);
            record_.maxPatchFaces = std::max(record_.maxPatchFaces, p.faceCount);
        }
        std::fill_n(material_.baseColor, 4, 1.0f);
        material_.roughness = 1;
        part_.patchCount = record_.patchCount;
        collapse_.assign(positions_.size(), format::kNever);
        errors_.assign(patches_.size(), 0.0f);
    }

    void finishView() {
        view.record = &record_;
        view.vertexRanges = ranges_;
        view.patches = patches_;
        view.patchErrors = errors_;
        view.faceLists = lists_;
        view.parts = {&part_, 1};
        view.materials = {&material_, 1};
        view.positions = positions_;
        view.collapseLevels = collapse_;
        view.parentsWide = parents_;
        view.cornersWide = corners_;
        VertexStream& stream = view.vertexStreams[0];
        stream.kind = format::StreamKind::position;
        stream.format = format::StreamFormat::f32x3;
        stream.stride = sizeof(glm::vec3);
        stream.count = uint32_t(positions_.size());
        stream.bytes = std::as_bytes(view.positions);
        view.vertexStreamCount = 1;
    }

    format::AssetRecord record_{};
    format::MaterialRecord material_{};
    format::PartRecord part_{};
    std::vector<format::VertexRange> ranges_;
    std::vector<format::PatchRecord> patches_;
    std::vector<format::FaceList> lists_;
    std::vector<float> errors_;
    std::vector<glm::vec3> positions_;
    std::vector<uint8_t> collapse_;
    std::vector<uint32_t> parents_, corners_;
};

} // namespace xgc::test
