#include "flight.h"
#include "try.h"

#include <math.h>
#include <string.h>

/* A scene with one instance, and all that draws it. */
typedef struct World {
    XgcAsset* asset;
    XgcAssetInfo info;
    XgcScene* scene;
    XgcSelection* selection;
    XgcIndexCache* cache;
    XgcDrawList* list;
    XgcPlacement placement;
    uint32_t id, instance;
    uint8_t levels[256];
    float fractions[256];
    uint32_t staging[1 << 14];
} World;

static World world;
static const float kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static XgcSelectionDesc goodDesc(void) {
    XgcSelectionDesc desc;
    xgcSelectionDescDefaults(&desc, sizeof desc);
    desc.view.eye[2] = 10;
    desc.view.pixelsPerUnit = 100;
    return desc;
}

static const char* open(World* w, const void* bytes, size_t byteCount) {
    memset(w, 0, sizeof *w);
    w->info.size = sizeof w->info;
    REFUSED(xgcAssetOpen(NULL, byteCount, &w->asset));
    REFUSED(xgcAssetOpen(bytes, byteCount, NULL));
    REFUSED(xgcAssetOpen((const char*)bytes + 1, byteCount - 1, &w->asset));
    HOLDS(xgcAssetOpen(bytes, byteCount - 64, &w->asset).code == XGC_TRUNCATED);
    HOLDS(xgcAssetOpen(bytes, 0, &w->asset).code == XGC_NOT_AN_ASSET);
    HOLDS(w->asset == NULL);
    TRY(xgcAssetOpen(bytes, byteCount, &w->asset));
    TRY(xgcAssetInfo(w->asset, &w->info));
    HOLDS(w->info.patchCount <= sizeof w->levels);
    TRY(xgcAssetClose(NULL));
    return NULL;
}

static const char* refuseViews(World* w) {
    const float eye[3] = {0, 0, 1}, nowhere[3] = {0, 0, 0}, away[3] = {0, INFINITY, 0};
    float matrix[16];
    XgcView view;
    XgcFrustum frustum;
    REFUSED(xgcMakeView(NULL, 1, 100, &view));
    REFUSED(xgcMakeView(eye, 1, 100, NULL));
    REFUSED(xgcMakeView(away, 1, 100, &view));
    REFUSED(xgcMakeView(eye, 0, 100, &view));
    REFUSED(xgcMakeView(eye, 3.2f, 100, &view));
    REFUSED(xgcMakeView(eye, NAN, 100, &view));
    REFUSED(xgcMakeView(eye, 1, -1, &view));
    REFUSED(xgcMakeOrthographicView(eye, nowhere, 1, 100, &view));
    REFUSED(xgcMakeOrthographicView(eye, eye, 0, 100, &view));
    REFUSED(xgcMakeOrthographicView(eye, eye, 1, NAN, &view));
    REFUSED(xgcMakeOrthographicView(eye, NULL, 1, 100, &view));
    REFUSED(xgcMakePlacement(NULL, &w->placement));
    REFUSED(xgcMakePlacement(kIdentity, NULL));
    memcpy(matrix, kIdentity, sizeof matrix);
    matrix[3] = 1;
    REFUSED(xgcMakePlacement(matrix, &w->placement));
    memset(matrix, 0, sizeof matrix);
    matrix[15] = 1;
    REFUSED(xgcMakePlacement(matrix, &w->placement));
    matrix[0] = NAN;
    REFUSED(xgcMakePlacement(matrix, &w->placement));
    REFUSED(xgcMakeFrustum(matrix, &frustum));
    REFUSED(xgcMakeFrustum(kIdentity, NULL));
    TRY(xgcMakePlacement(kIdentity, &w->placement));
    HOLDS(w->placement.maxScale >= 1 && w->placement.maxScale < 1.001f);
    return NULL;
}

