#include "c_api.h"

#include <xgc/morph.h>
#include <xgc/parts.h>

namespace xgc::c {
namespace {

using namespace format;

static_assert(XGC_ERROR_IS_ESTIMATE == uint32_t(kErrorIsEstimate) && XGC_INPUT_IS_CLOSED == uint32_t(kInputIsClosed));
static_assert(XGC_DOUBLE_SIDED == uint32_t(kDoubleSided) && XGC_ALPHA_MASK == uint32_t(kAlphaMask));
static_assert(XGC_ALPHA_BLEND == uint32_t(kAlphaBlend));
static_assert(XGC_STREAM_POSITION == uint32_t(StreamKind::position) && XGC_STREAM_UV == uint32_t(StreamKind::uv));
static_assert(XGC_STREAM_NORMAL == uint32_t(StreamKind::normal) && XGC_STREAM_COLOR == uint32_t(StreamKind::color));
static_assert(XGC_STREAM_TANGENT == uint32_t(StreamKind::tangent) && XGC_STREAM_JOINTS == uint32_t(StreamKind::joints));
static_assert(XGC_STREAM_WEIGHTS == uint32_t(StreamKind::weights));
static_assert(XGC_FORMAT_U8 == uint32_t(StreamFormat::u8) && XGC_FORMAT_U16 == uint32_t(StreamFormat::u16));
static_assert(XGC_FORMAT_U32 == uint32_t(StreamFormat::u32) && XGC_FORMAT_F32X2 == uint32_t(StreamFormat::f32x2));
static_assert(XGC_FORMAT_F32X3 == uint32_t(StreamFormat::f32x3) && XGC_FORMAT_F32X4 == uint32_t(StreamFormat::f32x4));
static_assert(XGC_FORMAT_UNORM8X4 == uint32_t(StreamFormat::unorm8x4));
static_assert(XGC_FORMAT_U16X4 == uint32_t(StreamFormat::u16x4));
static_assert(XGC_FORMAT_SNORM16X2 == uint32_t(StreamFormat::snorm16x2));
static_assert(XGC_FORMAT_SNORM16X4 == uint32_t(StreamFormat::snorm16x4));

static_assert(sizeof(XgcMorphRow) == sizeof(MorphRow) && alignof(XgcMorphRow) == alignof(MorphRow));
static_assert(offsetof(XgcMorphRow, target) == offsetof(MorphRow, target));
static_assert(offsetof(XgcMorphRow, groupAndLevel) == offsetof(MorphRow, groupAndLevel));

constexpr const char* kNoPart = "no such part (the element)";

uint32_t maxPatchDomains(const AssetView& asset) {
    uint32_t most = 0;
    for (const PatchRecord& patch : asset.patches) most = std::max(most, patch.domainCount);
    return most;
}

/// For functions that fill a struct about one of `count` elements.
template <typename T>
Status checkElement(const T* out, uint32_t index, size_t count, const char* message) {
    const Status status = checkSize(out);
    if (!status.ok()) return status;
    return index < count ? Status{} : wrong(message, index);
}

} // namespace

AssetTable::~AssetTable() {
    for (uint32_t id = 0; id < assets_.size(); ++id) set(id, nullptr);
}

void AssetTable::set(uint32_t id, const XgcAsset* asset) {
    if (asset) asset->users.fetch_add(1);
    if (assets_[id]) assets_[id]->users.fetch_sub(1);
    assets_[id] = asset;
}

} // namespace xgc::c

using namespace xgc;
using namespace xgc::c;

XgcStatus xgcAssetOpen(const void* bytes, size_t byteCount, XgcAsset** asset) {
    if (!bytes || !asset) return badArgument(kNull);
    AssetView view;
    const Status status = openAll({static_cast<const std::byte*>(bytes), byteCount}, view);
    if (!status.ok()) return report(status);
    auto* const made = new (std::nothrow) XgcAsset;
    if (!made) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    made->view = view;
    *asset = made;
    return succeeded();
}

XgcStatus xgcAssetClose(XgcAsset* asset) {
    if (!asset) return succeeded();
    if (const uint32_t users = asset->users.load(); users > 0) {
        return badArgument("scenes and index caches (as many as the element says) have the asset", users);
    }
    delete asset;
    return succeeded();
}

// What is in it -----------------------------------------------------------------------------------------------------

