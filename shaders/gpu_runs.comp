#version 460
#extension GL_GOOGLE_include_directive : require

// A work group a run: step 0 counts the patches of it that are drawn, step 1 lists them where the scan has put them.
#include "gpu.glsl"

const uint kLanes = 64;
layout(local_size_x = 64) in;

shared uint sums[kLanes];

bool isDrawn(GpuRun run, GpuAsset asset, uint at) {
    if (isState(run.subject)) return Words(frame.wholeCounts).at[run.subject] > 0;
    const uint id = run.subject - frame.stateCapacity;
    if (States(frame.states).at[id].kind != kKindMixed) return false;
    const uint patchId = Words(asset.order).at[run.firstOrder + at];
    return (Words(frame.slots).at[Instances(frame.instances).at[id].firstSlot + patchId] & kSlotDraw) != 0;
}

// Sum over the lanes up to this one.
uint scan(uint value) {
    const uint lane = gl_LocalInvocationIndex;
    barrier(); // the last call's sums were read
    sums[lane] = value;
    for (uint step = 1; step < kLanes; step *= 2) {
        barrier();
        const uint other = lane >= step ? sums[lane - step] : 0;
        barrier();
        sums[lane] += other;
    }
    barrier();
    return sums[lane];
}

void main() {
    const uint number = groupNumber(), lane = gl_LocalInvocationIndex;
    if (number >= frame.runCount) return;
    const GpuRun run = Runs(frame.runs).at[number];
    const GpuAsset asset = Assets(frame.assets).at[run.asset];
    const GpuRunPlace place = Places(frame.places).at[number];
    if (push.step == 1 && place.itemCount == 0) return;
    uint done = 0;
    for (uint first = 0; first < run.patchCount; first += kLanes) {
        const uint at = first + lane;
        const bool drawn = at < run.patchCount && isDrawn(run, asset, at);
        const uint upTo = scan(drawn ? 1 : 0);
        if (push.step == 1 && drawn) {
            const uint patchId = Words(asset.order).at[run.firstOrder + at];
            Items(frame.items).at[place.firstItem + done + upTo - 1] = GpuItem(number, patchId, 0, 0);
        }
        done += sums[kLanes - 1];
    }
    if (push.step == 1 || lane > 0) return;
    // A whole state is one draw.
    const uint draws = isState(run.subject) ? min(done, 1) : done;
    Places(frame.places).at[number] = GpuRunPlace(done, draws, 0, 0);
}
