#include "flight.h"
#include "try.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

void flightPlace(uint32_t instance, float radius, float toWorld[16]) {
    memcpy(toWorld, kIdentity, sizeof kIdentity);
    toWorld[5] = 1.0f + 0.25f * (float)(instance % 6);
    toWorld[12] = 3 * radius * ((float)(instance % 8) - 3.5f);
    toWorld[14] = 4 * radius * (float)(instance / 8) - 20 * radius;
}

FlightStep flightStep(uint32_t frame, float radius) {
    FlightStep step;
    memset(&step, 0, sizeof step);
    const float t = (float)frame / kFlightFrames;
    const float away = radius * (2 + 60 * t * t);
    step.eye[0] = away * sinf(5 * t);
    step.eye[1] = radius * t;
    step.eye[2] = away * cosf(5 * t);
    step.forward[0] = -sinf(5 * t);
    step.forward[2] = -cosf(5 * t);
    /* Half-spaces to either side of the eye: w = distance along forward. */
    const float right[3] = {step.forward[2], 0, -step.forward[0]};
    for (int i = 0; i < 3; ++i) {
        step.worldToClip[4 * i] = right[i];
        step.worldToClip[4 * i + 1] = i == 1 ? 1.0f : 0.0f;
        step.worldToClip[4 * i + 2] = 0.5f * step.forward[i];
        step.worldToClip[4 * i + 3] = step.forward[i];
        step.worldToClip[12] -= right[i] * step.eye[i];
        step.worldToClip[14] -= 0.5f * step.forward[i] * step.eye[i];
        step.worldToClip[15] -= step.forward[i] * step.eye[i];
    }
    step.worldToClip[13] = -step.eye[1];
    step.triangleBudget = frame % 3 == 2 ? 1500 : 0;
    step.morphs = frame % 12 > 8 && step.triangleBudget == 0;
    for (uint32_t i = 0; i < 3; ++i) step.bands[i] = 4 + 8 * (float)i;
    step.usesBands = frame / 8 % 2;
    step.moved = frame % kFlightInstances;
    flightPlace(step.moved, radius, step.toWorld);
    step.toWorld[13] = 0.1f * radius * (float)frame;
    return step;
}

uint64_t flightHash(uint64_t hash, const void* bytes, size_t count) {
    const unsigned char* at = bytes;
    for (size_t i = 0; i < count; ++i) hash = (hash ^ at[i]) * 0x100000001b3ull;
    return hash;
}

void flightRunJobs(void* calls, uint32_t count, void (*job)(void* data, uint32_t index), void* data) {
    ++*(uint32_t*)calls;
    while (count-- > 0) job(data, count);
}

typedef struct World {
    XgcAsset* assets[2];
    XgcScene* scene;
    XgcSelection* selections[2];
    XgcDrawList* lists[2];
    XgcIndexCache* cache;
    uint32_t ids[2];
    uint32_t instances[kFlightInstances];
    float radius;
    void* staging;
} World;

static const char* fill(World* w, const void* const bytes[2], const size_t byteCounts[2]) {
    int32_t row = 0;
    uint32_t material = 0;
    for (int i = 0; i < 2; ++i) {
        XgcAssetInfo info;
        XgcAssetDesc desc;
        info.size = sizeof info;
        TRY(xgcAssetOpen(bytes[i], byteCounts[i], &w->assets[i]));
        TRY(xgcAssetInfo(w->assets[i], &info));
        xgcAssetDescDefaults(&desc, sizeof desc);
        desc.vertexOffset = row;
        desc.firstMaterial = material;
        TRY(xgcSceneAddAsset(w->scene, w->assets[i], &desc, &w->ids[i]));
        TRY(xgcIndexCacheAddAsset(w->cache, w->ids[i], w->assets[i]));
        row += (int32_t)info.vertexCount;
        material += info.materialCount;
        w->radius = info.sphereRadius;
    }
    for (uint32_t i = 0; i < kFlightInstances; ++i) {
        float toWorld[16];
        XgcPlacement placement;
        flightPlace(i, w->radius, toWorld);
        TRY(xgcMakePlacement(toWorld, &placement));
        TRY(xgcSceneAddInstance(w->scene, w->ids[i % 2], &placement, &w->instances[i]));
    }
    return NULL;
}

