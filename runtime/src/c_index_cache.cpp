#include "c_api.h"

namespace xgc::c {
namespace {

static_assert(sizeof(XgcCopyRange) == sizeof(CopyRange) && alignof(XgcCopyRange) == alignof(CopyRange));
static_assert(offsetof(XgcCopyRange, staging) == offsetof(CopyRange, staging));
static_assert(offsetof(XgcCopyRange, arena) == offsetof(CopyRange, arena));
static_assert(offsetof(XgcCopyRange, bytes) == offsetof(CopyRange, bytes));

IndexCacheConfig toConfig(const XgcIndexCacheConfig& config) {
    return {.arenaBytes = config.arenaBytes,
            .rangeCapacity = config.rangeCapacity,
            .keyBytes = config.keyBytes,
            .assetCapacity = config.assetCapacity,
            .slotCapacity = config.slotCapacity,
            .faceCapacity = config.faceCapacity,
            .patchCapacity = config.patchCapacity,
            .domainsPerPatchCapacity = config.domainsPerPatchCapacity,
            .copyCapacity = config.copyCapacity,
            .framesInFlight = config.framesInFlight,
            .narrowIndices = config.narrowIndices != 0};
}

Status checkAsset(const XgcIndexCache* cache, uint32_t asset) {
    if (!cache) return wrong(kNull);
    return cache->assets.at(asset) ? Status{} : wrong(kNoAsset, asset);
}

Status checkRange(const XgcIndexCache* cache, uint32_t range) {
    if (!cache) return wrong(kNull);
    return cache->cache.isHeld(range) ? Status{} : wrong("no range that is held (the element)", range);
}

constexpr const char* kNoFrame = "no frame has begun: call xgcIndexCacheBeginFrame first";

} // namespace
} // namespace xgc::c

using namespace xgc;
using namespace xgc::c;

void xgcIndexCacheConfigDefaults(XgcIndexCacheConfig* config, uint32_t size) {
    if (!config) return;
    const IndexCacheConfig d;
    writeStruct({0, d.arenaBytes, d.rangeCapacity, d.keyBytes, d.assetCapacity, d.slotCapacity, d.faceCapacity,
                 d.patchCapacity, d.domainsPerPatchCapacity, d.copyCapacity, d.framesInFlight, d.narrowIndices},
                size, config);
}

XgcStatus xgcIndexCacheCreate(const XgcIndexCacheConfig* config, XgcIndexCache** cache) {
    if (!cache) return badArgument(kNull);
    XgcIndexCacheConfig wanted;
    xgcIndexCacheConfigDefaults(&wanted, sizeof wanted);
    if (const Status s = readStruct(config, wanted); !s.ok()) return report(s);
    std::unique_ptr<XgcIndexCache> made(new (std::nothrow) XgcIndexCache);
    if (!made) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    if (const Status s = made->cache.create(toConfig(wanted)); !s.ok()) return report(s);
    if (!made->assets.allocate(wanted.assetCapacity)) return report({StatusCode::outOfCapacity, kNoMemory, 0});
    *cache = made.release();
    return succeeded();
}

void xgcIndexCacheDestroy(XgcIndexCache* cache) {
    delete cache;
}

XgcStatus xgcIndexCacheAddAsset(XgcIndexCache* cache, uint32_t id, const XgcAsset* asset) {
    if (!cache || !asset) return badArgument(kNull);
    if (cache->assets.at(id)) return badArgument("the id (the element) names an asset already", id);
    if (const Status s = cache->cache.addAsset(id, asset->view); !s.ok()) return report(s);
    cache->assets.set(id, asset);
    return succeeded();
}

XgcStatus xgcIndexCacheRemoveAsset(XgcIndexCache* cache, uint32_t asset) {
    if (const Status s = checkAsset(cache, asset); !s.ok()) return report(s);
    if (const uint32_t held = cache->cache.heldRanges(asset); held > 0) {
        return badArgument("ranges of the asset (as many as the element says) are held: release them, or let draw "
                           "lists forget the asset, first",
                           held);
    }
    cache->cache.removeAsset(asset);
    cache->assets.set(asset, nullptr);
    return succeeded();
}

// A frame -----------------------------------------------------------------------------------------------------------

XgcStatus xgcIndexCacheBeginFrame(XgcIndexCache* cache, void* staging, uint32_t stagingBytes) {
    if (!cache || (!staging && stagingBytes > 0)) return badArgument(kNull);
    if (cache->cache.inFrame()) return badArgument("the frame before has not ended: call xgcIndexCacheEndFrame first");
    if (reinterpret_cast<uintptr_t>(staging) % 4 != 0) return badArgument("the staging memory is not aligned to 4");
    cache->cache.beginFrame({static_cast<std::byte*>(staging), stagingBytes});
    return succeeded();
}

