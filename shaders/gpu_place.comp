#version 460
#extension GL_GOOGLE_include_directive : require

// One work group: a place in `ids` for each instance that is drawn, those of each whole state one behind the other,
// then the mixed ones, all by rising id: a counting sort that keeps order.
#include "gpu.glsl"

const uint kLanes = 256;
layout(local_size_x = 256) in;

shared uint keys[kLanes];
shared uint sums[kLanes];
shared uint carry;

// State that the instance is drawn in, the one behind all states where it is mixed, kNone where it is not drawn.
uint keyOf(uint id) {
    if (id >= frame.instanceEnd) return kNone;
    const GpuInstanceState own = States(frame.states).at[id];
    if (own.kind == kKindMixed) return frame.stateCapacity;
    if (own.kind != kKindWhole || (own.flags & kStateDraw) == 0) return kNone;
    return Instances(frame.instances).at[id].asset * kWholeStates + own.wholeState;
}

// Rank among the instances of its key, for a run of ids; counts go up.
void rank(uint id) {
    const uint lane = gl_LocalInvocationIndex, key = keyOf(id);
    keys[lane] = key;
    barrier();
    uint before = 0, all = 0;
    for (uint i = 0; i < kLanes; ++i) {
        if (keys[i] != key) continue;
        ++all;
        if (i < lane) ++before;
    }
    uint counted = 0;
    if (key != kNone) {
        counted = WordsOut(frame.wholeCounts).at[key];
        WordsOut(frame.ranks).at[id] = counted + before;
    }
    memoryBarrierBuffer();
    barrier();
    if (key != kNone && before == 0) WordsOut(frame.wholeCounts).at[key] = counted + all;
    memoryBarrierBuffer();
    barrier();
}

// Where the ids of a run of states begin.
void placeStates(uint state, uint end) {
    const uint lane = gl_LocalInvocationIndex;
    const uint count = state < end ? WordsOut(frame.wholeCounts).at[state] : 0;
    sums[lane] = count;
    for (uint step = 1; step < kLanes; step *= 2) {
        barrier();
        const uint other = lane >= step ? sums[lane - step] : 0;
        barrier();
        sums[lane] += other;
    }
    barrier();
    if (state < end) WordsOut(frame.wholeFirsts).at[state] = carry + sums[lane] - count;
    barrier();
    if (lane == kLanes - 1) carry += sums[lane];
    barrier();
}

void main() {
    const uint lane = gl_LocalInvocationIndex, mixed = frame.stateCapacity, end = frame.assetEnd * kWholeStates;
    for (uint state = lane; state < end; state += kLanes) WordsOut(frame.wholeCounts).at[state] = 0;
    if (lane == 0) {
        WordsOut(frame.wholeCounts).at[mixed] = 0;
        carry = 0;
    }
    memoryBarrierBuffer();
    barrier();
    for (uint first = 0; first < frame.instanceEnd; first += kLanes) rank(first + lane);
    for (uint first = 0; first < end; first += kLanes) placeStates(first + lane, end);
    if (lane == 0) WordsOut(frame.wholeFirsts).at[mixed] = carry;
    memoryBarrierBuffer();
    barrier();
    for (uint id = lane; id < frame.instanceEnd; id += kLanes) {
        const uint key = keyOf(id);
        if (key == kNone) continue;
        const uint place = WordsOut(frame.wholeFirsts).at[key] + WordsOut(frame.ranks).at[id];
        WordsOut(frame.ranks).at[id] = place;
        WordsOut(frame.ids).at[place] = id;
    }
}
