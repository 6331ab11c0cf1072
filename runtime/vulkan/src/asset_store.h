#pragma once

#include "buffer.h"
#include "range_list.h"
#include "shared.h"
#include "streamed_rows.h"
#include "uploader.h"

#include <xgc/morph.h>
#include <xgc/vulkan/renderer.h>

#include <array>
#include <utility>
#include <vector>

namespace xgc::vulkan {

/// An asset on the device.
struct StoredAsset {
    AssetView view;
    uint32_t streamed = format::kNone; ///< its id in the residency
    uint32_t generation = 0;           ///< odd while it is there
    uint32_t sceneAsset = 0;           ///< its id in the renderer's scene
    uint32_t instanceCount = 0;
    bool onGpu = false;         ///< compute shaders can draw it
    RangeList::Range bytes;     ///< in the vertex arena, units of AssetStore::kAlignment
    RangeList::Range materials; ///< in the renderer's list
    std::vector<uint8_t> partColors;
    VkDeviceAddress positions = 0, normals = 0, colors = 0;
    VkDeviceAddress morphs = 0;
    std::array<VkDeviceAddress, 2> joints{}, weights{};
    VkDeviceAddress targetRows = 0, targetDeltas = 0;
    std::vector<MorphRow> morphRows; ///< where the renderer morphs
    format::StreamFormat colorFormat{};

    bool alive() const { return generation % 2 == 1; }
};

/// The vertex arena, the material list, and which asset lies where. Shaders reach streams by address, so the arena may
/// be larger than the largest storage buffer range.
class AssetStore {
public:
    static constexpr VkDeviceSize kAlignment = 64;

    /// Bytes of the arena that an asset takes.
    static uint64_t bytesOf(const AssetView& view, bool morphs);

    Status create(const Context& context, const RendererConfig& config);

    Status add(const AssetView& view, AssetHandle& handle);
    /// Of a residency: its rows lie in `rows`.
    Status addStreamed(const AssetView& view, uint32_t residencyAsset, const StreamedRows& rows, AssetHandle& handle);
    /// Memory returns to the arena framesInFlight frames after `frame`.
    Status remove(AssetHandle handle, uint64_t frame);
    /// Gives back what no frame in flight reads.
    void reclaim(uint64_t frame, uint32_t framesInFlight);

    /// Null for a stale handle.
    const StoredAsset* find(AssetHandle handle) const;
    StoredAsset* find(AssetHandle handle) { return const_cast<StoredAsset*>(std::as_const(*this).find(handle)); }
    const StoredAsset& at(uint32_t index) const { return assets_[index]; }
    StoredAsset& at(uint32_t index) { return assets_[index]; }

    Uploader& uploads() { return uploads_; }
    const Uploader& uploads() const { return uploads_; }
    const Buffer& arena() const { return arena_; }
    const Buffer& materials() const { return materials_; }
    /// Which pipeline draws a material of the renderer's list: it is of one asset.
    struct MaterialKind {
        bool masked = false; ///< alpha-tested
        bool posable = false;
    };
    MaterialKind kindOf(uint32_t material) const { return kinds_[material]; }

private:
    struct Retired {
        uint64_t frame;
        RangeList::Range bytes, materials;
    };

    /// Enters what add and addStreamed have in common; `asset` has its view.
    Status enter(StoredAsset&& asset, AssetHandle& handle);
    Status place(StoredAsset& asset);
    void queueStreams(StoredAsset& asset, uint32_t index);
    void writeMaterials(const StoredAsset& asset);

    Buffer arena_;
    RangeList arenaRanges_;
    Buffer materials_; ///< written by the host where no frame reads
    RangeList materialRanges_;
    std::vector<MaterialKind> kinds_; ///< a material each
    Uploader uploads_;
    bool morphs_ = false;
    std::vector<StoredAsset> assets_;
    std::vector<Retired> retired_; ///< oldest first
};

} // namespace xgc::vulkan