XgcStatus xgcIndexCacheEndFrame(XgcIndexCache* cache) {
    if (!cache) return badArgument(kNull);
    if (!cache->cache.inFrame()) return badArgument(kNoFrame);
    cache->cache.endFrame();
    return succeeded();
}

const XgcCopyRange* xgcIndexCacheCopies(const XgcIndexCache* cache, uint32_t* count) {
    const std::span<const CopyRange> copies = cache ? cache->cache.copies() : std::span<const CopyRange>();
    if (count) *count = uint32_t(copies.size());
    return reinterpret_cast<const XgcCopyRange*>(copies.data());
}

XgcStatus xgcIndexCacheStats(const XgcIndexCache* cache, XgcIndexCacheStats* stats) {
    if (!cache) return badArgument(kNull);
    if (const Status s = checkSize(stats); !s.ok()) return report(s);
    const IndexCacheStats of = cache->cache.stats();
    writeStruct({0, of.hits, of.misses, of.evictions, of.refusals, of.uploadBytes, of.ranges, of.heldRanges,
                 of.usedBytes, of.largestFreeBytes},
                stats->size, stats);
    return succeeded();
}

// Ranges ------------------------------------------------------------------------------------------------------------

XgcStatus xgcIndexCacheAcquire(XgcIndexCache* cache, uint32_t asset, uint32_t patch, const uint8_t* levels,
                               uint32_t patchCount, uint32_t* range) {
    if (!range) return badArgument(kNull);
    if (const Status s = checkAsset(cache, asset); !s.ok()) return report(s);
    const AssetView& view = cache->assets.at(asset)->view;
    if (const Status s = checkLevelsAround(view, patch, levels, patchCount); !s.ok()) return report(s);
    if (!cache->cache.inFrame()) return badArgument(kNoFrame);
    return report(cache->cache.acquire(asset, patch, {levels, patchCount}, *range));
}

XgcStatus xgcIndexCacheAcquireWhole(XgcIndexCache* cache, uint32_t asset, uint32_t material, uint32_t number,
                                    const uint8_t* levels, uint32_t patchCount, uint32_t* range) {
    if (!range) return badArgument(kNull);
    if (const Status s = checkAsset(cache, asset); !s.ok()) return report(s);
    const AssetView& view = cache->assets.at(asset)->view;
    if (material >= view.materials.size()) return badArgument("no such material (the element)", material);
    if (const Status s = checkLevels(view, levels, patchCount); !s.ok()) return report(s);
    if (!cache->cache.inFrame()) return badArgument(kNoFrame);
    return report(cache->cache.acquireWhole(asset, material, number, {levels, patchCount}, *range));
}

XgcStatus xgcIndexCacheHold(XgcIndexCache* cache, uint32_t range) {
    if (const Status s = checkRange(cache, range); !s.ok()) return report(s);
    cache->cache.hold(range);
    return succeeded();
}

XgcStatus xgcIndexCacheRelease(XgcIndexCache* cache, uint32_t range) {
    if (const Status s = checkRange(cache, range); !s.ok()) return report(s);
    cache->cache.release(range);
    return succeeded();
}

XgcStatus xgcIndexCacheRange(const XgcIndexCache* cache, uint32_t range, XgcIndexRange* out) {
    if (const Status s = checkRange(cache, range); !s.ok()) return report(s);
    if (!out) return badArgument(kNull);
    const IndexRange at = cache->cache.at(range);
    *out = {at.firstIndex, at.indexCount, at.indexBytes, at.vertexOffset};
    return succeeded();
}

XgcStatus xgcIndexCacheBytesNeeded(const XgcIndexCache* cache, uint32_t asset, uint32_t patch, const uint8_t* levels,
                                   uint32_t patchCount, uint64_t* bytes) {
    if (!bytes) return badArgument(kNull);
    if (const Status s = checkAsset(cache, asset); !s.ok()) return report(s);
    const AssetView& view = cache->assets.at(asset)->view;
    if (const Status s = checkLevelsAround(view, patch, levels, patchCount); !s.ok()) return report(s);
    *bytes = cache->cache.bytesNeeded(asset, patch, {levels, patchCount});
    return succeeded();
}

XgcStatus xgcIndexCacheFreeStagingBytes(const XgcIndexCache* cache, uint64_t* bytes) {
    if (!cache || !bytes) return badArgument(kNull);
    if (!cache->cache.inFrame()) return badArgument(kNoFrame);
    *bytes = cache->cache.freeStagingBytes();
    return succeeded();
}