static const char* create(World* w, const void* const bytes[2], const size_t byteCounts[2]) {
    XgcSceneConfig scene;
    XgcIndexCacheConfig cache;
    XgcDrawListConfig draws;
    xgcSceneConfigDefaults(&scene, sizeof scene);
    xgcIndexCacheConfigDefaults(&cache, sizeof cache);
    xgcDrawListConfigDefaults(&draws, sizeof draws);
    cache.arenaBytes = kFlightArena;
    draws.wholeTriangles = 400;
    TRY(xgcSceneCreate(&scene, &w->scene));
    TRY(xgcIndexCacheCreate(&cache, &w->cache));
    for (int v = 0; v < 2; ++v) {
        TRY(xgcSelectionCreate(&scene, &w->selections[v]));
        TRY(xgcDrawListCreate(&scene, &draws, &w->lists[v]));
    }
    w->staging = calloc(1, kFlightStaging);
    return fill(w, bytes, byteCounts);
}

/* In frames of their own: a part that is steered, one that is hidden, and back; an instance that is not seen. */
static const char* steer(World* w, uint32_t frame) {
    XgcPartControl control;
    xgcPartControlDefaults(&control, sizeof control);
    uint32_t part = 0;
    XgcPart named;
    named.size = sizeof named;
    TRY(xgcAssetPart(w->assets[0], 1, &named));
    TRY(xgcAssetFindPart(w->assets[0], named.stableId, &part));
    if (frame == 10) {
        control.importance = 4;
        control.coarsest = 1;
        TRY(xgcSceneSetPart(w->scene, w->instances[0], part, &control));
    }
    if (frame == 15) {
        control.hidden = 1;
        TRY(xgcSceneSetPart(w->scene, w->instances[2], part, &control));
    }
    if (frame == 25) TRY(xgcSceneClearParts(w->scene, w->instances[2]));
    if (frame == 20 || frame == 30) TRY(xgcSceneSetVisible(w->scene, w->instances[4], frame == 30));
    return NULL;
}

static const char* choose(World* w, const FlightStep* step, uint32_t* jobCalls) {
    XgcSelectionDesc desc;
    xgcSelectionDescDefaults(&desc, sizeof desc);
    TRY(xgcMakeView(step->eye, 1.0f, 1080.0f, &desc.view));
    desc.view.nearest = 0.1f;
    desc.pixels = 2;
    desc.hysteresis = step->morphs ? 0 : 0.05f;
    desc.morph = step->morphs;
    desc.triangleBudget = step->triangleBudget;
    desc.boundPixels = 1;
    desc.cullBackfaces = 1;
    desc.jobs.run = flightRunJobs;
    desc.jobs.user = jobCalls;
    TRY(xgcMakeFrustum(step->worldToClip, &desc.frustum));
    TRY(xgcSelectionUpdate(w->selections[0], w->scene, &desc));

    xgcSelectionDescDefaults(&desc, sizeof desc);
    TRY(xgcMakeOrthographicView(step->eye, step->forward, 20 * w->radius, 512, &desc.view));
    if (step->usesBands) {
        TRY(xgcMakeView(step->eye, 1.0f, 512.0f, &desc.view));
        desc.policy = XGC_POLICY_DISTANCE_BANDS;
        desc.bands = step->bands;
        desc.bandCount = 3;
    }
    desc.reference = w->selections[0];
    desc.coarserThanReference = 1;
    desc.contributionPixels = 2;
    TRY(xgcSelectionUpdate(w->selections[1], w->scene, &desc));
    return NULL;
}