XgcStatus xgcAssetInfo(const XgcAsset* asset, XgcAssetInfo* info) {
    if (!asset) return badArgument(kNull);
    if (const Status s = checkSize(info); !s.ok()) return report(s);
    const format::AssetRecord& record = *asset->view.record;
    XgcAssetInfo out{};
    out.levelCount = record.levelCount;
    out.patchCount = record.patchCount;
    out.partCount = record.partCount;
    out.materialCount = record.materialCount;
    out.nodeCount = record.nodeCount;
    out.domainCount = record.domainCount;
    out.vertexCount = record.vertexCount;
    out.baseVertexCount = record.baseVertexCount;
    out.faceCount = record.faceCount;
    out.vertexStreamCount = asset->view.vertexStreamCount;
    out.maxPatchFaces = record.maxPatchFaces;
    out.maxPatchDomains = maxPatchDomains(asset->view);
    out.scratchCapacity = scratchCapacity(asset->view);
    out.flags = record.flags;
    std::copy_n(record.boundsMin, 3, out.boundsMin);
    std::copy_n(record.boundsMax, 3, out.boundsMax);
    std::copy_n(record.sphereCenter, 3, out.sphereCenter);
    out.sphereRadius = record.sphereRadius;
    out.positionStep = record.positionStep;
    writeStruct(out, info->size, info);
    return succeeded();
}

XgcStatus xgcAssetVertexStream(const XgcAsset* asset, uint32_t index, XgcVertexStream* stream) {
    if (!asset) return badArgument(kNull);
    const Status s = checkElement(stream, index, asset->view.vertexStreamCount, "no such vertex stream (the element)");
    if (!s.ok()) return report(s);
    const VertexStream& from = asset->view.vertexStreams[index];
    writeStruct({0, uint32_t(from.kind), uint32_t(from.format), from.set, from.stride, from.count, from.bytes.data(),
                 from.bytes.size()},
                stream->size, stream);
    return succeeded();
}

XgcStatus xgcAssetPart(const XgcAsset* asset, uint32_t part, XgcPart* out) {
    if (!asset) return badArgument(kNull);
    if (const Status s = checkElement(out, part, asset->view.parts.size(), kNoPart); !s.ok()) return report(s);
    const format::PartRecord& record = asset->view.parts[part];
    const std::string_view name = asset->view.text(record.name);
    const std::span<const uint32_t> neighbours = asset->view.neighboursOf(part);
    XgcPart value{};
    value.nameBytes = uint32_t(name.size());
    value.name = name.data();
    value.stableId = record.stableId;
    value.firstPatch = record.firstPatch;
    value.patchCount = record.patchCount;
    value.faceCount = record.faceCount;
    value.importance = record.importance;
    value.area = record.area;
    std::copy_n(record.centroid, 3, value.centroid);
    value.neighbours = neighbours.data();
    value.neighbourCount = uint32_t(neighbours.size());
    writeStruct(value, out->size, out);
    return succeeded();
}

XgcStatus xgcAssetFindPart(const XgcAsset* asset, uint64_t stableId, uint32_t* part) {
    if (!asset || !part) return badArgument(kNull);
    *part = findPart(asset->view, stableId);
    return succeeded();
}

XgcStatus xgcAssetFindPartByName(const XgcAsset* asset, const char* name, uint32_t* part) {
    if (!asset || !name || !part) return badArgument(kNull);
    *part = findPart(asset->view, std::string_view(name));
    return succeeded();
}

XgcStatus xgcAssetMergedParts(const XgcAsset* asset, uint32_t wanted, uint32_t* groupOfPart, uint32_t partCount,
                              uint32_t* groupCount) {
    if (!asset || !groupOfPart || !groupCount) return badArgument(kNull);
    if (wanted == 0) return badArgument("at least one group is left: `wanted` is 0");
    if (const size_t count = asset->view.parts.size(); partCount != count) {
        return badArgument("`partCount` is not the asset's (the element)", count);
    }
    *groupCount = mergedParts(asset->view, wanted, {groupOfPart, partCount});
    return succeeded();
}

