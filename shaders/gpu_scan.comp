#version 460
#extension GL_GOOGLE_include_directive : require

// One work group. Step 0: where the items and draws of each run begin. Step 1: where the indices of each item begin.
// What does not fit is left out, and the totals say so.
#include "gpu.glsl"

const uint kLanes = 256, kEach = 4;
layout(local_size_x = 256) in;

shared uvec2 sums[kLanes];
shared uvec2 carry;
shared uint firstMissing; // item
shared uint kindEnds[kDrawKinds]; // draws

uvec2 valueAt(uint i) {
    if (push.step == 1) {
        return i < Totals(frame.totals).at.itemCount ? uvec2(Items(frame.items).at[i].indexCount, 0) : uvec2(0);
    }
    if (i >= frame.runCount) return uvec2(0);
    const GpuRunPlace place = Places(frame.places).at[i];
    return uvec2(place.itemCount, place.drawCount);
}

void put(uint i, uvec2 first, uvec2 count) {
    if (push.step == 1) {
        if (i >= Totals(frame.totals).at.itemCount) return;
        const bool fits = first.x + count.x <= frame.indexCapacity;
        if (!fits) atomicMin(firstMissing, i);
        Items(frame.items).at[i].firstIndex = first.x;
        if (!fits) Items(frame.items).at[i].indexCount = 0;
        return;
    }
    for (uint kind = 0; kind < kDrawKinds - 1; ++kind) {
        if (i == frame.kindRuns[kind]) kindEnds[kind] = first.y;
    }
    if (i >= frame.runCount) return;
    const bool fits = first.x + count.x <= frame.itemCapacity && first.y + count.y <= frame.drawCapacity;
    if (!fits) atomicMin(firstMissing, i);
    Places(frame.places).at[i] = GpuRunPlace(fits ? count.x : 0, fits ? count.y : 0, first.x, first.y);
}

void main() {
    const uint lane = gl_LocalInvocationIndex;
    const uint end = push.step == 1 ? Totals(frame.totals).at.itemCount : frame.runCount;
    if (lane == 0) {
        carry = uvec2(0);
        firstMissing = kNone;
        for (uint kind = 0; kind < kDrawKinds; ++kind) kindEnds[kind] = kNone;
    }
    barrier();
    for (uint base = 0; base < end; base += kLanes * kEach) {
        uvec2 values[kEach], sum = uvec2(0);
        for (uint k = 0; k < kEach; ++k) sum += values[k] = valueAt(base + kEach * lane + k);
        sums[lane] = sum;
        for (uint step = 1; step < kLanes; step *= 2) {
            barrier();
            const uvec2 other = lane >= step ? sums[lane - step] : uvec2(0);
            barrier();
            sums[lane] += other;
        }
        barrier();
        uvec2 first = carry + sums[lane] - sum;
        for (uint k = 0; k < kEach; ++k) {
            put(base + kEach * lane + k, first, values[k]);
            first += values[k];
        }
        barrier();
        if (lane == kLanes - 1) carry += sums[lane];
        barrier();
    }
    if (lane > 0) return;
    if (push.step == 1) {
        Totals(frame.totals).at.indexCount =
            firstMissing == kNone ? carry.x : Items(frame.items).at[firstMissing].firstIndex;
        Totals(frame.totals).at.missingIndices = firstMissing == kNone ? 0 : 1;
        return;
    }
    // Runs behind the first that does not fit find no room either, or are empty: what is listed ends there.
    const uvec2 listed = firstMissing == kNone ? carry
                                               : uvec2(Places(frame.places).at[firstMissing].firstItem,
                                                       Places(frame.places).at[firstMissing].firstDraw);
    Totals(frame.totals).at.itemCount = listed.x;
    Totals(frame.totals).at.drawCount = listed.y;
    uint done = 0;
    for (uint kind = 0; kind < kDrawKinds; ++kind) {
        const uint end = min(kindEnds[kind], listed.y);
        Totals(frame.totals).at.kindDraws[kind] = end - done;
        done = end;
    }
    Totals(frame.totals).at.missingItems = firstMissing == kNone ? 0 : 1;
    Totals(frame.totals).at.groups[0] = min(listed.x, kGroupsPerRow);
    Totals(frame.totals).at.groups[1] = (listed.x + kGroupsPerRow - 1) / kGroupsPerRow;
    Totals(frame.totals).at.groups[2] = 1;
    Totals(frame.totals).at.triangles = 0;
}
