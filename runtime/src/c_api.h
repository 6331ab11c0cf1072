#pragma once

#include "memory.h"

#include <xgc/draw_list.h>
#include <xgc/xgc.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <memory>

// Behind xgc.h: an object of the C API is the one of the C++ API beside what is needed to find a caller's mistakes,
// which the C++ API asserts and the C API answers with a status. One file an object (c_asset.cpp, c_scene.cpp, ...).

namespace xgc::c {

inline constexpr const char* kNull = "an argument is null";
inline constexpr const char* kNoAsset = "no such asset (the element)";
inline constexpr const char* kNoInstance = "no such instance (the element)";
inline constexpr const char* kNoPatch = "no such patch (the element)";
inline constexpr const char* kNoLevel = "no such level (the element)";
inline constexpr const char* kPatchCount = "`patchCount` is not the asset's (the element)";
inline constexpr const char* kNoMemory = "not enough memory for the object";

/// Tells the host's log of a failure. `function` is left to the default: the caller's name.
XgcStatus report(const Status& status, const char* function = __builtin_FUNCTION());

inline XgcStatus badArgument(const char* message, uint64_t element = 0, const char* function = __builtin_FUNCTION()) {
    return report({StatusCode::badArgument, message, element}, function);
}

inline XgcStatus succeeded() {
    return report({});
}

inline Status wrong(const char* message, uint64_t element = 0) {
    return {StatusCode::badArgument, message, element};
}

// Structs that grow -------------------------------------------------------------------------------------------------

/// Sizes end between two fields: no struct has padding.
template <typename T>
Status checkSize(const T* host) {
    if (!host) return wrong(kNull);
    if (host->size >= 2 * sizeof(uint32_t) && host->size % alignof(T) == 0) return {};
    return wrong("the struct's `size` (the element) is not set: call its Defaults function, or set it to its sizeof",
                 host->size);
}

/// What the host's struct has, over the defaults that are in `out`.
template <typename T>
Status readStruct(const T* host, T& out) {
    Status status = checkSize(host);
    if (status.ok()) std::memcpy(&out, host, std::min<size_t>(host->size, sizeof(T)));
    return status;
}

/// As much as the host's struct has room for.
template <typename T>
void writeStruct(T value, uint32_t size, T* host) {
    value.size = size;
    std::memcpy(host, &value, std::min<size_t>(size, sizeof(T)));
    if (size > sizeof(T)) std::memset(reinterpret_cast<char*>(host) + sizeof(T), 0, size - sizeof(T));
}

// Objects -----------------------------------------------------------------------------------------------------------

/// Counts the objects that live, which keep the allocator as it is.
void countObject(int32_t change);

/// Base of all objects: from the host's allocator.
template <typename Derived>
struct Object : Allocated<Derived> {
    Object() { countObject(1); }
    ~Object() { countObject(-1); }
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
};

/// What an asset's ids name in a scene or a cache; each keeps its asset from being closed.
class AssetTable {
public:
    ~AssetTable();
    [[nodiscard]] bool allocate(size_t capacity) { return assets_.allocate(capacity); }
    /// Null where the id names nothing.
    const XgcAsset* at(uint32_t id) const { return id < assets_.size() ? assets_[id] : nullptr; }
    uint32_t capacity() const { return uint32_t(assets_.size()); }
    void set(uint32_t id, const XgcAsset* asset);

private:
    FixedArray<const XgcAsset*> assets_;
};

/// Levels of all patches, each one that the asset has.
Status checkLevels(const AssetView& asset, const uint8_t* levels, uint32_t patchCount);
/// Likewise, but looks only at what the triangles of one patch depend on.
Status checkLevelsAround(const AssetView& asset, uint32_t patch, const uint8_t* levels, uint32_t patchCount);

/// Of geomorphs; null where there are none.
Status checkFractions(const float* fractions, uint32_t patchCount);

/// Distances of bands; null where there are none.
Status checkRising(const float* values, uint32_t count);

Status toPlacement(const XgcPlacement* given, Placement& out);
Status toView(const XgcView* given, View& out);
Status toSceneConfig(const XgcSceneConfig* given, SceneConfig& out);

} // namespace xgc::c

struct XgcAsset : xgc::c::Object<XgcAsset> {
    xgc::AssetView view;
    mutable std::atomic<uint32_t> users = 0; ///< scenes and caches, on any thread
};

struct XgcScene : xgc::c::Object<XgcScene> {
    xgc::Scene scene;
    xgc::c::AssetTable assets;
};

struct XgcSelection : xgc::c::Object<XgcSelection> {
    xgc::Selection selection;
    xgc::SceneConfig config;
    const XgcScene* scene = nullptr; ///< of the latest update
};

struct XgcIndexCache : xgc::c::Object<XgcIndexCache> {
    xgc::IndexCache cache;
    xgc::c::AssetTable assets;
};

struct XgcDrawList : xgc::c::Object<XgcDrawList> {
    xgc::DrawList list;
    xgc::DrawListConfig config;
    // From the first update on, until it is cleared.
    const XgcScene* scene = nullptr;
    XgcIndexCache* cache = nullptr;
};
