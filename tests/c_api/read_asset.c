#include "flight.h"
#include "try.h"

#include <stdlib.h>
#include <string.h>

static const char* readParts(const XgcAsset* asset, const XgcAssetInfo* info) {
    uint32_t* groups = malloc(info->partCount * sizeof *groups);
    uint32_t faces = 0, patches = 0, found, groupCount;
    for (uint32_t i = 0; i < info->partCount; ++i) {
        XgcPart part = {.size = sizeof part};
        char name[64] = {0};
        TRY(xgcAssetPart(asset, i, &part));
        HOLDS(part.nameBytes > 0 && part.nameBytes < sizeof name && part.firstPatch == patches);
        memcpy(name, part.name, part.nameBytes);
        TRY(xgcAssetFindPartByName(asset, name, &found));
        HOLDS(found == i);
        TRY(xgcAssetFindPart(asset, part.stableId, &found));
        HOLDS(found == i && part.importance == 1 && part.neighbourCount > 0 && part.neighbours[0] < info->partCount);
        faces += part.faceCount;
        patches += part.patchCount;
    }
    HOLDS(faces == info->faceCount && patches == info->patchCount);
    TRY(xgcAssetMergedParts(asset, info->partCount, groups, info->partCount, &groupCount));
    HOLDS(groupCount == info->partCount && groups[groupCount - 1] == groupCount - 1);
    free(groups);
    return NULL;
}

static const char* readRest(const XgcAsset* asset, const XgcAssetInfo* info) {
    XgcVertexStream stream = {.size = sizeof stream};
    TRY(xgcAssetVertexStream(asset, 0, &stream));
    HOLDS(stream.kind == XGC_STREAM_POSITION && stream.format == XGC_FORMAT_F32X3 && stream.count == info->vertexCount);
    HOLDS(stream.byteCount >= (uint64_t)stream.stride * (stream.count - 1) + 12);
    float last = 0;
    for (uint32_t i = 0; i < info->levelCount; ++i) {
        XgcLevel level = {.size = sizeof level};
        float error;
        TRY(xgcAssetLevel(asset, i, &level));
        TRY(xgcAssetError(asset, 0, i, &error));
        HOLDS(error >= last && error <= level.maxError && (i > 0 || level.faceCount == info->faceCount));
        last = error;
    }
    for (uint32_t i = 0; i < info->patchCount; ++i) {
        XgcPatch patch = {.size = sizeof patch};
        TRY(xgcAssetPatch(asset, i, &patch));
        HOLDS(patch.part < info->partCount && patch.material < info->materialCount && patch.sphereRadius > 0);
        for (int k = 0; k < 3; ++k) HOLDS(patch.boxMin[k] >= info->boundsMin[k] - 1e-3f);
    }
    XgcMaterial material = {.size = sizeof material};
    TRY(xgcAssetMaterial(asset, info->materialCount - 1, &material));
    return NULL;
}

/* Builds all patches and hashes their triangles. */
static const char* build(const XgcAsset* asset, const XgcAssetInfo* info, const uint8_t* levels, uint64_t* hash) {
    uint32_t* scratch = malloc(info->scratchCapacity * sizeof *scratch);
    *hash = flightHash(1, levels, info->patchCount);
    for (uint32_t p = 0; p < info->patchCount; ++p) {
        uint32_t capacity, count, bound, needed;
        TRY(xgcAssetIndexCapacity(asset, p, levels, info->patchCount, &capacity));
        TRY(xgcAssetTriangleBound(asset, p, levels, info->patchCount, &bound));
        uint32_t* indices = malloc((capacity + 1) * sizeof *indices);
        TRY(xgcAssetBuildIndices(asset, p, levels, info->patchCount, scratch, info->scratchCapacity, indices, capacity,
                                 &count));
        TRY(xgcAssetNeedsRebuild(asset, p, levels, levels, info->patchCount, &needed));
        HOLDS(count <= 3 * bound && needed == 0);
        *hash = flightHash(*hash, indices, count * sizeof *indices);
        free(indices);
    }
    free(scratch);
    return NULL;
}

static const char* select(const XgcAsset* asset, const XgcAssetInfo* info, uint8_t* levels, uint64_t hashes[2]) {
    float toWorld[16], pixels;
    const float eye[3] = {0, 0, 3 * info->sphereRadius}, bands[3] = {0.5f, 1.5f, 2.5f};
    XgcPlacement placement;
    XgcView view;
    flightPlace(3, info->sphereRadius, toWorld);
    TRY(xgcMakePlacement(toWorld, &placement));
    TRY(xgcMakeView(eye, 1.0f, 1080.0f, &view));
    TRY(xgcAssetSelectByError(asset, &placement, &view, 1.5f, levels, info->patchCount));
    TRY(xgcAssetProjectedError(asset, &placement, &view, levels, info->patchCount, &pixels));
    HOLDS(pixels <= 1.51f);
    const char* failure = build(asset, info, levels, &hashes[0]);
    if (failure) return failure;
    TRY(xgcAssetSelectByDistance(asset, &placement, &view, bands, 3, levels, info->patchCount));
    return build(asset, info, levels, &hashes[1]);
}

const char* readAsset(const void* bytes, size_t byteCount, uint64_t hashes[2]) {
    XgcAsset* asset;
    XgcAssetInfo info = {.size = sizeof info};
    TRY(xgcAssetOpen(bytes, byteCount, &asset));
    TRY(xgcAssetInfo(asset, &info));
    uint8_t* levels = malloc(info.patchCount);
    const char* failure = readParts(asset, &info);
    if (!failure) failure = readRest(asset, &info);
    if (!failure) failure = select(asset, &info, levels, hashes);
    free(levels);
    const XgcStatus closed = xgcAssetClose(asset);
    if (failure) return failure;
    TRY(closed);
    return NULL;
}