static const char* refuseAsset(World* w) {
    const uint32_t patches = w->info.patchCount, levels = w->info.levelCount;
    uint32_t number = 77, groups[256];
    float value = 77;
    XgcPart part = {.size = sizeof part};
    XgcPatch patch = {.size = sizeof patch};
    XgcLevel level = {.size = sizeof level};
    XgcMaterial material = {.size = sizeof material};
    XgcNode node = {.size = sizeof node};
    XgcVertexStream stream = {.size = sizeof stream};
    REFUSED(xgcAssetInfo(NULL, &w->info));
    REFUSED(xgcAssetInfo(w->asset, NULL));
    REFUSED(xgcAssetPart(w->asset, w->info.partCount, &part));
    REFUSED(xgcAssetPart(w->asset, 0, NULL));
    REFUSED(xgcAssetPatch(w->asset, patches, &patch));
    REFUSED(xgcAssetLevel(w->asset, levels, &level));
    REFUSED(xgcAssetMaterial(w->asset, w->info.materialCount, &material));
    REFUSED(xgcAssetNode(w->asset, w->info.nodeCount, &node));
    REFUSED(xgcAssetVertexStream(w->asset, w->info.vertexStreamCount, &stream));
    part.size = 0;
    REFUSED(xgcAssetPart(w->asset, 0, &part));
    part.size = sizeof part + 3;
    REFUSED(xgcAssetPart(w->asset, 0, &part));
    REFUSED(xgcAssetError(w->asset, patches, 0, &value));
    REFUSED(xgcAssetError(w->asset, 0, levels, &value));
    REFUSED(xgcAssetFindPartByName(w->asset, NULL, &number));
    REFUSED(xgcAssetFindPart(w->asset, 1, NULL));
    REFUSED(xgcAssetMergedParts(w->asset, 0, groups, w->info.partCount, &number));
    REFUSED(xgcAssetMergedParts(w->asset, 1, groups, w->info.partCount + 1, &number));
    HOLDS(number == 77 && value == 77);
    TRY(xgcAssetFindPartByName(w->asset, "nobody has this name", &number));
    HOLDS(number == XGC_NONE);
    return NULL;
}

static const char* refuseIndices(World* w) {
    const uint32_t patches = w->info.patchCount;
    static uint32_t scratch[1 << 16], indices[1 << 16];
    uint32_t number = 77, capacity = 0;
    float pixels = 77;
    XgcView view = goodDesc().view;
    XgcPlacement bad = w->placement;
    const float falling[2] = {2, 1};
    bad.maxScale = 0;
    HOLDS(w->info.scratchCapacity <= 1 << 16);
    REFUSED(xgcAssetSelectByError(w->asset, &bad, &view, 1, w->levels, patches));
    REFUSED(xgcAssetSelectByError(w->asset, &w->placement, NULL, 1, w->levels, patches));
    REFUSED(xgcAssetSelectByError(w->asset, &w->placement, &view, -1, w->levels, patches));
    REFUSED(xgcAssetSelectByError(w->asset, &w->placement, &view, 1, w->levels, patches - 1));
    REFUSED(xgcAssetSelectByError(w->asset, &w->placement, &view, 1, NULL, patches));
    REFUSED(xgcAssetSelectByDistance(w->asset, &w->placement, &view, falling, 2, w->levels, patches));
    REFUSED(xgcAssetSelectByDistance(w->asset, &w->placement, &view, NULL, 2, w->levels, patches));
    TRY(xgcAssetSelectByDistance(w->asset, &w->placement, &view, NULL, 0, w->levels, patches));
    REFUSED(xgcAssetIndexCapacity(w->asset, patches, w->levels, patches, &capacity));
    TRY(xgcAssetIndexCapacity(w->asset, 0, w->levels, patches, &capacity));
    HOLDS(capacity > 0 && capacity <= 1 << 16);
    XgcStatus s = xgcAssetBuildIndices(w->asset, 0, w->levels, patches, scratch, w->info.scratchCapacity - 1, indices,
                                       capacity, &number);
    HOLDS(s.code == XGC_OUT_OF_CAPACITY && s.element == w->info.scratchCapacity);
    s = xgcAssetBuildIndices(w->asset, 0, w->levels, patches, scratch, w->info.scratchCapacity, indices, capacity - 1,
                             &number);
    HOLDS(s.code == XGC_OUT_OF_CAPACITY && s.element == capacity);
    REFUSED(xgcAssetBuildIndices(w->asset, 0, w->levels, patches, NULL, 1 << 16, indices, capacity, &number));
    REFUSED(xgcAssetBuildIndices(w->asset, 0, w->levels, patches, scratch, 1 << 16, NULL, capacity, &number));
    w->levels[0] = (uint8_t)w->info.levelCount;
    REFUSED(xgcAssetBuildIndices(w->asset, 0, w->levels, patches, scratch, 1 << 16, indices, 1 << 16, &number));
    REFUSED(xgcAssetProjectedError(w->asset, &w->placement, &view, w->levels, patches, &pixels));
    REFUSED(xgcAssetNeedsRebuild(w->asset, 0, w->levels, w->levels, patches, &number));
    REFUSED(xgcAssetTriangleBound(w->asset, 0, w->levels, patches, &number));
    w->levels[0] = 0;
    HOLDS(number == 77 && pixels == 77);
    return NULL;
}

