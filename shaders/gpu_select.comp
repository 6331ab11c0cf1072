#version 460
#extension GL_GOOGLE_include_directive : require

// A work group an instance: xgc::Selection::update (runtime/src/selection.cpp) word for word, so that the same
// operations in the same order give the same bits: +, - and * alone, `precise`.
#include "gpu.glsl"

layout(local_size_x = 64) in;

const float kMax = 3.402823466e+38, kMin = 1.175494351e-38; // FLT_MAX, FLT_MIN

struct Standing {
    float distanceSquared;
    float radius;
    float scale;
};

struct Strictness {
    float pixels;
    float bandFactor;
};

// What a pose does to the errors of a patch.
struct PosedErrors {
    bool posed; // else the rest is not read
    uvec2 skin, morph;
    uint firstWeight, weightCount;
    GpuPosedPatch by;
};

// LevelTest of level_choice.h.
struct Test {
    uvec2 errors;
    uint firstError;
    uint levelCount;
    float importance;
    float assetRadius;
    Standing at;
    PosedErrors pose;
};

Strictness loose, middle, tight;

// Arithmetic that decides. glslang 12 fails on `precise` values that come from a buffer reference, however far back: all
// of it stands in functions of their parameters alone.

float times(float a, float b) {
    precise const float product = a * b;
    return product;
}

float dotOf(vec3 a, vec3 b) {
    precise const vec3 m = a * b;
    precise const float sum = m.x + m.y + m.z;
    return sum;
}

// dot(a.xyz, b) + rest, the products from left to right.
float along(vec4 a, vec3 b, float rest) {
    precise const float sum = a.x * b.x + a.y * b.y + a.z * b.z + rest;
    return sum;
}

float plus(float a, float b) {
    precise const float sum = a + b;
    return sum;
}

float difference(float a, float b) {
    precise const float d = a - b;
    return d;
}

// scale * (a * b + c * d)
float reachOf(float scale, float a, float b, float c, float d) {
    precise const float reach = scale * (a * b + c * d);
    return reach;
}

// sum + a * b
float plusProduct(float sum, float a, float b) {
    precise const float more = sum + a * b;
    return more;
}

// sum + (a * b + c * d)
float plusProducts(float sum, float a, float b, float c, float d) {
    precise const float more = sum + (a * b + c * d);
    return more;
}

bool reaches(float reach, float awaySquared) {
    const float reachSquared = times(reach, reach);
    return reachSquared <= awaySquared && reachSquared <= kMax && awaySquared >= kMin;
}

vec3 fromEye(GpuInstance instance, vec3 point, vec3 eye) {
    vec3 away;
    for (int i = 0; i < 3; ++i) away[i] = along(instance.toWorld[i], point, difference(instance.toWorld[i].w, eye[i]));
    return away;
}

Standing standingOf(GpuInstance instance, vec4 sphere) {
    const vec3 away = fromEye(instance, sphere.xyz, frame.eye.xyz);
    return Standing(dotOf(away, away), sphere.w, instance.maxScale);
}

Standing standingFor(GpuInstance instance, vec4 sphere) {
    if (frame.byBands == 0 && frame.orthographic != 0) return Standing(1.0, 0.0, instance.maxScale);
    return standingOf(instance, sphere);
}

bool errorFits(float error, float pixels, Standing at) {
    if (error == 0 || pixels > kMax) return true;
    const float projected = times(error, frame.pixelsPerUnit);
    return reaches(reachOf(at.scale, projected, 1.0, pixels, at.radius),
                   times(times(pixels, pixels), at.distanceSquared)) ||
           times(at.scale, projected) <= times(pixels, frame.nearest);
}

bool bandReached(float threshold, float assetRadius, Standing at) {
    if (threshold <= 0) return true;
    return reaches(reachOf(at.scale, threshold, assetRadius, at.radius, 1.0), at.distanceSquared);
}

bool beyond(float radii, Standing at) {
    return reaches(times(radii, times(at.scale, at.radius)), at.distanceSquared);
}

// Levels ------------------------------------------------------------------------------------------------------------

// posedError of skin.cpp. `at`: of the patch's level in the tables, whose own error is `own`.
float posedError(PosedErrors pose, uint at, float own) {
    for (uint t = 0; t < pose.weightCount; ++t) {
        own = plusProduct(own, Floats(frame.poseWeights).at[pose.firstWeight + t],
                          Floats(pose.morph).at[at * pose.weightCount + t]);
    }
    float error = times(pose.by.stretch, own);
    if (pose.by.bend > 0 || pose.by.offset > 0) {
        const float weight = Floats(pose.skin).at[2 * at], moment = Floats(pose.skin).at[2 * at + 1];
        error = plusProducts(error, pose.by.offset, weight, pose.by.bend, moment);
        if (own > 0 || moment > 0) error = plus(error, pose.by.added);
    }
    return error;
}

float errorOf(Test test, uint level) {
    const uint at = test.firstError + level;
    const float own = Floats(test.errors).at[at];
    return test.pose.posed ? posedError(test.pose, at, own) : own;
}

