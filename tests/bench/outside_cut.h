#pragma once

#include <xgc/asset.h>
#include <xgc/bake/status.h>
#include <xgc/select.h>

#include <string>
#include <vector>

namespace xgc::bench {

/// A view of a mesh, in its own space, for a program that is not part of this project.
struct OutsideCamera {
    float eye[3];
    float pixelsPerUnit; ///< a mesh unit at distance one
    float nearest;       ///< distances are at least this
    float pixels;        ///< of error
};
/// `placement` scales all directions alike.
OutsideCamera outsideCamera(const Placement& placement, const View& view, float pixels);

/// What it would draw.
struct OutsideCut {
    uint32_t clusterCount = 0;
    float microseconds = 0;        ///< to find them
    std::vector<uint32_t> indices; ///< vertex rows of the asset
};

/// Runs `command FOLDER`. Little-endian files in it: mesh.bin (u32 vertices, u32 indices, float3 positions and
/// float3 normals of the asset's rows, u32 indices of level 0), cameras.bin (u32 count, OutsideCamera[]); the command
/// writes cut.bin (a camera each: u32 clusters, u32 indices, float microseconds, u32[]).
bake::Status runOutsideCut(const std::string& command, const AssetView& asset,
                           const std::vector<OutsideCamera>& cameras, std::vector<OutsideCut>& cuts);

/// An asset of one patch and one level that draws given triangles with another's vertices, which outlive it.
class CutAsset {
public:
    CutAsset(const AssetView& source, const std::vector<uint32_t>& indices);
    CutAsset(const CutAsset&) = delete;

    AssetView view;

private:
    format::AssetRecord record_{};
    format::LevelRecord level_{};
    format::PatchRecord patch_{};
    format::PartRecord part_{};
    format::FaceList list_{};
    format::VertexRange range_{};
    float error_ = 0;
    std::vector<uint8_t> collapse_;
    std::vector<uint32_t> parents_, corners_;
};

} // namespace xgc::bench
