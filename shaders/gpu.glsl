// What the stages of the compute path share: records by device address, and bytes and halves of words.
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "gpu_shared.h"
#include "shared.h"

layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Frames { GpuFrame at; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Assets { GpuAsset at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Patches { GpuPatch at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Domains { GpuDomain at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Instances { GpuInstance at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer PosedPatches { GpuPosedPatch at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Controls { GpuControl at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer Runs { GpuRun at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer States { GpuInstanceState at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer Places { GpuRunPlace at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer Items { GpuItem at[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) buffer Totals { GpuTotals at; };
layout(buffer_reference, std430, buffer_reference_align = 16) writeonly buffer Draws { DrawRecord at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Words { uint at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) coherent buffer WordsOut { uint at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Floats { float at[]; };

layout(push_constant) uniform Push { GpuPush push; };

// By reference: it is too large for a copy.
#define frame Frames(push.frame).at

uint byteAt(uvec2 address, uint i) {
    return (Words(address).at[i >> 2] >> (8 * (i & 3))) & 0xff;
}

uint halfAt(uvec2 address, uint i) {
    return (Words(address).at[i >> 1] >> (16 * (i & 1))) & 0xffff;
}

// Number of this work group in a dispatch that may be several rows high.
uint groupNumber() {
    return gl_WorkGroupID.y * kGroupsPerRow + gl_WorkGroupID.x;
}

bool isPosed(GpuInstance instance) {
    return (instance.flags & kInstancePosed) != 0;
}

// In mesh space, posed where the instance is.
vec4 boundsOf(GpuInstance instance, GpuAsset asset) {
    return isPosed(instance) ? instance.posedSphere : asset.sphere;
}

vec4 patchBounds(GpuInstance instance, GpuAsset asset, uint patchId) {
    return isPosed(instance) ? PosedPatches(frame.posedPatches).at[instance.firstSlot + patchId].sphere
                             : Patches(asset.patches).at[patchId].sphere;
}

bool isState(uint subject) {
    return subject < frame.stateCapacity;
}

// Level of a patch of a whole state or an instance.
uint levelIn(GpuAsset asset, uint subject, uint patchId) {
    if (isState(subject)) {
        return byteAt(asset.wholeLevels, subject % kWholeStates * asset.patchCount + patchId);
    }
    const uint firstSlot = Instances(frame.instances).at[subject - frame.stateCapacity].firstSlot;
    return (Words(frame.slots).at[firstSlot + patchId] >> 8) & 0xff;
}

// A level of the depth pyramid in frame.depth: level 0 is the image, each further one half its size, rounded up.
struct DepthLevel {
    uint first;
    uvec2 size;
};

DepthLevel depthLevel(uint level) {
    DepthLevel at = DepthLevel(0, uvec2(frame.depthSize[0], frame.depthSize[1]));
    for (uint i = 0; i < level; ++i) at = DepthLevel(at.first + at.size.x * at.size.y, (at.size + 1) / 2);
    return at;
}