static const char* refuseMorphs(World* w) {
    static XgcMorphRow rows[1 << 16];
    static float lambdas[1 << 16];
    const uint32_t patches = w->info.patchCount, groups = w->info.domainCount + patches;
    HOLDS(w->info.vertexCount < 1 << 16 && groups < 1 << 16);
    REFUSED(xgcAssetMorphRows(w->asset, NULL, w->info.vertexCount));
    REFUSED(xgcAssetMorphRows(w->asset, rows, w->info.vertexCount - 1));
    TRY(xgcAssetMorphRows(w->asset, rows, w->info.vertexCount));
    REFUSED(xgcAssetGroupLambdas(w->asset, w->levels, NULL, patches, lambdas, groups - 1));
    w->fractions[0] = -1;
    REFUSED(xgcAssetGroupLambdas(w->asset, w->levels, w->fractions, patches, lambdas, groups));
    w->fractions[0] = 0.5f;
    TRY(xgcAssetGroupLambdas(w->asset, w->levels, w->fractions, patches, lambdas, groups));
    HOLDS(lambdas[w->info.domainCount] == 0.5f); /* the interior of patch 0 */
    w->fractions[0] = 0;
    return NULL;
}

static const char* refuseScene(World* w) {
    XgcSceneConfig config;
    XgcAssetDesc desc;
    XgcPartControl control;
    XgcWholeState state = {.size = sizeof state};
    XgcPlacement bad = w->placement;
    uint32_t number = 77;
    bad.toWorld[4] = INFINITY;
    xgcSceneConfigDefaults(&config, sizeof config);
    xgcAssetDescDefaults(&desc, sizeof desc);
    xgcPartControlDefaults(&control, sizeof control);
    REFUSED(xgcSceneCreate(NULL, &w->scene));
    REFUSED(xgcSceneCreate(&config, NULL));
    config.assetCapacity = 0;
    REFUSED(xgcSceneCreate(&config, &w->scene));
    config.assetCapacity = 1;
    TRY(xgcSceneCreate(&config, &w->scene));
    REFUSED(xgcSceneAddAsset(w->scene, NULL, &desc, &number));
    REFUSED(xgcSceneAddAsset(w->scene, w->asset, NULL, &number));
    desc.vertexOffset = INT32_MAX;
    REFUSED(xgcSceneAddAsset(w->scene, w->asset, &desc, &number));
    desc.vertexOffset = 0;
    TRY(xgcSceneAddAsset(w->scene, w->asset, &desc, &w->id));
    HOLDS(xgcSceneAddAsset(w->scene, w->asset, &desc, &number).code == XGC_OUT_OF_CAPACITY);
    REFUSED(xgcSceneAddInstance(w->scene, w->id + 1, &w->placement, &number));
    REFUSED(xgcSceneAddInstance(w->scene, XGC_NONE, &w->placement, &number));
    REFUSED(xgcSceneAddInstance(w->scene, w->id, &bad, &number));
    TRY(xgcSceneAddInstance(w->scene, w->id, &w->placement, &w->instance));
    const uint32_t none = w->instance + 1;
    REFUSED(xgcSceneRemoveInstance(w->scene, none));
    REFUSED(xgcSceneSetPlacement(w->scene, none, &w->placement));
    REFUSED(xgcSceneSetPlacement(w->scene, w->instance, &bad));
    REFUSED(xgcScenePlacement(w->scene, w->instance, NULL));
    REFUSED(xgcSceneSetVisible(w->scene, none, 1));
    REFUSED(xgcSceneAssetOf(w->scene, none, &number));
    REFUSED(xgcSceneSetPart(w->scene, w->instance, w->info.partCount, &control));
    REFUSED(xgcSceneSetPart(w->scene, none, 0, &control));
    control.importance = 0;
    REFUSED(xgcSceneSetPart(w->scene, w->instance, 0, &control));
    REFUSED(xgcScenePart(w->scene, w->instance, w->info.partCount, &control));
    REFUSED(xgcSceneClearParts(w->scene, none));
    REFUSED(xgcSceneWholeState(w->scene, w->id + 1, 0, &state, NULL, 0));
    REFUSED(xgcSceneWholeState(w->scene, w->id, 1000, &state, NULL, 0));
    REFUSED(xgcSceneWholeState(w->scene, w->id, 0, &state, w->levels, 1));
    REFUSED(xgcSceneRemoveAsset(w->scene, w->id)); /* has an instance */
    REFUSED(xgcAssetClose(w->asset));
    HOLDS(number == 77);
    HOLDS(xgcSceneInstanceEnd(NULL) == 0 && !xgcSceneHasInstance(NULL, 0) && !xgcSceneHasInstance(w->scene, none));
    TRY(xgcScenePart(w->scene, w->instance, 0, &control));
    HOLDS(control.importance == 1 && control.hidden == 0);
    return NULL;
}

