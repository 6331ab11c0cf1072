#pragma once

#include <xgc/index_cache.h>
#include <xgc/selection.h>

#include <memory>

namespace xgc {

/// Byte for byte a VkDrawIndexedIndirectCommand (and D3D12_DRAW_INDEXED_ARGUMENTS).
struct DrawCommand {
    uint32_t indexCount;
    uint32_t instanceCount;
    uint32_t firstIndex;
    int32_t vertexOffset;
    uint32_t firstInstance; ///< of its ids in drawInstances()
};
static_assert(sizeof(DrawCommand) == 20);

/// What a draw command draws: index for index beside the commands.
struct DrawSource {
    uint32_t asset;
    uint32_t patch; ///< format::kNone: all patches of one material of a whole asset
    uint32_t level; ///< or the whole asset's state
};

/// A run of draw commands that share a material and a size of index.
struct DrawBatch {
    uint32_t material;   ///< renderer-wide: the asset's firstMaterial + its own number
    uint32_t indexBytes; ///< 2 or 4
    uint32_t firstDraw;
    uint32_t drawCount;
};

struct DrawListConfig {
    SceneConfig scene;               ///< capacities of the scenes that it draws
    uint32_t materialCapacity = 256; ///< renderer-wide
    /// Whole instances of at most so many triangles are drawn as one range a material, larger ones by patches. A
    /// frame's staging must hold 12 bytes for each of them, and of an asset's coarsest level, however large.
    uint32_t wholeTriangles = 16384;
    uint32_t wholeRangeCapacity = 16384; ///< materials of all states of whole assets that are drawn at once
    uint32_t domainCapacity = 65536;     ///< largest domain count of the assets
};

struct DrawStats {
    uint64_t triangles = 0;
    uint32_t instances = 0;         ///< drawn, whole or in part
    uint32_t changedPatches = 0;    ///< of mixed instances: got another level
    uint32_t reboundPatches = 0;    ///< of mixed instances: got another index range, built or found
    uint32_t deferredInstances = 0; ///< are not drawn at the levels that were selected: staging, cap or arena was full
};

/// The draws of one view: follows a selection as far as the index cache's staging and arena allow.
///
/// Every instance is drawn in one state, so no frame has a crack or a hole, whatever was refused: where a change does
/// not fit a frame, the most urgent of its patches change in this frame and others later; what comes into sight and
/// finds no room for its patches is drawn as a whole at its coarsest level, whose range is held from the asset's first
/// sight on. Only an asset that is new in a frame in which even that is refused waits for the next one.
///
/// All memory is allocated by `create`. One thread at a time.
class DrawList {
public:
    DrawList();
    ~DrawList();
    DrawList(DrawList&&) noexcept;
    DrawList& operator=(DrawList&&) noexcept;

    Status create(const DrawListConfig& config);

    /// Brings the draws up to the selection. Between the cache's beginFrame and endFrame, after the selection's update;
    /// the cache knows the scene's assets by the scene's ids. Always the same scene and cache.
    void update(const Scene& scene, const Selection& selection, IndexCache& cache);
    /// Lets go of all ranges that belong to an asset, or to any: before it is removed from the cache, after its
    /// instances went from the scene.
    void forgetAsset(uint32_t asset, IndexCache& cache);
    void clear(IndexCache& cache);

    // Valid until the next update.
    std::span<const DrawCommand> draws() const;
    std::span<const DrawSource> sources() const;
    std::span<const DrawBatch> batches() const;      ///< by material
    std::span<const uint32_t> drawInstances() const; ///< ids of instances of the scene
    const DrawStats& stats() const;
    /// Why the update deferred instances: the latest refusal, or ok.
    const Status& refusal() const;

    /// How an instance is drawn. `levels`: of one of kind mixed.
    InstanceKind kind(uint32_t instance) const;
    uint32_t wholeState(uint32_t instance) const;
    Levels levels(uint32_t instance) const;
    /// Of one of kind mixed, beside its levels: the fractions at which it is drawn, for groupLambdas of morph.h; empty
    /// where it does not morph. A patch whose level lags behind the selected one stands as near to that as its own
    /// level goes: at fraction 0, or at kMaxFraction.
    std::span<const float> fractions(uint32_t instance) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
