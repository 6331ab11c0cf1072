#include "draw_list.h"

#include <algorithm>
#include <cassert>
#include <utility>

// The draw commands of what a view holds: whole instances by state, so that each state is one instanced draw a
// material, then mixed ones patch by patch. Two passes: one counts the draws of each batch, one puts each in its place.

namespace xgc {

/// Counts the whole instances of each state and gives them their run of drawInstances, then the mixed ones.
void DrawList::Impl::listStates() {
    for (uint32_t i = 0; i < activeStateCount; ++i) wholeStates[activeStates[i]].count = 0;
    activeStateCount = 0;
    for (uint32_t id = 0; id < scene->instanceEnd; ++id) {
        if (instances[id].kind != InstanceKind::whole) continue;
        const uint32_t state = instances[id].asset * kMaxWholeStates + instances[id].wholeState;
        if (wholeStates[state].count++ == 0) activeStates[activeStateCount++] = state;
    }
    drawInstanceCount = 0;
    for (uint32_t i = 0; i < activeStateCount; ++i) {
        WholeState& state = wholeStates[activeStates[i]];
        state.firstInstance = drawInstanceCount;
        drawInstanceCount += std::exchange(state.count, 0);
    }
    for (uint32_t id = 0; id < scene->instanceEnd; ++id) {
        const DrawnInstance& own = instances[id];
        if (own.kind == InstanceKind::mixed) drawInstances[drawInstanceCount++] = id;
        if (own.kind != InstanceKind::whole) continue;
        WholeState& state = heldState(own.asset, own.wholeState);
        drawInstances[state.firstInstance + state.count++] = id;
    }
}

/// add(material, indexBytes, command, source) for each draw, in an order that the instances' ids give.
template <typename Add>
void DrawList::Impl::forDraws(Add add) {
    const auto draw = [&](const IndexRange& range, uint32_t material, uint32_t instanceCount, uint32_t firstInstance,
                          const DrawSource& source) {
        if (range.indexCount == 0) return;
        const AssetDesc& asset = scene->assets[source.asset].desc;
        const int32_t offset = asset.vertexOffset + int32_t(range.vertexOffset);
        add(asset.firstMaterial + material, range.indexBytes,
            DrawCommand{range.indexCount, instanceCount, range.firstIndex, offset, firstInstance}, source);
    };
    uint32_t nextMixed = 0;
    for (uint32_t i = 0; i < activeStateCount; ++i) {
        const WholeState& state = wholeStates[activeStates[i]];
        const uint32_t asset = activeStates[i] / kMaxWholeStates;
        for (uint32_t m = 0; m < wholeHandles.count(state.handle); ++m) {
            draw(cache->at(wholeRanges[state.firstRange + m]), m, state.count, state.firstInstance,
                 {asset, format::kNone, state.finestLevel});
        }
        nextMixed += state.count;
    }
    for (; nextMixed < drawInstanceCount; ++nextMixed) {
        const DrawnInstance& own = instances[drawInstances[nextMixed]];
        const AssetView& asset = view(own.asset);
        for (uint32_t p = 0; p < own.patchCount; ++p) {
            const uint32_t slot = own.firstSlot + p;
            if (slotRanges[slot] == kNoRange) continue;
            draw(cache->at(slotRanges[slot]), asset.patches[p].material, 1, nextMixed,
                 {own.asset, p, slotLevels[slot]});
        }
    }
}

/// Counts the draws of each batch, then puts each draw in its place.
void DrawList::Impl::listDraws() {
    stale = false;
    stats.triangles = 0;
    listStates();
    std::fill_n(batchNext.data(), batchNext.size(), 0u);
    const auto key = [](uint32_t material, uint32_t indexBytes) { return 2 * material + (indexBytes == 4); };
    forDraws([&](uint32_t material, uint32_t indexBytes, const DrawCommand&, const DrawSource&) {
        assert(material < config.materialCapacity && "raise DrawListConfig::materialCapacity");
        ++batchNext[key(material, indexBytes)];
    });
    drawCount = batchCount = 0;
    for (uint32_t k = 0; k < batchNext.size(); ++k) {
        const uint32_t count = std::exchange(batchNext[k], drawCount);
        if (count > 0) batches[batchCount++] = {k / 2, k % 2 ? 4u : 2u, drawCount, count};
        drawCount += count;
    }
    forDraws([&](uint32_t material, uint32_t indexBytes, const DrawCommand& command, const DrawSource& source) {
        const uint32_t at = batchNext[key(material, indexBytes)]++;
        draws[at] = command;
        sources[at] = source;
        stats.triangles += uint64_t(command.indexCount / 3) * command.instanceCount;
    });
}

} // namespace xgc
