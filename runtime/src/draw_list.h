#pragma once

#include "scene.h"

#include <xgc/draw_list.h>

namespace xgc {

inline constexpr uint32_t kNoRange = IndexCache::kNoRange;

/// A state of a whole asset, as long as instances are drawn in it.
struct WholeState {
    uint32_t holders = 0;            ///< instances, and one for the coarsest state of an asset in sight
    uint32_t handle = format::kNone; ///< of its entries in wholeRanges
    uint32_t firstRange = 0;
    uint32_t finestLevel = format::kNever;
    // While draws are listed.
    uint32_t count = 0;
    uint32_t firstInstance = 0;
};

struct DrawnInstance {
    uint32_t generation = 0;
    InstanceKind kind = InstanceKind::culled; ///< culled: holds nothing
    bool late = false;                        ///< is not drawn as was selected
    bool morphs = false;                      ///< has fractions
    uint8_t wholeState = 0;
    uint32_t asset = 0;
    uint32_t firstSlot = 0;
    uint32_t patchCount = 0;
};

/// A patch that gets another range.
struct Rebind {
    uint32_t patch;
    uint32_t range;
};

struct DrawList::Impl : Allocated<DrawList::Impl> {
    DrawListConfig config;

    FixedArray<DrawnInstance> instances;
    FixedArray<uint32_t> slotRanges; ///< kNoRange: not shown
    FixedArray<uint8_t> slotLevels;
    FixedArray<float> slotFractions; ///< of instances that morph

    FixedArray<WholeState> wholeStates; ///< asset * kMaxWholeStates + state
    FixedArray<uint8_t> assetsInSight;  ///< hold their coarsest state
    RangeAllocator wholeHandles;
    FixedArray<uint32_t> wholeRanges;

    // Scratch of a plan.
    FixedArray<uint8_t> planLevels;
    FixedArray<uint8_t> wholeLevels; ///< of a whole instance that is drawn by patches
    FixedArray<uint8_t> heldLevels;  ///< of a state that is being held
    FixedArray<uint8_t> allShown;    ///< ones
    FixedArray<uint32_t> changes;    ///< patches whose level is to change, the most urgent first
    uint32_t changeCount = 0;
    FixedArray<Rebind> rebinds;
    uint32_t rebindCount = 0;
    FixedArray<uint64_t> patchMarks, domainMarks; ///< equal `plan` where seen in it
    uint64_t plan = 0;

    // The draws.
    bool stale = true;
    FixedArray<DrawCommand> draws;
    FixedArray<DrawSource> sources;
    uint32_t drawCount = 0;
    FixedArray<DrawBatch> batches;
    uint32_t batchCount = 0;
    FixedArray<uint32_t> batchNext; ///< 2 * material + (four bytes): draws, then the next one's place
    FixedArray<uint32_t> drawInstances;
    uint32_t drawInstanceCount = 0;
    FixedArray<uint32_t> activeStates;
    uint32_t activeStateCount = 0;
    DrawStats stats;
    Status refusal;

    // Of the update under way.
    const Scene::Impl* scene = nullptr;
    const Selection* selection = nullptr;
    IndexCache* cache = nullptr;

    bool allocate();
    const AssetView& view(uint32_t asset) const { return *scene->assets[asset].desc.asset; }
    WholeState& heldState(uint32_t asset, uint32_t state) {
        return wholeStates[size_t(asset) * kMaxWholeStates + state];
    }

    uint32_t coarsestState(uint32_t asset) const { return scene->assets[asset].wholeStateCount - 1; }
    bool holdWhole(uint32_t asset, uint32_t state);
    void releaseWhole(uint32_t asset, uint32_t state, IndexCache& from);
    void release(DrawnInstance& own, IndexCache& from);
    void dropGone();

    bool holds(uint32_t asset);
    void follow(uint32_t id);
    bool becomeWhole(DrawnInstance& own, uint32_t state);
    void becomeCoarsest(DrawnInstance& own);
    bool followWhole(DrawnInstance& own, uint32_t state);
    bool followMixed(DrawnInstance& own, Levels target, std::span<const uint8_t> shown);
    bool stands(const DrawnInstance& own, Levels target, std::span<const uint8_t> shown) const;
    void listChanges(const DrawnInstance& own, Levels target);
    bool goTo(DrawnInstance& own, Levels target, std::span<const uint8_t> shown, uint32_t count);
    void mark(uint32_t patch, std::span<const uint8_t> shown);
    void listRebinds(const DrawnInstance& own, Levels after, std::span<const uint8_t> shown);
    bool bind(DrawnInstance& own, Levels after, std::span<const uint8_t> shown);
    void buildAhead(const DrawnInstance& own, Levels after, std::span<const uint8_t> shown);
    void followFractions(DrawnInstance& own, uint32_t id);
    void keepBudget();

    // The draws of what is held (draw_commands.cpp).
    void listStates();
    void listDraws();
    template <typename Add>
    void forDraws(Add add);
};

} // namespace xgc