XgcStatus xgcAssetPatch(const XgcAsset* asset, uint32_t patch, XgcPatch* out) {
    if (!asset) return badArgument(kNull);
    if (const Status s = checkElement(out, patch, asset->view.patchCount(), kNoPatch); !s.ok()) return report(s);
    const format::PatchRecord& record = asset->view.patches[patch];
    XgcPatch value{};
    value.part = record.part;
    value.material = record.material;
    value.faceCount = record.faceCount;
    std::copy_n(record.boxMin, 3, value.boxMin);
    std::copy_n(record.boxMax, 3, value.boxMax);
    std::copy_n(record.sphereCenter, 3, value.sphereCenter);
    value.sphereRadius = record.sphereRadius;
    writeStruct(value, out->size, out);
    return succeeded();
}

XgcStatus xgcAssetError(const XgcAsset* asset, uint32_t patch, uint32_t level, float* error) {
    if (!asset || !error) return badArgument(kNull);
    if (patch >= asset->view.patchCount()) return badArgument(kNoPatch, patch);
    if (level >= asset->view.levelCount()) return badArgument(kNoLevel, level);
    *error = asset->view.error(patch, level);
    return succeeded();
}

XgcStatus xgcAssetLevel(const XgcAsset* asset, uint32_t level, XgcLevel* out) {
    if (!asset) return badArgument(kNull);
    const Status s = checkElement(out, level, asset->view.levelCount(), kNoLevel);
    if (!s.ok()) return report(s);
    const format::LevelRecord& record = asset->view.levels[level];
    writeStruct({0, record.faceCount, record.maxError, record.threshold}, out->size, out);
    return succeeded();
}

XgcStatus xgcAssetMaterial(const XgcAsset* asset, uint32_t material, XgcMaterial* out) {
    if (!asset) return badArgument(kNull);
    const Status s = checkElement(out, material, asset->view.materials.size(), "no such material (the element)");
    if (!s.ok()) return report(s);
    const format::MaterialRecord& record = asset->view.materials[material];
    const std::string_view name = asset->view.text(record.name);
    XgcMaterial value{};
    value.nameBytes = uint32_t(name.size());
    value.name = name.data();
    std::copy_n(record.baseColor, 4, value.baseColor);
    value.metallic = record.metallic;
    value.roughness = record.roughness;
    std::copy_n(record.emissive, 3, value.emissive);
    value.flags = record.flags;
    writeStruct(value, out->size, out);
    return succeeded();
}

XgcStatus xgcAssetNode(const XgcAsset* asset, uint32_t node, XgcNode* out) {
    if (!asset) return badArgument(kNull);
    const Status s = checkElement(out, node, asset->view.nodes.size(), "no such node (the element)");
    if (!s.ok()) return report(s);
    const format::NodeRecord& record = asset->view.nodes[node];
    const std::string_view name = asset->view.text(record.name);
    XgcNode value{};
    value.nameBytes = uint32_t(name.size());
    value.name = name.data();
    value.parent = record.parent;
    std::copy_n(record.toMesh, 16, value.toMesh);
    writeStruct(value, out->size, out);
    return succeeded();
}

// Without a scene ---------------------------------------------------------------------------------------------------

