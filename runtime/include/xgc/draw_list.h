#pragma once

#include <xgc/indices.h>

#include <memory>

namespace xgc {

/// `count` indices to copy from the frame's staging memory into the index arena, offsets in indices.
struct CopyRange {
    uint32_t staging;
    uint32_t arena;
    uint32_t count;
};

/// Byte for byte a VkDrawIndexedIndirectCommand (and D3D12_DRAW_INDEXED_ARGUMENTS).
struct DrawCommand {
    uint32_t indexCount;
    uint32_t instanceCount;
    uint32_t firstIndex;
    int32_t vertexOffset;
    uint32_t firstInstance; ///< the instance's id: the renderer's key to its transform
};
static_assert(sizeof(DrawCommand) == 20);

/// Names the patch that a draw command draws: index for index beside the commands.
struct DrawPatch {
    uint32_t instance;
    uint32_t patch;
};

/// A run of draw commands that share a material.
struct DrawBatch {
    uint32_t material; ///< renderer-wide: the instance's firstMaterial + the asset's material
    uint32_t firstDraw;
    uint32_t drawCount;
};

struct DrawListConfig {
    uint32_t instanceCapacity = 1;
    uint32_t patchCapacity = 4096;     ///< sum of the patches of all instances; the most draws of a frame
    uint32_t materialCapacity = 256;   ///< renderer-wide
    uint32_t slotCapacity = 65536;     ///< largest scratchCapacity of the assets
    uint32_t domainCapacity = 65536;   ///< largest domain count of the assets
    uint32_t indexCapacity = 1u << 24; ///< of the arena, in indices
    uint32_t framesInFlight = 2;       ///< a freed range is reused so many frames later; at least 1
};

/// What an instance is to the draw list. `asset` must outlive the instance.
struct InstanceDesc {
    const AssetView* asset = nullptr;
    int32_t vertexOffset = 0;   ///< of the asset's row 0 in the renderer's vertex arena
    uint32_t firstMaterial = 0; ///< of the asset's material 0 in the renderer's list
};

struct FrameStats {
    uint32_t triangles = 0;
    uint32_t patchesChanged = 0; ///< got another level (all, when an instance is first set)
    uint32_t patchesRebuilt = 0; ///< got other indices: those, and the neighbours that their change touched
    uint32_t uploadBytes = 0;
    uint32_t deferredInstances = 0; ///< kept their whole previous state: staging or arena was full
};

/// Turns levels into draws: keeps, for each instance, the index range of every patch in one index
/// arena, rebuilds what a change of levels touches, and says what to copy and what to draw. Knows no
/// graphics API: the arena is only offsets.
///
/// A frame: wait until the frame framesInFlight before this one has left the GPU; `beginFrame(staging)`,
/// `setLevels` for the instances whose levels may have changed, `endFrame()`; then copy `copies()`, then draw
/// `draws()`. Copies never touch a range that a frame in flight draws, so they need no wait, only a barrier between
/// them and the draws.
///
/// All memory is allocated by `create`; nothing else allocates. An instance changes to new levels as a whole or not
/// at all, so no frame has a crack or a hole. A call that is given an id of no instance, or levels of the wrong
/// number or past the asset's, is a programming error (asserted). One thread at a time.
///
/// Sizes: the arena holds what is drawn, plus what framesInFlight frames replace. Staging holds what one frame
/// replaces; the first `setLevels` of an instance replaces all of it, so start far or coarse where memory is short.
class DrawList {
public:
    DrawList();
    ~DrawList();
    DrawList(DrawList&&) noexcept;
    DrawList& operator=(DrawList&&) noexcept;

    /// Allocates for the config. Replaces what was there.
    Status create(const DrawListConfig& config);

    /// Adds an instance, drawn from the first frame in which `setLevels` succeeds for it. In or between frames. On
    /// failure `instance` is untouched, and the status' element is the value that would have sufficed.
    Status addInstance(const InstanceDesc& desc, uint32_t& instance);
    /// Its ranges are reused framesInFlight frames later; its id at once. In or between frames.
    void removeInstance(uint32_t instance);

    /// Starts a frame. New indices are written to `staging` (for instance mapped memory), which must
    /// stay valid until the renderer has copied from it.
    void beginFrame(std::span<uint32_t> staging);
    /// Sets the levels of an instance for this frame and on. Where staging or arena is full it keeps
    /// its previous state, counts as deferred, and the status says what to raise (element: the indices that the
    /// change needs at most): ask again next frame. An instance that is not set keeps its levels and costs nothing.
    Status setLevels(uint32_t instance, Levels levels);
    /// Levels that the instance is drawn at; empty before its first success. Valid until the instance is removed.
    Levels levels(uint32_t instance) const;
    /// Sorts draws by material, then instance, then patch, and closes the frame. Keeps the last ones where nothing
    /// changed.
    void endFrame();

    // Valid from endFrame to the next beginFrame.
    std::span<const CopyRange> copies() const;
    std::span<const DrawCommand> draws() const;
    std::span<const DrawPatch> drawPatches() const;
    std::span<const DrawBatch> batches() const;
    const FrameStats& stats() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
