#version 460
#extension GL_GOOGLE_include_directive : require

// A work group an instance, between the two phases of a frame with occlusion: what the depth of the first phase does not
// hide is seen; of that, what the first phase did not draw is drawn by the second.
#include "gpu.glsl"

layout(local_size_x = 64) in;

// True where all that lies in the sphere (of the world) is behind what was drawn: its box on screen is, at its nearest
// depth. A pixel and a part in a thousand more, against rounding.
bool isHidden(vec3 center, float radius) {
    const float reach = 1.001 * radius;
    vec2 low = vec2(1e30), high = vec2(-1e30);
    float nearest = 0.0;
    for (uint corner = 0; corner < 8; ++corner) {
        const vec3 side = vec3(corner & 1, (corner >> 1) & 1, corner >> 2) * 2.0 - 1.0;
        const vec4 clip = frame.worldToClip * vec4(center + reach * side, 1);
        if (clip.w <= 1e-6 || clip.z >= clip.w) return false; // at the eye or before the near plane
        const vec2 pixel = (clip.xy / clip.w * 0.5 + 0.5) * vec2(frame.depthSize[0], frame.depthSize[1]);
        low = min(low, pixel);
        high = max(high, pixel);
        nearest = max(nearest, clip.z / clip.w);
    }
    const ivec2 last = ivec2(frame.depthSize[0], frame.depthSize[1]) - 1;
    if (any(greaterThan(low, vec2(last + 1))) || any(lessThan(high, vec2(0)))) return false;
    const uvec2 from = uvec2(clamp(ivec2(floor(low)) - 1, ivec2(0), last));
    const uvec2 to = uvec2(clamp(ivec2(floor(high)) + 1, ivec2(0), last));
    // The level at which two by two texels cover it.
    uint level = 0;
    while (any(greaterThan((to >> level) - (from >> level), uvec2(1)))) ++level;
    const DepthLevel texels = depthLevel(level);
    float farthest = 1.0;
    for (uint y = from.y >> level; y <= to.y >> level; ++y) {
        for (uint x = from.x >> level; x <= to.x >> level; ++x) {
            farthest = min(farthest, Floats(frame.depth).at[texels.first + y * texels.size.x + x]);
        }
    }
    return nearest < farthest;
}

bool isHidden(GpuInstance instance, vec4 sphere) {
    const vec4 point = vec4(sphere.xyz, 1);
    return isHidden(vec3(dot(instance.toWorld[0], point), dot(instance.toWorld[1], point),
                         dot(instance.toWorld[2], point)),
                    sphere.w * instance.maxScale);
}

void main() {
    const uint id = groupNumber();
    if (id >= frame.instanceEnd) return;
    const GpuInstance instance = Instances(frame.instances).at[id];
    if ((instance.flags & kInstancePresent) == 0) return;
    const GpuAsset asset = Assets(frame.assets).at[instance.asset];
    const GpuInstanceState own = States(frame.states).at[id];
    if (own.kind == kKindCulled) return;
    if (own.kind == kKindWhole) {
        if (gl_LocalInvocationIndex > 0) return;
        const bool seen = !isHidden(instance, boundsOf(instance, asset)), draws = seen && (own.flags & kStateSeen) == 0;
        States(frame.states).at[id].flags = (own.flags & ~(kStateSeen | kStateDraw)) | (seen ? kStateSeen : 0) |
                                            (draws ? kStateDraw : 0);
        return;
    }
    for (uint p = gl_LocalInvocationIndex; p < asset.patchCount; p += 64) {
        const uint slot = instance.firstSlot + p, word = WordsOut(frame.slots).at[slot];
        if ((word & kSlotVisible) == 0) continue;
        const bool seen = !isHidden(instance, patchBounds(instance, asset, p));
        const bool draws = seen && (word & kSlotSeen) == 0;
        WordsOut(frame.slots).at[slot] =
            (word & ~(kSlotSeen | kSlotDraw)) | (seen ? kSlotSeen : 0) | (draws ? kSlotDraw : 0);
    }
}
