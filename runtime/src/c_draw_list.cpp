#include "c_api.h"
#include "scene.h"

namespace xgc::c {
namespace {

static_assert(sizeof(XgcDrawCommand) == sizeof(DrawCommand) && alignof(XgcDrawCommand) == alignof(DrawCommand));
static_assert(offsetof(XgcDrawCommand, indexCount) == offsetof(DrawCommand, indexCount));
static_assert(offsetof(XgcDrawCommand, instanceCount) == offsetof(DrawCommand, instanceCount));
static_assert(offsetof(XgcDrawCommand, firstIndex) == offsetof(DrawCommand, firstIndex));
static_assert(offsetof(XgcDrawCommand, vertexOffset) == offsetof(DrawCommand, vertexOffset));
static_assert(offsetof(XgcDrawCommand, firstInstance) == offsetof(DrawCommand, firstInstance));

static_assert(sizeof(XgcDrawSource) == sizeof(DrawSource) && alignof(XgcDrawSource) == alignof(DrawSource));
static_assert(offsetof(XgcDrawSource, asset) == offsetof(DrawSource, asset));
static_assert(offsetof(XgcDrawSource, patch) == offsetof(DrawSource, patch));
static_assert(offsetof(XgcDrawSource, level) == offsetof(DrawSource, level));

static_assert(sizeof(XgcDrawBatch) == sizeof(DrawBatch) && alignof(XgcDrawBatch) == alignof(DrawBatch));
static_assert(offsetof(XgcDrawBatch, material) == offsetof(DrawBatch, material));
static_assert(offsetof(XgcDrawBatch, indexBytes) == offsetof(DrawBatch, indexBytes));
static_assert(offsetof(XgcDrawBatch, firstDraw) == offsetof(DrawBatch, firstDraw));
static_assert(offsetof(XgcDrawBatch, drawCount) == offsetof(DrawBatch, drawCount));

Status checkCapacities(const SceneConfig& has, const SceneConfig& room) {
    if (has.instanceCapacity > room.instanceCapacity || has.patchCapacity > room.patchCapacity ||
        has.assetCapacity > room.assetCapacity || has.assetPatchCapacity > room.assetPatchCapacity) {
        return wrong("the draw list was created for a smaller scene than this one");
    }
    return {};
}

/// That an asset of the scene can be drawn: the cache knows it, and the list has room.
Status checkAsset(const XgcDrawList& list, const XgcScene& scene, const XgcIndexCache& cache, uint32_t id) {
    if (cache.assets.at(id) != scene.assets.at(id)) {
        return wrong("the cache has not the scene's asset (the element): call xgcIndexCacheAddAsset with its id", id);
    }
    const AssetView& asset = scene.assets.at(id)->view;
    const uint64_t materialEnd = uint64_t(scene.scene.asset(id).firstMaterial) + asset.materials.size();
    if (materialEnd > list.config.materialCapacity) {
        return {StatusCode::outOfCapacity, "too many materials: raise XgcDrawListConfig::materialCapacity",
                materialEnd};
    }
    if (asset.domains.size() > list.config.domainCapacity) {
        return {StatusCode::outOfCapacity, "the asset has too many domains: raise XgcDrawListConfig::domainCapacity",
                asset.domains.size()};
    }
    return {};
}

Status checkUpdate(const XgcDrawList& list, const XgcScene& scene, const XgcSelection& selection,
                   const XgcIndexCache& cache) {
    if (selection.scene != &scene) return wrong("update the selection from this scene first");
    if (!cache.cache.inFrame()) return wrong("no frame has begun: call xgcIndexCacheBeginFrame first");
    if ((list.scene && list.scene != &scene) || (list.cache && list.cache != &cache)) {
        return wrong("the draw list belongs to another scene or cache: clear it first");
    }
    if (Status s = checkCapacities(scene.scene.config(), list.config.scene); !s.ok()) return s;
    for (uint32_t id = 0; id < scene.assets.capacity(); ++id) {
        if (scene.scene.impl().assets[id].instanceCount == 0) continue;
        if (Status s = checkAsset(list, scene, cache, id); !s.ok()) return s;
    }
    return {};
}

/// The array of the C++ API as one of the C API, whose elements lie alike.
template <typename To, typename From>
const To* arrayOf(std::span<const From> array, uint32_t* count) {
    static_assert(sizeof(To) == sizeof(From));
    if (count) *count = uint32_t(array.size());
    return reinterpret_cast<const To*>(array.data());
}

} // namespace
} // namespace xgc::c

using namespace xgc;
using namespace xgc::c;

void xgcDrawListConfigDefaults(XgcDrawListConfig* config, uint32_t size) {
    if (!config) return;
    const DrawListConfig d;
    writeStruct({0, d.materialCapacity, d.wholeTriangles, d.wholeRangeCapacity, d.domainCapacity}, size, config);
}

