#include <xgc/xgc.h>

#include <stdio.h>
#include <stdlib.h>

/* Links the C API as an engine in C does. `prepare` and `frame` are the example of the runtime's README, word for word:
 * the test readme_code_c compares them. */

static XgcAsset* asset;
static XgcScene* scene;
static XgcSelection* selection; /* one a view */
static XgcDrawList* list;       /* likewise */
static XgcIndexCache* cache;    /* one for all views */
static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static int prepare(const void* bytes, size_t byteCount, const float toWorld[16]) {
    XgcSceneConfig sceneConfig;
    xgcSceneConfigDefaults(&sceneConfig, sizeof sceneConfig);
    XgcIndexCacheConfig cacheConfig;
    xgcIndexCacheConfigDefaults(&cacheConfig, sizeof cacheConfig);
    XgcDrawListConfig listConfig;
    xgcDrawListConfigDefaults(&listConfig, sizeof listConfig);
    XgcAssetDesc desc;
    xgcAssetDescDefaults(&desc, sizeof desc);
    XgcPlacement placement;
    uint32_t id, instance;
    if (xgcAssetOpen(bytes, byteCount, &asset).code || xgcSceneCreate(&sceneConfig, &scene).code ||
        xgcSelectionCreate(&sceneConfig, &selection).code || xgcIndexCacheCreate(&cacheConfig, &cache).code ||
        xgcDrawListCreate(&sceneConfig, &listConfig, &list).code || xgcMakePlacement(toWorld, &placement).code ||
        xgcSceneAddAsset(scene, asset, &desc, &id).code || xgcIndexCacheAddAsset(cache, id, asset).code ||
        xgcSceneAddInstance(scene, id, &placement, &instance).code)
        return 0; /* the log was told why */
    return 1;
}

static void frame(const float eye[3], float fovY, float height, void* staging, uint32_t stagingBytes) {
    XgcSelectionDesc wish;
    xgcSelectionDescDefaults(&wish, sizeof wish);
    xgcMakeView(eye, fovY, height, &wish.view);
    xgcSelectionUpdate(selection, scene, &wish);
    xgcIndexCacheBeginFrame(cache, staging, stagingBytes);
    xgcDrawListUpdate(list, scene, selection, cache);
    xgcIndexCacheEndFrame(cache); /* then copy xgcIndexCacheCopies, draw xgcDrawListDraws */
}

static uint32_t failures;

static void complain(void* user, const char* function, uint32_t code, const char* message, uint64_t element) {
    (void)user;
    ++failures;
    printf("%s: %s (%u, %llu)\n", function, message, code, (unsigned long long)element);
}

static void destroy(void) {
    if (list) xgcDrawListClear(list);
    xgcDrawListDestroy(list);
    xgcSelectionDestroy(selection);
    xgcIndexCacheDestroy(cache);
    xgcSceneDestroy(scene);
    xgcAssetClose(asset);
}

/* From the surface to far away: ever fewer triangles. */
static int show(const void* bytes, size_t byteCount) {
    XgcDrawStats stats = {.size = sizeof stats};
    XgcAssetInfo info = {.size = sizeof info};
    const uint32_t stagingBytes = 64u << 20;
    void* staging = malloc(stagingBytes);
    int good = prepare(bytes, byteCount, identity) && xgcAssetInfo(asset, &info).code == XGC_OK;
    uint64_t near = 0;
    for (float away = 1; good && away < 1000; away *= 4) {
        const float eye[3] = {info.sphereCenter[0], info.sphereCenter[1],
                              info.sphereCenter[2] + away * info.sphereRadius};
        frame(eye, 1.0f, 1080.0f, staging, stagingBytes);
        good = xgcDrawListStats(list, &stats).code == XGC_OK && stats.triangles > 0;
        if (away == 1) near = stats.triangles;
        uint32_t copies, draws;
        xgcIndexCacheCopies(cache, &copies);
        xgcDrawListDraws(list, &draws);
        printf("%8.1f radii: %llu triangles, %u draws, %u copies\n", (double)away, (unsigned long long)stats.triangles,
               draws, copies);
    }
    if (good) good = stats.triangles <= near && near <= info.faceCount;
    destroy();
    free(staging);
    return good && failures == 0 ? 0 : 1;
}

static int showFile(const char* name) {
    FILE* file = fopen(name, "rb");
    if (!file) return 4;
    fseek(file, 0, SEEK_END);
    const size_t size = (size_t)ftell(file);
    rewind(file);
    void* bytes = aligned_alloc(XGC_ALIGNMENT, (size + XGC_ALIGNMENT) / XGC_ALIGNMENT * XGC_ALIGNMENT);
    const int read = fread(bytes, 1, size, file) == size;
    fclose(file);
    const int result = read ? show(bytes, size) : 4;
    free(bytes);
    return result;
}

/* Draws the asset that is named; without one, checks that what is no asset is refused. */
int main(int argc, char** argv) {
    static _Alignas(64) const char nothing[64];
    const XgcLog log = {complain, NULL};
    if (xgcAbiVersion() != XGC_ABI_VERSION) return 5;
    xgcSetLog(&log);
    if (argc > 1) return showFile(argv[1]);
    const int refused = !prepare(nothing, sizeof nothing, identity) && failures == 1;
    return refused ? 0 : 1;
}