bool fits(Test test, uint level, Strictness s) {
    if (level == 0) return true;
    if (frame.byBands == 0) return errorFits(times(errorOf(test, level), test.importance), s.pixels, test.at);
    return bandReached(times(times(frame.bands[level - 1], test.importance), s.bandFactor), test.assetRadius, test.at);
}

uint coarsestLevel(Test test, Strictness s, uint hint) {
    uint level = min(hint, test.levelCount - 1);
    while (!fits(test, level, s)) --level;
    while (level + 1 < test.levelCount && fits(test, level + 1, s)) ++level;
    return level;
}

uint nextLevel(Test test, uint previous, bool mayCoarsen) {
    if (previous < test.levelCount && fits(test, previous, loose)) {
        const bool coarsens = mayCoarsen && previous + 1 < test.levelCount && fits(test, previous + 1, tight);
        if (!coarsens) return previous;
    }
    return coarsestLevel(test, middle, previous == kNoLevel ? 0 : previous);
}

uint levelsToTry(uint count) {
    return frame.byBands == 0 ? count : min(frame.bandCount + 1, count);
}

uint steered(GpuControl control, uint level, uint levelCount) {
    const int biased = max(int(level) + control.bias, 0);
    return min(min(max(uint(biased), control.finest), control.coarsest), levelCount - 1);
}

// Culling -----------------------------------------------------------------------------------------------------------

const uint kOutside = 0, kAcross = 1, kInside = 2;

uint sideOf(vec4 plane, vec4 sphere) {
    const float value = plus(dotOf(plane.xyz, sphere.xyz), plane.w);
    const float reachSquared = times(times(sphere.w, sphere.w), dotOf(plane.xyz, plane.xyz));
    if (times(value, value) < reachSquared) return kAcross;
    return value < 0 ? kOutside : kInside;
}

uint sideOfAll(vec4 planes[6], vec4 sphere) {
    uint side = kInside;
    for (uint i = 0; i < frame.planeCount; ++i) {
        const uint one = sideOf(planes[i], sphere);
        if (one == kOutside) return one;
        if (one == kAcross) side = one;
    }
    return side;
}

vec4 toMeshSpace(vec4 plane, GpuInstance instance) {
    const vec4 a = instance.toWorld[0], b = instance.toWorld[1], c = instance.toWorld[2];
    vec4 mesh;
    for (int i = 0; i < 4; ++i) mesh[i] = dotOf(plane.xyz, vec3(a[i], b[i], c[i]));
    mesh.w = plus(mesh.w, plane.w);
    return mesh;
}

bool tooSmall(Standing at) {
    if (!(frame.contributionPixels > 0)) return false;
    const float covers = times(times(at.scale, at.radius), frame.pixelsPerUnit);
    const float leastSquared = times(frame.contributionPixels, frame.contributionPixels);
    return times(covers, covers) < times(leastSquared, frame.orthographic != 0 ? 1.0 : at.distanceSquared);
}

// Where the view looks from, in mesh space, or whither.
vec3 meshEye(GpuInstance instance) {
    vec3 from = frame.forward.xyz;
    if (frame.orthographic == 0) {
        for (int i = 0; i < 3; ++i) from[i] = difference(frame.eye[i], instance.toWorld[i].w);
    }
    vec3 to;
    for (int i = 0; i < 3; ++i) to[i] = along(instance.toMesh[i], from, 0.0);
    return to;
}

bool turnedAway(GpuPatch surface, vec3 eye) {
    if (surface.cone.w > 1) return false;
    vec3 v = eye;
    if (frame.orthographic == 0) {
        for (int i = 0; i < 3; ++i) v[i] = difference(surface.sphere[i], eye[i]);
    }
    const float ahead = difference(dotOf(v, surface.cone.xyz), frame.orthographic != 0 ? 0.0 : surface.sphere.w);
    const float sineSquared = plus(times(surface.cone.w, surface.cone.w), 1e-4);
    return ahead > 0 && times(ahead, ahead) >= times(sineSquared, dotOf(v, v));
}

// One instance ------------------------------------------------------------------------------------------------------

bool drawnInPhase(bool seen) {
    return frame.phase == kPhaseAll || seen;
}

