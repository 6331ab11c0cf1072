#pragma once

#include <xgc/indices.h>

#include <memory>

namespace xgc {

/// Bytes to copy from the frame's staging memory into the index arena: multiples of 4, as all three are.
struct CopyRange {
    uint32_t staging;
    uint32_t arena;
    uint32_t bytes;
};

/// Where the indices of a patch in a state lie in the arena, ready for a draw command.
struct IndexRange {
    uint32_t firstIndex;   ///< in indices of its own size
    uint32_t indexCount;   ///< 0: nothing to draw
    uint32_t indexBytes;   ///< 2, where its rows lie within 65,535 of each other, or 4; none is 0xffff
    uint32_t vertexOffset; ///< asset row that index 0 stands for
};

struct IndexCacheConfig {
    uint32_t arenaBytes = 64u << 20;
    uint32_t rangeCapacity = 65536; ///< states of patches that are kept at once
    uint32_t keyBytes = 4u << 20;   ///< for the names of those states: 9 bytes each (13 of streamed assets) and one for
                                    ///< each domain of the patch
    uint32_t assetCapacity = 64;
    uint32_t slotCapacity = 65536;           ///< largest scratchCapacity of the assets
    uint32_t faceCapacity = 131072;          ///< largest AssetRecord::maxPatchFaces of the assets
    uint32_t patchCapacity = 65536;          ///< largest number of patches of an asset
    uint32_t domainsPerPatchCapacity = 4096; ///< largest number of domains of a patch
    uint32_t copyCapacity = 16384;           ///< copies a frame
    uint32_t framesInFlight = 2;             ///< a range that nobody holds is reused so many frames later; at least 1
    bool narrowIndices = true;               ///< false: all indices take four bytes
};

struct IndexCacheStats {
    // Since beginFrame.
    uint32_t hits = 0;
    uint32_t misses = 0;    ///< built, and copied where there is something to draw
    uint32_t evictions = 0; ///< ranges that others took the place of
    uint32_t refusals = 0;  ///< staging, copies or a capacity was full
    uint32_t uploadBytes = 0;
    // Now.
    uint32_t ranges = 0; ///< held or not
    uint32_t heldRanges = 0;
    uint32_t usedBytes = 0;        ///< of the arena, held or not
    uint32_t largestFreeBytes = 0; ///< of one run of the arena that is free
};

/// Index lists by state: the indices of a patch at a level beside neighbours at theirs are built once, and shared by
/// all instances and views that ask for the same. Knows no graphics API: the arena is only offsets.
///
/// Two states are the same where the vertices that are alive in the patch and in its domains are the same: the level of
/// the patch and those of its domains, each as the lowest level that looks alike. Keys are compared in full. The
/// triangles of a range are those of buildIndices, if perhaps in another order.
///
/// A frame: wait until the frame framesInFlight before this one has left the GPU; `beginFrame`; `acquire` and
/// `release`; `endFrame`; then copy `copies()` before any draw. Ranges that nobody holds stay until their memory is
/// needed, the least recently used first, and never while a frame in flight may read them: one that was held at any
/// time in a frame counts as read by it. So copies need no wait, only a barrier between them and the draws.
///
/// Sizes: give the arena twice the bytes that are held and that framesInFlight frames let go of, and eight times the
/// longest range, since ranges do not move (tested, not proved). Staging holds what a frame adds.
///
/// All memory is allocated by `create`. One thread at a time. An id, range, patch, material or level of nothing is a
/// programming error (asserted).
class IndexCache {
public:
    static constexpr uint32_t kNoRange = format::kNone;

    IndexCache();
    ~IndexCache();
    IndexCache(IndexCache&&) noexcept;
    IndexCache& operator=(IndexCache&&) noexcept;

    /// Allocates for the config. Replaces what was there; on failure it stays.
    Status create(const IndexCacheConfig& config);

    /// Names an asset by a number below assetCapacity that is free: a Scene's. `asset` outlives it here. On failure
    /// nothing changes, and the status' element is the value that would have sufficed.
    Status addAsset(uint32_t id, const AssetView& asset);
    /// All its ranges must be released. Their memory is reused framesInFlight frames later, the id at once.
    void removeAsset(uint32_t id);
    /// Ranges of an asset that are held.
    uint32_t heldRanges(uint32_t asset) const;

    /// Starts a frame. New indices are written to `staging` (for instance mapped memory, aligned to 4; never read),
    /// which must stay valid until the renderer has copied from it. Its size is the frame's upload cap.
    void beginFrame(std::span<std::byte> staging);
    void endFrame();
    bool inFrame() const;

    /// Holds the range of a patch in a state, built where the cache has none; in a frame. Each successful acquire is
    /// undone by one release. A patch that draws nothing has a range of no indices.
    ///
    /// outOfCapacity where something is full: nothing is held then, `range` is untouched, and all that is held stays
    /// (for a full arena, ranges that nobody holds may be gone). The status' element is the bytes that staging or arena
    /// must have for it at most, or the value of the setting that the message names.
    Status acquire(uint32_t asset, uint32_t patch, Levels levels, uint32_t& range);
    /// Bytes of staging that `acquire` would take at most: none where the cache has the range.
    uint64_t bytesNeeded(uint32_t asset, uint32_t patch, Levels levels) const;
    uint64_t freeStagingBytes() const;
    /// Holds the triangles of all patches of a material in a state of the whole asset, as one range. `number` names the
    /// state: the same levels in all calls with it.
    Status acquireWhole(uint32_t asset, uint32_t material, uint32_t number, Levels levels, uint32_t& range);
    /// Holds it once more. In or between frames, as release.
    void hold(uint32_t range);
    void release(uint32_t range);

    /// True where the number is that of a range that somebody holds.
    bool isHeld(uint32_t range) const;
    /// Of a range that is held.
    IndexRange at(uint32_t range) const;

    /// Valid from endFrame to the next beginFrame.
    std::span<const CopyRange> copies() const;
    /// Looks through free runs of the arena: for once a frame, not for every range.
    IndexCacheStats stats() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