static const char* refuseDescs(World* w) {
    XgcSelectionDesc desc = goodDesc();
    const float falling[2] = {2, 1};
#define BAD_DESC(field, value)                                                                                         \
    desc = goodDesc();                                                                                                 \
    desc.field = value;                                                                                                \
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, &desc))
    BAD_DESC(size, 3);
    BAD_DESC(policy, 2);
    BAD_DESC(pixels, NAN);
    BAD_DESC(hysteresis, 1);
    BAD_DESC(contributionPixels, -1);
    BAD_DESC(wholeBeyond, NAN);
    BAD_DESC(frustum.planeCount, 7);
    BAD_DESC(bandCount, 1);
    BAD_DESC(view.pixelsPerUnit, -1);
    BAD_DESC(view.nearest, NAN);
    BAD_DESC(reference, w->selection);
    BAD_DESC(morphRate, 0);
    desc = goodDesc();
    desc.bands = falling;
    desc.bandCount = 2;
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, &desc));
    desc = goodDesc();
    desc.policy = XGC_POLICY_DISTANCE_BANDS;
    desc.triangleBudget = 5;
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, &desc));
    desc = goodDesc();
    desc.morph = 1;
    desc.hysteresis = 0.1f;
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, &desc));
    return NULL;
}

static const char* refuseSelection(World* w) {
    XgcSceneConfig config;
    XgcSelectionDesc desc = goodDesc();
    XgcSelectionStats stats = {.size = sizeof stats};
    XgcInstanceLevels at = {.size = sizeof at};
    XgcSelection *small, *other;
    xgcSceneConfigDefaults(&config, sizeof config);
    REFUSED(xgcSelectionCreate(&config, NULL));
    REFUSED(xgcSelectionCreate(NULL, &w->selection));
    TRY(xgcSelectionCreate(&config, &w->selection));
    TRY(xgcSelectionCreate(&config, &other));
    config.instanceCapacity = 1;
    TRY(xgcSelectionCreate(&config, &small));
    REFUSED(xgcSelectionInstance(w->selection, w->instance, &at)); /* not updated yet */
    REFUSED(xgcSelectionUpdate(small, w->scene, &desc));
    REFUSED(xgcSelectionUpdate(NULL, w->scene, &desc));
    REFUSED(xgcSelectionUpdate(w->selection, NULL, &desc));
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, NULL));
    desc.reference = other;
    REFUSED(xgcSelectionUpdate(w->selection, w->scene, &desc)); /* the reference was not updated */
    const char* failure = refuseDescs(w);
    if (failure) return failure;
    REFUSED(xgcSelectionSet(w->selection, w->scene, w->instance + 1, w->levels, NULL, w->info.patchCount));
    REFUSED(xgcSelectionSet(w->selection, w->scene, w->instance, w->levels, NULL, w->info.patchCount - 1));
    w->levels[1] = (uint8_t)w->info.levelCount;
    REFUSED(xgcSelectionSet(w->selection, w->scene, w->instance, w->levels, NULL, w->info.patchCount));
    w->levels[1] = 0;
    w->fractions[1] = 1;
    REFUSED(xgcSelectionSet(w->selection, w->scene, w->instance, w->levels, w->fractions, w->info.patchCount));
    w->fractions[1] = 0;
    desc = goodDesc();
    TRY(xgcSelectionUpdate(w->selection, w->scene, &desc));
    TRY(xgcSelectionSet(w->selection, w->scene, w->instance, w->levels, NULL, w->info.patchCount));
    REFUSED(xgcSelectionInstance(w->selection, w->instance + 1, &at));
    REFUSED(xgcSelectionStats(NULL, &stats));
    stats.size = 1;
    REFUSED(xgcSelectionStats(w->selection, &stats));
    xgcSelectionDestroy(other);
    xgcSelectionDestroy(small);
    xgcSelectionDestroy(NULL);
    return NULL;
}