void main() {
    loose = Strictness(frame.loosePixels, frame.looseBand);
    middle = Strictness(frame.middlePixels, frame.middleBand);
    tight = Strictness(frame.tightPixels, frame.tightBand);
    const uint id = groupNumber();
    if (id >= frame.instanceEnd) return;
    const GpuInstance instance = Instances(frame.instances).at[id];
    if ((instance.flags & kInstancePresent) == 0) {
        if (gl_LocalInvocationIndex == 0) States(frame.states).at[id] = GpuInstanceState(0, kKindCulled, 0, kNoLevel);
        return;
    }
    const GpuAsset asset = Assets(frame.assets).at[instance.asset];
    GpuInstanceState own = States(frame.states).at[id];
    barrier(); // all have read it before the first writes it
    const bool fresh = own.generation != instance.generation;
    if (fresh) own = GpuInstanceState(instance.generation, kKindCulled, 0, kNoLevel);

    // decideWhole
    const bool was = (own.flags & kStateWhole) != 0, unsteered = instance.firstControl == kNone;
    bool whole = false, inBelt = false;
    const bool posed = isPosed(instance);
    if (frame.byBands == 0 && unsteered && frame.orthographic == 0 && !posed) {
        const Standing at = standingOf(instance, asset.sphere);
        whole = beyond(was ? frame.wholeInner : frame.wholeOuter, at);
        inBelt = !whole && beyond(frame.beltInner, at);
    }
    if (whole && !was) own.wholeState = kNoLevel;
    const uint leftState = !whole && was ? own.wholeState : kNoLevel; // whose levels come before the new ones
    const bool forget = !whole && (was || fresh) && leftState == kNoLevel;

    // cull
    const vec4 bounds = boundsOf(instance, asset);
    vec4 inWorld;
    for (int i = 0; i < 3; ++i) inWorld[i] = along(instance.toWorld[i], bounds.xyz, instance.toWorld[i].w);
    inWorld.w = times(bounds.w, instance.maxScale);
    const uint side = sideOfAll(frame.planes, inWorld);
    own.kind = whole ? kKindWhole : kKindMixed;
    const bool small = tooSmall(standingOf(instance, bounds));
    if ((instance.flags & kInstanceVisible) == 0 || side == kOutside || small) own.kind = kKindCulled;

    // choose
    PosedErrors pose;
    pose.posed = false;
    if (whole) {
        const Test test = Test(asset.wholeErrors, 0, levelsToTry(asset.stateCount), 1.0, asset.sphere.w,
                               standingFor(instance, asset.sphere), pose);
        own.wholeState = nextLevel(test, own.wholeState, true);
    }
    const bool wholeDrawn = own.kind == kKindWhole && drawnInPhase((own.flags & kStateSeen) != 0);
    own.flags = (whole ? kStateWhole : 0) | (inBelt ? kStateBelt : 0) | (wholeDrawn ? kStateDraw : 0) |
                (own.kind == kKindWhole ? own.flags & kStateSeen : 0);
    if (gl_LocalInvocationIndex == 0) States(frame.states).at[id] = own;

    const bool mixed = own.kind == kKindMixed;
    if (!mixed && !forget && leftState == kNoLevel) return;
    vec4 planes[6];
    for (uint i = 0; i < frame.planeCount; ++i) planes[i] = toMeshSpace(frame.planes[i], instance);
    const bool cones = frame.cullBackfaces != 0 && (instance.flags & kInstanceInvertible) != 0 && !posed;
    const vec3 eye = meshEye(instance);
    for (uint p = gl_LocalInvocationIndex; p < asset.patchCount; p += 64) {
        const uint slot = instance.firstSlot + p;
        uint word = WordsOut(frame.slots).at[slot];
        uint wanted = word & 0xff;
        if (leftState != kNoLevel) wanted = byteAt(asset.wholeLevels, leftState * asset.patchCount + p);
        if (forget) wanted = kNoLevel;
        if (!mixed) {
            WordsOut(frame.slots).at[slot] = (word & ~0xffu) | wanted;
            continue;
        }
        const GpuPatch surface = Patches(asset.patches).at[p];
        const vec4 sphere = patchBounds(instance, asset, p);
        GpuControl control = GpuControl(1.0, 0, 0, kNoLevel, 0, 0, 0, 0);
        if (!unsteered) control = Controls(frame.controls).at[instance.firstControl + surface.part];
        bool visible = control.hidden == 0 && !tooSmall(standingOf(instance, sphere));
        if (side == kAcross && sideOfAll(planes, sphere) == kOutside) visible = false;
        uint level = asset.levelCount - 1;
        if (visible) {
            if (posed) {
                pose = PosedErrors(true, asset.skinErrors, asset.morphErrors, instance.firstWeight,
                                   instance.weightCount, PosedPatches(frame.posedPatches).at[slot]);
            }
            const Test test = Test(asset.errors, p * asset.levelCount, levelsToTry(asset.levelCount),
                                   times(surface.importance, control.importance), asset.sphere.w,
                                   standingFor(instance, sphere), pose);
            wanted = nextLevel(test, wanted, !inBelt);
            level = unsteered ? wanted : steered(control, wanted, asset.levelCount);
            if (cones && level <= surface.coneLevel && turnedAway(surface, eye)) {
                visible = false;
                level = min(surface.coneLevel, asset.levelCount - 1);
            }
        }
        const uint seen = visible ? word & kSlotSeen : 0;
        const bool drawn = visible && drawnInPhase(seen != 0);
        WordsOut(frame.slots).at[slot] =
            wanted | level << 8 | (visible ? kSlotVisible : 0) | (drawn ? kSlotDraw : 0) | seen;
    }
}
