#include "c_api.h"

#include <xgc/morph.h>

#include <cfloat>
#include <cmath>

// What belongs to no object: the host's services, statuses, views and placements.

namespace xgc::c {
namespace {

XgcLog hostLog{};
std::atomic<int32_t> objectCount = 0;

static_assert(XGC_NONE == format::kNone && XGC_MAX_LEVELS == format::kMaxLevels);
static_assert(XGC_ALIGNMENT == format::kAlignment);
static_assert(XGC_OK == uint32_t(StatusCode::ok) && XGC_BAD_ARGUMENT == uint32_t(StatusCode::badArgument));
static_assert(XGC_NOT_AN_ASSET == uint32_t(StatusCode::notAnAsset));
static_assert(XGC_BAD_VERSION == uint32_t(StatusCode::badVersion));
static_assert(XGC_UNSUPPORTED == uint32_t(StatusCode::unsupported));
static_assert(XGC_TRUNCATED == uint32_t(StatusCode::truncated));
static_assert(XGC_BAD_CHECKSUM == uint32_t(StatusCode::badChecksum));
static_assert(XGC_CORRUPT == uint32_t(StatusCode::corrupt));
static_assert(XGC_OUT_OF_CAPACITY == uint32_t(StatusCode::outOfCapacity));
static_assert(XGC_DEVICE_REFUSED == uint32_t(StatusCode::deviceRefused));

bool finite(const float* values, size_t count) {
    return std::all_of(values, values + count, [](float value) { return std::isfinite(value); });
}

glm::mat4 matrix(const float* columns) {
    glm::mat4 m(1);
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = columns[i];
    return m;
}

XgcView fromView(const View& view) {
    return {{view.eye.x, view.eye.y, view.eye.z},
            view.pixelsPerUnit,
            view.nearest,
            view.orthographic,
            {view.forward.x, view.forward.y, view.forward.z}};
}

} // namespace

XgcStatus report(const Status& status, const char* function) {
    if (!status.ok() && hostLog.write) {
        hostLog.write(hostLog.user, function, uint32_t(status.code), status.message, status.element);
    }
    return {uint32_t(status.code), 0, status.message, status.element};
}

void countObject(int32_t change) {
    objectCount.fetch_add(change, std::memory_order_relaxed);
}

Status checkLevels(const AssetView& asset, const uint8_t* levels, uint32_t patchCount) {
    if (!levels) return wrong(kNull);
    if (patchCount != asset.patchCount()) return wrong(kPatchCount, asset.patchCount());
    for (uint32_t p = 0; p < patchCount; ++p) {
        if (levels[p] >= asset.levelCount()) return wrong("a patch (the element) has a level that is not there", p);
    }
    return {};
}

Status checkLevelsAround(const AssetView& asset, uint32_t patch, const uint8_t* levels, uint32_t patchCount) {
    if (!levels) return wrong(kNull);
    if (patch >= asset.patchCount()) return wrong(kNoPatch, patch);
    if (patchCount != asset.patchCount()) return wrong(kPatchCount, asset.patchCount());
    const auto there = [&](uint32_t p) { return levels[p] < asset.levelCount(); };
    uint32_t bad = there(patch) ? format::kNone : patch;
    for (const uint32_t domain : asset.domainsOf(patch)) {
        for (const uint32_t p : asset.patchesOf(domain)) bad = there(p) ? bad : p;
    }
    if (bad != format::kNone) return wrong("a patch (the element) has a level that is not there", bad);
    return {};
}

Status checkFractions(const float* fractions, uint32_t patchCount) {
    for (uint32_t p = 0; fractions && p < patchCount; ++p) {
        if (!(fractions[p] >= 0 && fractions[p] <= kMaxFraction)) {
            return wrong("the fraction of a patch (the element) must lie between 0 and 1 - 1/16384", p);
        }
    }
    return {};
}

Status checkRising(const float* values, uint32_t count) {
    if (count > 0 && !values) return wrong(kNull);
    for (uint32_t i = 0; i < count; ++i) {
        const bool rises = i == 0 || values[i] >= values[i - 1];
        if (std::isnan(values[i]) || !rises) return wrong("a distance (the element) is below the one before it", i);
    }
    return {};
}

Status toPlacement(const XgcPlacement* given, Placement& out) {
    if (!given) return wrong(kNull);
    if (!(given->maxScale > 0) || !finite(&given->maxScale, 1) || !finite(given->toWorld, 12)) {
        return wrong("the placement is not finite, or its maxScale is not positive: make it with xgcMakePlacement");
    }
    for (int i = 0; i < 12; ++i) out.toWorld[i / 3][i % 3] = given->toWorld[i];
    out.maxScale = given->maxScale;
    return {};
}

Status toView(const XgcView* given, View& out) {
    if (!given) return wrong(kNull);
    if (!finite(given->eye, 3) || !finite(given->forward, 3) || !(given->pixelsPerUnit >= 0) ||
        !(given->nearest >= 0)) {
        return wrong("the view is not finite, or its pixelsPerUnit or nearest is negative: make it with xgcMakeView");
    }
    out = {.eye = {given->eye[0], given->eye[1], given->eye[2]},
           .pixelsPerUnit = given->pixelsPerUnit,
           .nearest = given->nearest,
           .orthographic = given->orthographic != 0,
           .forward = {given->forward[0], given->forward[1], given->forward[2]}};
    return {};
}

} // namespace xgc::c