XgcStatus xgcDrawListCreate(const XgcSceneConfig* scene, const XgcDrawListConfig* config, XgcDrawList** list) {
    if (!list) return badArgument(kNull);
    DrawListConfig wanted;
    if (const Status s = toSceneConfig(scene, wanted.scene); !s.ok()) return report(s);
    XgcDrawListConfig given;
    xgcDrawListConfigDefaults(&given, sizeof given);
    if (const Status s = readStruct(config, given); !s.ok()) return report(s);
    wanted.materialCapacity = given.materialCapacity;
    wanted.wholeTriangles = given.wholeTriangles;
    wanted.wholeRangeCapacity = given.wholeRangeCapacity;
    wanted.domainCapacity = given.domainCapacity;
    std::unique_ptr<XgcDrawList> made(new (std::nothrow) XgcDrawList);
    if (!made) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    if (const Status s = made->list.create(wanted); !s.ok()) return report(s);
    made->config = wanted;
    *list = made.release();
    return succeeded();
}

void xgcDrawListDestroy(XgcDrawList* list) {
    delete list;
}

XgcStatus xgcDrawListUpdate(XgcDrawList* list, const XgcScene* scene, const XgcSelection* selection,
                            XgcIndexCache* cache) {
    if (!list || !scene || !selection || !cache) return badArgument(kNull);
    if (const Status s = checkUpdate(*list, *scene, *selection, *cache); !s.ok()) return report(s);
    list->scene = scene;
    list->cache = cache;
    list->list.update(scene->scene, selection->selection, cache->cache);
    return succeeded();
}

XgcStatus xgcDrawListForgetAsset(XgcDrawList* list, uint32_t asset) {
    if (!list) return badArgument(kNull);
    if (asset >= list->config.scene.assetCapacity) return badArgument(kNoAsset, asset);
    if (list->cache) list->list.forgetAsset(asset, list->cache->cache);
    return succeeded();
}

XgcStatus xgcDrawListClear(XgcDrawList* list) {
    if (!list) return badArgument(kNull);
    if (list->cache) list->list.clear(list->cache->cache);
    list->scene = nullptr;
    list->cache = nullptr;
    return succeeded();
}

// What is drawn -----------------------------------------------------------------------------------------------------

const XgcDrawCommand* xgcDrawListDraws(const XgcDrawList* list, uint32_t* count) {
    return arrayOf<XgcDrawCommand>(list ? list->list.draws() : std::span<const DrawCommand>(), count);
}

const XgcDrawSource* xgcDrawListSources(const XgcDrawList* list, uint32_t* count) {
    return arrayOf<XgcDrawSource>(list ? list->list.sources() : std::span<const DrawSource>(), count);
}

const XgcDrawBatch* xgcDrawListBatches(const XgcDrawList* list, uint32_t* count) {
    return arrayOf<XgcDrawBatch>(list ? list->list.batches() : std::span<const DrawBatch>(), count);
}

const uint32_t* xgcDrawListInstances(const XgcDrawList* list, uint32_t* count) {
    return arrayOf<uint32_t>(list ? list->list.drawInstances() : std::span<const uint32_t>(), count);
}

XgcStatus xgcDrawListInstance(const XgcDrawList* list, uint32_t instance, XgcInstanceLevels* out) {
    if (!list) return badArgument(kNull);
    if (const Status s = checkSize(out); !s.ok()) return report(s);
    if (instance >= list->config.scene.instanceCapacity) return badArgument(kNoInstance, instance);
    const InstanceKind kind = list->list.kind(instance);
    XgcInstanceLevels value{};
    value.kind = uint32_t(kind);
    value.wholeState = kind == InstanceKind::whole ? list->list.wholeState(instance) : XGC_NONE;
    if (kind == InstanceKind::mixed) {
        value.patchCount = uint32_t(list->list.levels(instance).size());
        value.levels = list->list.levels(instance).data();
        value.fractions = list->list.fractions(instance).data();
    }
    writeStruct(value, out->size, out);
    return succeeded();
}

XgcStatus xgcDrawListStats(const XgcDrawList* list, XgcDrawStats* stats) {
    if (!list) return badArgument(kNull);
    if (const Status s = checkSize(stats); !s.ok()) return report(s);
    const DrawStats& of = list->list.stats();
    writeStruct({0, of.instances, of.triangles, of.changedPatches, of.reboundPatches, of.deferredInstances, 0},
                stats->size, stats);
    return succeeded();
}

XgcStatus xgcDrawListRefusal(const XgcDrawList* list, XgcStatus* refusal) {
    if (!list || !refusal) return badArgument(kNull);
    const Status& status = list->list.refusal();
    *refusal = {uint32_t(status.code), 0, status.message, status.element};
    return succeeded();
}
