#version 460
#extension GL_GOOGLE_include_directive : require

// A work group an item, a patch in a state: xgc::buildIndices (runtime/src/indices.cpp). Step 0 counts its triangles,
// step 1 writes their indices, in the order of its list, and the draw.
#include "gpu.glsl"

const uint kLanes = 64;
layout(local_size_x = 64) in;

shared uint aliveOf[kMaxPatchDomains]; // rows of each domain of the patch
shared uint leastLevel;                // of the patch and its domains
shared uint sums[kLanes];

GpuAsset asset;
GpuPatch surface;
uint firstInterior, aliveInterior;

// Rows of a range that are alive at a level: collapse levels fall within it.
uint aliveCount(uint first, uint count, uint level) {
    uint low = 0, high = count;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (byteAt(asset.collapseLevels, first + middle) > level) low = middle + 1;
        else high = middle;
    }
    return low;
}

// Brings in the domains of the patch, a lane each, and the least of its levels.
void resolveDomains(uint subject, uint own) {
    if (gl_LocalInvocationIndex == 0) leastLevel = own;
    barrier();
    for (uint d = gl_LocalInvocationIndex; d < surface.domainCount; d += kLanes) {
        const GpuDomain domain =
            Domains(asset.domains).at[Words(asset.patchDomains).at[surface.firstDomain + d]];
        uint level = kNoLevel;
        for (uint i = 0; i < domain.patchCount; ++i) {
            level = min(level, levelIn(asset, subject, Words(asset.domainPatches).at[domain.firstPatch + i]));
        }
        aliveOf[d] = aliveCount(domain.firstRow, domain.rowCount, level);
        atomicMin(leastLevel, level);
    }
    barrier();
}

uint parentOf(uint slot) {
    if (surface.wide != 0) return Words(asset.parentsWide).at[surface.firstParent + slot];
    return halfAt(asset.parentsNarrow, surface.firstParent + slot);
}

uint cornerAt(uint i) {
    if (surface.wide != 0) return Words(asset.cornersWide).at[surface.firstCorner + i];
    return halfAt(asset.cornersNarrow, surface.firstCorner + i);
}

// Number, among the patch's domains, of the one that a slot before the interior belongs to.
uint domainAt(uint slot) {
    uint low = 0, high = surface.domainCount;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (Words(asset.patchSlots).at[surface.firstDomain + middle] <= slot) low = middle + 1;
        else high = middle;
    }
    return low - 1;
}

// The row that a slot is drawn as. Parents have lower slots, so this ends.
uint rowOf(uint slot) {
    for (;;) {
        if (slot >= firstInterior) {
            if (slot - firstInterior < aliveInterior) return surface.firstRow + slot - firstInterior;
        } else {
            const uint d = domainAt(slot);
            const uint at = slot - Words(asset.patchSlots).at[surface.firstDomain + d];
            if (at < aliveOf[d]) {
                return Domains(asset.domains).at[Words(asset.patchDomains).at[surface.firstDomain + d]].firstRow + at;
            }
        }
        slot = parentOf(slot);
    }
}

// The coarsest list that serves groups at `least` and coarser: its first face and their number.
uvec2 listFor(uint patchId, uint least) {
    const uint first = 2 * patchId * asset.listCount;
    uvec2 found = uvec2(0, Words(asset.lists).at[first + 1]);
    for (uint i = 1; i < asset.listCount && Words(asset.lists).at[first + 2 * i] <= least; ++i) {
        found = uvec2(found.x + found.y, Words(asset.lists).at[first + 2 * i + 1]);
    }
    return found;
}

uvec3 rowsOf(uint face) {
    return uvec3(rowOf(cornerAt(3 * face)), rowOf(cornerAt(3 * face + 1)), rowOf(cornerAt(3 * face + 2)));
}

bool isSolid(uvec3 rows) {
    return rows.x != rows.y && rows.y != rows.z && rows.z != rows.x;
}