using namespace xgc;
using namespace xgc::c;

uint32_t xgcAbiVersion(void) {
    return XGC_ABI_VERSION;
}

// The host's services -----------------------------------------------------------------------------------------------

XgcStatus xgcSetAllocator(const XgcAllocator* allocator) {
    if (objectCount.load() != 0) {
        return badArgument("objects (as many as the element says) still hold memory of the allocator that is set",
                           uint64_t(objectCount.load()));
    }
    if (!allocator) {
        setAllocator({});
        return succeeded();
    }
    if (!allocator->allocate || !allocator->free) return badArgument("an allocator needs `allocate` and `free`");
    setAllocator({allocator->allocate, allocator->free, allocator->user});
    return succeeded();
}

void xgcSetLog(const XgcLog* log) {
    hostLog = log ? *log : XgcLog{};
}

// Views and placements ----------------------------------------------------------------------------------------------

XgcStatus xgcMakeView(const float eye[3], float fovY, float viewportHeight, XgcView* view) {
    if (!eye || !view) return badArgument(kNull);
    if (!finite(eye, 3)) return badArgument("the eye is not finite");
    if (!(fovY > 0 && fovY < 3.1415926f)) return badArgument("fovY must lie between 0 and pi");
    if (!(viewportHeight > 0 && viewportHeight <= FLT_MAX)) return badArgument("viewportHeight must be positive");
    *view = fromView(makeView({eye[0], eye[1], eye[2]}, fovY, viewportHeight));
    return succeeded();
}

XgcStatus xgcMakeOrthographicView(const float eye[3], const float forward[3], float height, float viewportHeight,
                                  XgcView* view) {
    if (!eye || !forward || !view) return badArgument(kNull);
    if (!finite(eye, 3) || !finite(forward, 3)) return badArgument("eye or forward is not finite");
    const float squared = forward[0] * forward[0] + forward[1] * forward[1] + forward[2] * forward[2];
    if (!(squared >= FLT_MIN && squared <= FLT_MAX)) return badArgument("forward has no direction");
    if (!(height > 0 && height <= FLT_MAX)) return badArgument("height must be positive");
    if (!(viewportHeight > 0 && viewportHeight <= FLT_MAX)) return badArgument("viewportHeight must be positive");
    *view = fromView(
        makeOrthographicView({eye[0], eye[1], eye[2]}, {forward[0], forward[1], forward[2]}, height, viewportHeight));
    return succeeded();
}

XgcStatus xgcMakePlacement(const float toWorld[16], XgcPlacement* placement) {
    if (!toWorld || !placement) return badArgument(kNull);
    if (!finite(toWorld, 16)) return badArgument("the matrix is not finite");
    if (toWorld[3] != 0 || toWorld[7] != 0 || toWorld[11] != 0 || toWorld[15] != 1) {
        return badArgument("the matrix is not affine: its last row must be 0 0 0 1");
    }
    double squares = 0; // bounds the square of the scale
    for (int i = 0; i < 11; ++i) squares += double(toWorld[i]) * double(toWorld[i]);
    if (!(squares >= double(FLT_MIN) && squares <= double(FLT_MAX))) {
        return badArgument("the matrix is zero, or scales out of the range of floats");
    }
    const Placement made = makePlacement(matrix(toWorld));
    for (int i = 0; i < 12; ++i) placement->toWorld[i] = made.toWorld[i / 3][i % 3];
    placement->maxScale = made.maxScale;
    return succeeded();
}

XgcStatus xgcMakeFrustum(const float worldToClip[16], XgcFrustum* frustum) {
    if (!worldToClip || !frustum) return badArgument(kNull);
    if (!finite(worldToClip, 16)) return badArgument("the matrix is not finite");
    const Frustum made = makeFrustum(matrix(worldToClip));
    *frustum = {};
    frustum->planeCount = made.planeCount;
    for (uint32_t i = 0; i < made.planeCount; ++i) {
        for (int k = 0; k < 4; ++k) frustum->planes[i][k] = made.planes[i][k];
    }
    return succeeded();
}