static const char* hashView(const World* w, int v, FlightFrame* out) {
    uint64_t levels = 1, draws = 1;
    for (uint32_t i = 0; i < kFlightInstances; ++i) {
        XgcInstanceLevels at;
        at.size = sizeof at;
        TRY(xgcSelectionInstance(w->selections[v], w->instances[i], &at));
        levels = flightHash(levels, &at.kind, sizeof at.kind);
        levels = flightHash(levels, &at.wholeState, sizeof at.wholeState);
        levels = flightHash(levels, at.levels, at.patchCount);
        levels = flightHash(levels, at.visible, at.patchCount);
        if (at.fractions) levels = flightHash(levels, at.fractions, at.patchCount * sizeof(float));
        TRY(xgcDrawListInstance(w->lists[v], w->instances[i], &at));
        levels = flightHash(levels, &at.kind, sizeof at.kind);
        levels = flightHash(levels, &at.wholeState, sizeof at.wholeState);
        levels = flightHash(levels, at.levels, at.patchCount);
        if (at.fractions) levels = flightHash(levels, at.fractions, at.patchCount * sizeof(float));
    }
    uint32_t count;
    const XgcDrawCommand* commands = xgcDrawListDraws(w->lists[v], &count);
    draws = flightHash(draws, commands, count * sizeof *commands);
    const XgcDrawSource* sources = xgcDrawListSources(w->lists[v], &count);
    draws = flightHash(draws, sources, count * sizeof *sources);
    const XgcDrawBatch* batches = xgcDrawListBatches(w->lists[v], &count);
    draws = flightHash(draws, batches, count * sizeof *batches);
    const uint32_t* instances = xgcDrawListInstances(w->lists[v], &count);
    draws = flightHash(draws, instances, count * sizeof *instances);
    out->levels[v] = levels;
    out->draws[v] = draws;
    return NULL;
}

static const char* hashStats(const World* w, FlightFrame* out) {
    uint64_t hash = 1;
    for (int v = 0; v < 2; ++v) {
        XgcSelectionStats chosen;
        XgcDrawStats drawn;
        chosen.size = sizeof chosen;
        drawn.size = sizeof drawn;
        TRY(xgcSelectionStats(w->selections[v], &chosen));
        TRY(xgcDrawListStats(w->lists[v], &drawn));
        hash = flightHash(hash, &chosen.visibleInstances, sizeof chosen - sizeof chosen.size);
        hash = flightHash(hash, &drawn.instances, sizeof drawn - sizeof drawn.size);
    }
    XgcIndexCacheStats built;
    built.size = sizeof built;
    TRY(xgcIndexCacheStats(w->cache, &built));
    out->stats = flightHash(hash, &built.hits, sizeof built - sizeof built.size);
    return NULL;
}

static const char* frame(World* w, uint32_t number, FlightFrame* out, uint32_t* jobCalls) {
    const FlightStep step = flightStep(number, w->radius);
    XgcPlacement placement;
    TRY(xgcMakePlacement(step.toWorld, &placement));
    TRY(xgcSceneSetPlacement(w->scene, w->instances[step.moved], &placement));
    const char* failure = steer(w, number);
    if (!failure) failure = choose(w, &step, jobCalls);
    if (failure) return failure;
    TRY(xgcIndexCacheBeginFrame(w->cache, w->staging, kFlightStaging));
    for (int v = 0; v < 2; ++v) TRY(xgcDrawListUpdate(w->lists[v], w->scene, w->selections[v], w->cache));
    TRY(xgcIndexCacheEndFrame(w->cache));
    uint32_t count;
    const XgcCopyRange* copies = xgcIndexCacheCopies(w->cache, &count);
    out->copies = flightHash(1, copies, count * sizeof *copies);
    for (uint32_t i = 0; i < count; ++i) {
        out->copies = flightHash(out->copies, (const char*)w->staging + copies[i].staging, copies[i].bytes);
    }
    for (int v = 0; v < 2 && !failure; ++v) failure = hashView(w, v, out);
    return failure ? failure : hashStats(w, out);
}

static const char* destroy(World* w) {
    for (int v = 0; v < 2; ++v) {
        if (w->lists[v]) TRY(xgcDrawListClear(w->lists[v]));
        xgcDrawListDestroy(w->lists[v]);
        xgcSelectionDestroy(w->selections[v]);
    }
    xgcIndexCacheDestroy(w->cache);
    xgcSceneDestroy(w->scene);
    for (int i = 0; i < 2; ++i) TRY(xgcAssetClose(w->assets[i]));
    free(w->staging);
    return NULL;
}

const char* fly(const void* const bytes[2], const size_t byteCounts[2], FlightFrame frames[kFlightFrames],
                uint32_t* jobCalls) {
    World world;
    memset(&world, 0, sizeof world);
    const char* failure = create(&world, bytes, byteCounts);
    for (uint32_t i = 0; i < kFlightFrames && !failure; ++i) failure = frame(&world, i, &frames[i], jobCalls);
    const char* end = destroy(&world);
    return failure ? failure : end;
}