static const char* refuseRanges(World* w) {
    const uint32_t patches = w->info.patchCount;
    uint32_t range = 77;
    uint64_t bytes = 77;
    XgcIndexRange at;
    REFUSED(xgcIndexCacheAcquire(w->cache, w->id, 0, w->levels, patches, &range)); /* no frame */
    REFUSED(xgcIndexCacheFreeStagingBytes(w->cache, &bytes));
    REFUSED(xgcIndexCacheEndFrame(w->cache));
    REFUSED(xgcIndexCacheBeginFrame(w->cache, NULL, 4));
    REFUSED(xgcIndexCacheBeginFrame(w->cache, (char*)w->staging + 1, 4));
    TRY(xgcIndexCacheBeginFrame(w->cache, w->staging, 4));
    REFUSED(xgcIndexCacheBeginFrame(w->cache, w->staging, 4));
    REFUSED(xgcIndexCacheAcquire(w->cache, w->id + 1, 0, w->levels, patches, &range));
    REFUSED(xgcIndexCacheAcquire(w->cache, w->id, patches, w->levels, patches, &range));
    REFUSED(xgcIndexCacheAcquire(w->cache, w->id, 0, w->levels, patches + 1, &range));
    REFUSED(xgcIndexCacheAcquire(w->cache, w->id, 0, NULL, patches, &range));
    REFUSED(xgcIndexCacheAcquireWhole(w->cache, w->id, w->info.materialCount, 0, w->levels, patches, &range));
    REFUSED(xgcIndexCacheBytesNeeded(w->cache, w->id, patches, w->levels, patches, &bytes));
    HOLDS(xgcIndexCacheAcquire(w->cache, w->id, 0, w->levels, patches, &range).code == XGC_OUT_OF_CAPACITY);
    HOLDS(range == 77 && bytes == 77);
    TRY(xgcIndexCacheEndFrame(w->cache));
    TRY(xgcIndexCacheBeginFrame(w->cache, w->staging, sizeof w->staging));
    TRY(xgcIndexCacheBytesNeeded(w->cache, w->id, 0, w->levels, patches, &bytes));
    HOLDS(bytes > 0);
    TRY(xgcIndexCacheAcquire(w->cache, w->id, 0, w->levels, patches, &range));
    TRY(xgcIndexCacheRange(w->cache, range, &at));
    HOLDS(at.indexCount > 0);
    TRY(xgcIndexCacheHold(w->cache, range));
    REFUSED(xgcIndexCacheRemoveAsset(w->cache, w->id)); /* is held */
    TRY(xgcIndexCacheRelease(w->cache, range));
    TRY(xgcIndexCacheRelease(w->cache, range));
    REFUSED(xgcIndexCacheRelease(w->cache, range));
    REFUSED(xgcIndexCacheHold(w->cache, range));
    REFUSED(xgcIndexCacheRange(w->cache, XGC_NONE, &at));
    TRY(xgcIndexCacheEndFrame(w->cache));
    return NULL;
}

static const char* refuseCache(World* w) {
    XgcIndexCacheConfig config;
    XgcIndexCacheStats stats = {.size = 2};
    uint32_t count = 77;
    xgcIndexCacheConfigDefaults(&config, sizeof config);
    config.framesInFlight = 0;
    REFUSED(xgcIndexCacheCreate(&config, &w->cache));
    REFUSED(xgcIndexCacheCreate(NULL, &w->cache));
    config.framesInFlight = 1;
    REFUSED(xgcIndexCacheCreate(&config, NULL));
    TRY(xgcIndexCacheCreate(&config, &w->cache));
    REFUSED(xgcIndexCacheAddAsset(w->cache, w->id, NULL));
    HOLDS(xgcIndexCacheAddAsset(w->cache, config.assetCapacity, w->asset).code == XGC_OUT_OF_CAPACITY);
    TRY(xgcIndexCacheAddAsset(w->cache, w->id, w->asset));
    REFUSED(xgcIndexCacheAddAsset(w->cache, w->id, w->asset));
    REFUSED(xgcIndexCacheRemoveAsset(w->cache, w->id + 1));
    REFUSED(xgcIndexCacheStats(w->cache, &stats));
    HOLDS(xgcIndexCacheCopies(NULL, &count) == NULL && count == 0);
    const char* failure = refuseRanges(w);
    xgcIndexCacheDestroy(NULL);
    return failure;
}

