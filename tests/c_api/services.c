#include "flight.h"
#include "try.h"

#include <stdlib.h>
#include <string.h>

/* A heap that counts, and refuses past a limit. */
typedef struct Heap {
    size_t held, calls, limit;
} Heap;

static void* take(void* user, size_t bytes, size_t alignment) {
    Heap* heap = user;
    if (heap->held + bytes > heap->limit) return NULL;
    ++heap->calls;
    heap->held += bytes;
    if (alignment < sizeof(void*)) alignment = sizeof(void*);
    return aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

static void give(void* user, void* memory, size_t bytes, size_t alignment) {
    (void)alignment;
    ((Heap*)user)->held -= bytes;
    free(memory);
}

typedef struct Line {
    const char* function;
    const char* message;
    uint32_t code;
    uint64_t element;
    uint32_t count;
} Line;

static void keep(void* user, const char* function, uint32_t code, const char* message, uint64_t element) {
    Line* line = user;
    *line = (Line){function, message, code, element, line->count + 1};
}

/* All objects that own memory, as far as it reaches. */
static const char* createAll(const void* bytes, size_t byteCount, uint32_t* code) {
    XgcSceneConfig scene;
    XgcIndexCacheConfig cache;
    XgcDrawListConfig draws;
    xgcSceneConfigDefaults(&scene, sizeof scene);
    xgcIndexCacheConfigDefaults(&cache, sizeof cache);
    xgcDrawListConfigDefaults(&draws, sizeof draws);
    XgcAsset* a = NULL;
    XgcScene* s = NULL;
    XgcSelection* n = NULL;
    XgcIndexCache* c = NULL;
    XgcDrawList* d = NULL;
    *code = xgcAssetOpen(bytes, byteCount, &a).code;
    if (*code == XGC_OK) *code = xgcSceneCreate(&scene, &s).code;
    if (*code == XGC_OK) *code = xgcSelectionCreate(&scene, &n).code;
    if (*code == XGC_OK) *code = xgcIndexCacheCreate(&cache, &c).code;
    if (*code == XGC_OK) *code = xgcDrawListCreate(&scene, &draws, &d).code;
    if (*code == XGC_OK) REFUSED(xgcSetAllocator(NULL)); /* objects live */
    xgcDrawListDestroy(d);
    xgcIndexCacheDestroy(c);
    xgcSelectionDestroy(n);
    xgcSceneDestroy(s);
    TRY(xgcAssetClose(a));
    return NULL;
}

static const char* checkAllocator(const void* bytes, size_t byteCount) {
    Heap heap = {0, 0, SIZE_MAX};
    XgcAllocator allocator = {take, NULL, &heap};
    uint32_t code;
    REFUSED(xgcSetAllocator(&allocator));
    allocator.free = give;
    TRY(xgcSetAllocator(&allocator));
    const char* failure = createAll(bytes, byteCount, &code);
    if (failure) return failure;
    HOLDS(code == XGC_OK && heap.calls > 20 && heap.held == 0);
    for (heap.limit = 0; heap.limit < 4 << 20; heap.limit += heap.limit < 2000 ? 40 : 100000) {
        failure = createAll(bytes, byteCount, &code);
        if (failure) return failure;
        HOLDS(code == XGC_OUT_OF_CAPACITY && heap.held == 0);
    }
    TRY(xgcSetAllocator(NULL));
    return NULL;
}

static const char* checkLog(void) {
    Line line = {NULL, NULL, 0, 0, 0};
    const XgcLog log = {keep, &line};
    XgcAsset* asset;
    xgcSetLog(&log);
    const XgcStatus status = xgcAssetOpen(NULL, 7, &asset);
    HOLDS(line.count == 1 && line.code == status.code && line.message == status.message);
    HOLDS(strcmp(line.function, "xgcAssetOpen") == 0);
    XgcSceneConfig config;
    XgcScene* scene;
    xgcSceneConfigDefaults(&config, sizeof config);
    TRY(xgcSceneCreate(&config, &scene));
    HOLDS(line.count == 1); /* nothing failed */
    REFUSED(xgcSceneSetVisible(scene, 5, 1));
    HOLDS(line.count == 2 && line.element == 5 && strcmp(line.function, "xgcSceneSetVisible") == 0);
    xgcSceneDestroy(scene);
    xgcSetLog(NULL);
    REFUSED(xgcSceneRemoveInstance(NULL, 0));
    HOLDS(line.count == 2);
    return NULL;
}

const char* checkServices(const void* bytes, size_t byteCount) {
    HOLDS(xgcAbiVersion() == XGC_ABI_VERSION);
    const char* failure = checkAllocator(bytes, byteCount);
    return failure ? failure : checkLog();
}

/* A host that knows less of a struct, and one that knows more. */
const char* checkSizes(void) {
    struct {
        XgcSceneConfig known;
        uint32_t later[2];
    } newer;
    XgcSceneConfig config;
    XgcScene* scene;
    memset(&newer, 0xff, sizeof newer);
    xgcSceneConfigDefaults(&newer.known, sizeof newer);
    HOLDS(newer.known.size == sizeof newer && newer.later[0] == 0 && newer.later[1] == 0);
    TRY(xgcSceneCreate(&newer.known, &scene));
    xgcSceneDestroy(scene);

    memset(&config, 0, sizeof config);
    xgcSceneConfigDefaults(&config, offsetof(XgcSceneConfig, assetPatchCapacity));
    HOLDS(config.size == offsetof(XgcSceneConfig, assetPatchCapacity) && config.instanceCapacity == 256);
    HOLDS(config.assetPatchCapacity == 0 && config.patchCapacity == 0); /* not written */
    config.instanceCapacity = 1;
    TRY(xgcSceneCreate(&config, &scene)); /* a patchCapacity of 0 would be refused: it was not read */
    xgcSceneDestroy(scene);
    config.size = sizeof config;
    REFUSED(xgcSceneCreate(&config, &scene));
    return NULL;
}