void count(uint number, uvec2 list) {
    if (gl_LocalInvocationIndex == 0) sums[0] = 0;
    barrier();
    uint solid = 0;
    for (uint f = gl_LocalInvocationIndex; f < list.y; f += kLanes) {
        if (isSolid(rowsOf(list.x + f))) ++solid;
    }
    atomicAdd(sums[0], solid);
    barrier();
    if (gl_LocalInvocationIndex == 0) Items(frame.items).at[number].indexCount = 3 * sums[0];
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

void write(GpuItem item, uvec2 list) {
    uint done = 0;
    for (uint first = 0; first < list.y; first += kLanes) {
        const uint f = first + gl_LocalInvocationIndex;
        uvec3 rows = uvec3(0);
        if (f < list.y) rows = rowsOf(list.x + f);
        const bool solid = isSolid(rows);
        const uint at = item.firstIndex + 3 * (done + scan(solid ? 1 : 0) - 1);
        if (solid) {
            for (uint c = 0; c < 3; ++c) WordsOut(frame.indices).at[at + c] = rows[c];
        }
        done += sums[kLanes - 1];
    }
}

// Draws of each kind have a place of their own: the host knows where it begins.
uint placeOf(uint number) {
    uint kind = 0;
    for (; kind < kDrawKinds - 1; ++kind) {
        const uint draws = Totals(frame.totals).at.kindDraws[kind];
        if (number < draws) break;
        number -= draws;
    }
    return kind * frame.drawCapacity + number;
}

void writeDraw(uint number, uint firstIndex, uint indexCount, uint instanceCount, DrawRecord record) {
    const uint at = placeOf(number);
    const uint words[5] = uint[](indexCount, instanceCount, firstIndex, 0, record.firstInstance);
    for (uint i = 0; i < 5; ++i) WordsOut(frame.commands).at[5 * at + i] = words[i];
    Draws(frame.draws).at[at] = record;
    atomicAdd(Totals(frame.totals).at.triangles, indexCount / 3 * instanceCount);
}

// A mixed instance has a draw an item; a whole state one for all of the run, whose indices lie together.
void listDraw(uint number, GpuItem item, GpuRun run) {
    const GpuRunPlace place = Places(frame.places).at[item.run];
    const uint inRun = number - place.firstItem;
    const bool whole = isState(run.subject);
    if (whole && inRun > 0) return;
    const uint level = whole ? Words(asset.wholeFinest).at[run.subject % kWholeStates]
                             : levelIn(asset, run.subject, item.patchId);
    DrawRecord record;
    record.firstInstance = whole ? Words(frame.wholeFirsts).at[run.subject]
                                 : Words(frame.ranks).at[run.subject - frame.stateCapacity];
    record.material = surface.material;
    record.partColor = whole ? kPartColorCount : surface.partColor;
    record.levelFraction = float(level) / float(max(asset.levelCount, 2) - 1);
    record.vertexOffset = 0;
    record.indexBytes = 4;
    record.error = Floats(whole ? asset.wholeErrors : asset.errors)
                       .at[whole ? run.subject % kWholeStates : item.patchId * asset.levelCount + level];
    record.part = whole ? kNothing : surface.part;
    if (!whole) {
        writeDraw(place.firstDraw + inRun, item.firstIndex, item.indexCount, 1, record);
        return;
    }
    const GpuItem last = Items(frame.items).at[place.firstItem + place.itemCount - 1];
    const uint end = min(last.firstIndex + last.indexCount, Totals(frame.totals).at.indexCount);
    const uint indexCount = end > item.firstIndex ? end - item.firstIndex : 0;
    writeDraw(place.firstDraw, item.firstIndex, indexCount, Words(frame.wholeCounts).at[run.subject], record);
}

void main() {
    const uint number = groupNumber();
    if (number >= Totals(frame.totals).at.itemCount) return;
    const GpuItem item = Items(frame.items).at[number];
    const GpuRun run = Runs(frame.runs).at[item.run];
    asset = Assets(frame.assets).at[run.asset];
    surface = Patches(asset.patches).at[item.patchId];
    firstInterior = surface.slotCount - surface.rowCount;
    const uint own = levelIn(asset, run.subject, item.patchId);
    resolveDomains(run.subject, own);
    aliveInterior = aliveCount(surface.firstRow, surface.rowCount, own);
    const uvec2 list = listFor(item.patchId, leastLevel);
    if (push.step == 0) {
        count(number, list);
        return;
    }
    if (item.indexCount > 0) write(item, list);
    if (gl_LocalInvocationIndex == 0) listDraw(number, item, run);
}