static const char* refuseDraws(World* w) {
    XgcSceneConfig scene;
    XgcDrawListConfig config;
    XgcInstanceLevels at = {.size = sizeof at};
    XgcDrawList* small;
    XgcStatus refusal;
    uint32_t count = 77;
    xgcSceneConfigDefaults(&scene, sizeof scene);
    xgcDrawListConfigDefaults(&config, sizeof config);
    REFUSED(xgcDrawListCreate(NULL, &config, &w->list));
    REFUSED(xgcDrawListCreate(&scene, NULL, &w->list));
    TRY(xgcDrawListCreate(&scene, &config, &w->list));
    REFUSED(xgcDrawListUpdate(w->list, w->scene, w->selection, w->cache)); /* no frame */
    TRY(xgcIndexCacheBeginFrame(w->cache, w->staging, sizeof w->staging));
    REFUSED(xgcDrawListUpdate(w->list, w->scene, w->selection, NULL));
    config.materialCapacity = w->info.materialCount - 1;
    TRY(xgcDrawListCreate(&scene, &config, &small));
    HOLDS(xgcDrawListUpdate(small, w->scene, w->selection, w->cache).code == XGC_OUT_OF_CAPACITY);
    xgcDrawListDestroy(small);
    xgcDrawListConfigDefaults(&config, sizeof config);
    scene.instanceCapacity = 1;
    TRY(xgcDrawListCreate(&scene, &config, &small));
    REFUSED(xgcDrawListUpdate(small, w->scene, w->selection, w->cache));
    xgcDrawListDestroy(small);
    TRY(xgcIndexCacheRemoveAsset(w->cache, w->id));
    REFUSED(xgcDrawListUpdate(w->list, w->scene, w->selection, w->cache)); /* the cache has not the asset */
    TRY(xgcIndexCacheAddAsset(w->cache, w->id, w->asset));
    TRY(xgcDrawListUpdate(w->list, w->scene, w->selection, w->cache));
    TRY(xgcIndexCacheEndFrame(w->cache));
    HOLDS(xgcDrawListDraws(w->list, NULL) != NULL);
    HOLDS(xgcDrawListDraws(NULL, &count) == NULL && count == 0);
    REFUSED(xgcDrawListInstance(w->list, 100000, &at));
    REFUSED(xgcDrawListRefusal(w->list, NULL));
    TRY(xgcDrawListRefusal(w->list, &refusal));
    TRY(refusal);
    REFUSED(xgcDrawListForgetAsset(w->list, 100000));
    REFUSED(xgcIndexCacheRemoveAsset(w->cache, w->id)); /* the list holds its ranges */
    REFUSED(xgcDrawListClear(NULL));
    return NULL;
}

/* Everything goes in the order that the header asks for. */
static const char* takeDown(World* w) {
    TRY(xgcSceneRemoveInstance(w->scene, w->instance));
    TRY(xgcDrawListForgetAsset(w->list, w->id));
    TRY(xgcIndexCacheRemoveAsset(w->cache, w->id));
    TRY(xgcSceneRemoveAsset(w->scene, w->id));
    REFUSED(xgcSceneRemoveAsset(w->scene, w->id));
    TRY(xgcAssetClose(w->asset));
    TRY(xgcDrawListClear(w->list));
    xgcDrawListDestroy(w->list);
    xgcIndexCacheDestroy(w->cache);
    xgcSelectionDestroy(w->selection);
    xgcSceneDestroy(w->scene);
    return NULL;
}

const char* checkRefusals(const void* bytes, size_t byteCount) {
    World* w = &world;
    const char* failure = open(w, bytes, byteCount);
    const char* (*const checks[])(World*) = {refuseViews,     refuseAsset, refuseIndices, refuseMorphs, refuseScene,
                                             refuseSelection, refuseCache, refuseDraws,   takeDown};
    for (size_t i = 0; i < sizeof checks / sizeof *checks && !failure; ++i) failure = checks[i](w);
    return failure;
}