XgcStatus xgcAssetSelectByError(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view, float pixels,
                                uint8_t* levels, uint32_t patchCount) {
    if (!asset || !levels) return badArgument(kNull);
    Placement at;
    View from;
    if (const Status s = toPlacement(placement, at); !s.ok()) return report(s);
    if (const Status s = toView(view, from); !s.ok()) return report(s);
    if (!(pixels >= 0)) return badArgument("`pixels` is negative");
    if (patchCount != asset->view.patchCount()) return badArgument(kPatchCount, asset->view.patchCount());
    select(asset->view, at, from, ErrorPixels{pixels}, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcAssetSelectByDistance(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view,
                                   const float* thresholds, uint32_t thresholdCount, uint8_t* levels,
                                   uint32_t patchCount) {
    if (!asset || !levels) return badArgument(kNull);
    Placement at;
    View from;
    if (const Status s = toPlacement(placement, at); !s.ok()) return report(s);
    if (const Status s = toView(view, from); !s.ok()) return report(s);
    if (const Status s = checkRising(thresholds, thresholdCount); !s.ok()) return report(s);
    if (patchCount != asset->view.patchCount()) return badArgument(kPatchCount, asset->view.patchCount());
    select(asset->view, at, from, DistanceBands{{thresholds, thresholdCount}}, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcAssetProjectedError(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view,
                                 const uint8_t* levels, uint32_t patchCount, float* pixels) {
    if (!asset || !pixels) return badArgument(kNull);
    Placement at;
    View from;
    if (const Status s = toPlacement(placement, at); !s.ok()) return report(s);
    if (const Status s = toView(view, from); !s.ok()) return report(s);
    if (const Status s = checkLevels(asset->view, levels, patchCount); !s.ok()) return report(s);
    *pixels = projectedError(asset->view, at, from, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcAssetIndexCapacity(const XgcAsset* asset, uint32_t patch, const uint8_t* levels, uint32_t patchCount,
                                uint32_t* indexCapacity) {
    if (!asset || !indexCapacity) return badArgument(kNull);
    if (const Status s = checkLevelsAround(asset->view, patch, levels, patchCount); !s.ok()) return report(s);
    *indexCapacity = xgc::indexCapacity(asset->view, patch, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcAssetTriangleBound(const XgcAsset* asset, uint32_t patch, const uint8_t* levels, uint32_t patchCount,
                                uint32_t* triangles) {
    if (!asset || !triangles) return badArgument(kNull);
    if (const Status s = checkLevelsAround(asset->view, patch, levels, patchCount); !s.ok()) return report(s);
    *triangles = triangleBound(asset->view, patch, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcAssetBuildIndices(const XgcAsset* asset, uint32_t patch, const uint8_t* levels, uint32_t patchCount,
                               uint32_t* scratch, uint32_t scratchCapacity, uint32_t* indices, uint32_t indexCapacity,
                               uint32_t* indexCount) {
    if (!asset || !indexCount || !scratch) return badArgument(kNull);
    if (const Status s = checkLevelsAround(asset->view, patch, levels, patchCount); !s.ok()) return report(s);
    if (const uint32_t needed = xgc::scratchCapacity(asset->view); scratchCapacity < needed) {
        return report({StatusCode::outOfCapacity, "`scratch` must have as many entries as the element says", needed});
    }
    const Levels state{levels, patchCount};
    const uint32_t needed = xgc::indexCapacity(asset->view, patch, state);
    if (indexCapacity < needed) {
        return report({StatusCode::outOfCapacity, "`indices` must have as many entries as the element says", needed});
    }
    if (!indices && needed > 0) return badArgument(kNull);
    *indexCount = buildIndices(asset->view, patch, state, {scratch, scratchCapacity}, {indices, indexCapacity});
    return succeeded();
}

XgcStatus xgcAssetNeedsRebuild(const XgcAsset* asset, uint32_t patch, const uint8_t* before, const uint8_t* after,
                               uint32_t patchCount, uint32_t* needed) {
    if (!asset || !needed) return badArgument(kNull);
    if (const Status s = checkLevelsAround(asset->view, patch, before, patchCount); !s.ok()) return report(s);
    if (const Status s = checkLevelsAround(asset->view, patch, after, patchCount); !s.ok()) return report(s);
    *needed = needsRebuild(asset->view, patch, {before, patchCount}, {after, patchCount});
    return succeeded();
}

// Geomorphs ---------------------------------------------------------------------------------------------------------

XgcStatus xgcAssetMorphRows(const XgcAsset* asset, XgcMorphRow* rows, uint32_t rowCount) {
    if (!asset || !rows) return badArgument(kNull);
    if (const uint32_t count = asset->view.record->vertexCount; rowCount != count) {
        return badArgument("`rowCount` is not the asset's vertexCount (the element)", count);
    }
    return report(morphRows(asset->view, {reinterpret_cast<MorphRow*>(rows), rowCount}));
}

XgcStatus xgcAssetGroupLambdas(const XgcAsset* asset, const uint8_t* levels, const float* fractions,
                               uint32_t patchCount, float* lambdas, uint32_t groupCount) {
    if (!asset || !lambdas) return badArgument(kNull);
    if (const Status s = checkLevels(asset->view, levels, patchCount); !s.ok()) return report(s);
    if (const Status s = checkFractions(fractions, patchCount); !s.ok()) return report(s);
    if (const uint32_t count = xgc::groupCount(asset->view); groupCount != count) {
        return badArgument("`groupCount` is not the asset's domainCount + patchCount (the element)", count);
    }
    groupLambdas(asset->view, {levels, patchCount}, {fractions, fractions ? size_t(patchCount) : 0},
                 {lambdas, groupCount});
    return succeeded();
}
