// Structs of the compute path (runtime/vulkan/src/gpu_path.h) that C++ and GLSL both see.
#ifndef XGC_SHADERS_GPU_SHARED_H
#define XGC_SHADERS_GPU_SHARED_H

#include "types.h"

#ifdef __cplusplus
#include <cstddef>
#endif

#ifdef __cplusplus
namespace xgc::shader {
#endif

XGC_CONST uint kNone = 0xffffffffu;     ///< xgc::format::kNone
XGC_CONST uint kNoLevel = 255;          ///< xgc::format::kNever
XGC_CONST uint kWholeStates = 124;      ///< of an asset: xgc::kMaxWholeStates
XGC_CONST uint kMaxPatchDomains = 1024; ///< of a patch that compute shaders can draw
XGC_CONST uint kGroupsPerRow = 32768;   ///< of a dispatch: large ones are this wide and several high

/// Draws are of a kind each, by the pipelines that draw them: kDrawPosable for assets that can be posed, kDrawMasked
/// for alpha-tested materials, both or none.
XGC_CONST uint kDrawPosable = 1;
XGC_CONST uint kDrawMasked = 2;
XGC_CONST uint kDrawKinds = 4;

/// A patch of an asset.
struct GpuPatch {
    vec4 sphere; ///< mesh space
    vec4 cone;   ///< axis, sine
    float importance;
    uint coneLevel;
    uint part;
    uint material; ///< renderer-wide
    uint firstDomain;
    uint domainCount;
    uint firstCorner;
    uint firstParent;
    uint slotCount;
    uint firstRow; ///< of its interior
    uint rowCount;
    uint wide; ///< not 0: corners and parents take 32 bits
    uint partColor;
    uint reserved0, reserved1, reserved2;
};

struct GpuDomain {
    uint firstRow;
    uint rowCount;
    uint firstPatch;
    uint patchCount;
};

/// An asset: where its tables lie.
struct GpuAsset {
    vec4 sphere;
    Address patches;        ///< GpuPatch
    Address domains;        ///< GpuDomain
    Address domainPatches;  ///< uint
    Address patchDomains;   ///< uint
    Address patchSlots;     ///< uint, beside patchDomains
    Address errors;         ///< float, patch * levelCount + level
    Address lists;          ///< level and face count, patch * listCount + list
    Address collapseLevels; ///< bytes, a row each
    Address parentsNarrow;  ///< ushort
    Address parentsWide;    ///< uint
    Address cornersNarrow;  ///< ushort
    Address cornersWide;    ///< uint
    Address wholeErrors;    ///< float, a state each
    Address wholeLevels;    ///< bytes, state * patchCount + patch
    Address wholeFinest;    ///< uint, a state each: its finest level
    Address order;          ///< uint: patches by material
    Address skinErrors;     ///< xgc::SkinError, patch * levelCount + level
    Address morphErrors;    ///< float, (patch * levelCount + level) * targets + target
    uint patchCount;
    uint levelCount;
    uint listCount;
    uint stateCount;
};

XGC_CONST uint kInstancePresent = 1;
XGC_CONST uint kInstanceVisible = 2;
XGC_CONST uint kInstanceInvertible = 4; ///< toMesh holds
XGC_CONST uint kInstancePosed = 8;      ///< GpuFrame::posedPatches has its patches, by slot

/// An instance, as the host says each frame.
struct GpuInstance {
    vec4 toWorld[3];  ///< rows
    vec4 toMesh[3];   ///< rows of the inverse of its linear part
    vec4 posedSphere; ///< mesh space, of its pose
    float maxScale;
    uint generation;
    uint asset;
    uint firstSlot;
    uint firstControl; ///< kNone: nobody steers it
    uint flags;
    uint firstWeight; ///< of its pose, in GpuFrame::poseWeights
    uint weightCount; ///< likewise: targets, or none
};

/// xgc::PosedPatch
struct GpuPosedPatch {
    vec4 sphere;
    float stretch;
    float offset;
    float bend;
    float added;
};

/// xgc::PartControl, its levels within 0 to 255 and its bias within +-255.
struct GpuControl {
    float importance;
    int bias;
    uint finest;
    uint coarsest;
    uint hidden;
    uint reserved0, reserved1, reserved2;
};

/// Patches of one material of what is drawn as one: a whole state of an asset (asset * kWholeStates + state), or an
/// instance (GpuFrame::stateCapacity + id). In the order of the draws: by kind, then by material.
struct GpuRun {
    uint subject;
    uint asset;
    uint firstOrder; ///< in GpuAsset::order
    uint patchCount;
};

// What a view keeps from frame to frame ------------------------------------------------------------------------------

XGC_CONST uint kKindCulled = 0; ///< xgc::InstanceKind
XGC_CONST uint kKindWhole = 1;
XGC_CONST uint kKindMixed = 2;

XGC_CONST uint kStateWhole = 1; ///< takes one state, whether culled or not
XGC_CONST uint kStateBelt = 2;
XGC_CONST uint kStateDraw = 4; ///< whole: drawn in this phase
XGC_CONST uint kStateSeen = 8; ///< whole: was not hidden when last looked at

struct GpuInstanceState {
    uint generation;
    uint kind;
    uint flags;
    uint wholeState;
};

// A word a patch of an instance: the policy's level, the level, and these.
XGC_CONST uint kSlotVisible = 0x10000;
XGC_CONST uint kSlotDraw = 0x20000; ///< drawn in this phase
XGC_CONST uint kSlotSeen = 0x40000; ///< was not hidden when last looked at

// What a frame makes -------------------------------------------------------------------------------------------------

struct GpuRunPlace {
    uint itemCount;
    uint drawCount;
    uint firstItem;
    uint firstDraw;
};

/// A patch that is drawn.
struct GpuItem {
    uint run;
    uint patchId;
    uint indexCount;
    uint firstIndex;
};

/// Read back by the host, and by indirect dispatches and draws.
struct GpuTotals {
    uint groups[3]; ///< a work group an item
    uint drawCount;
    uint itemCount;
    uint indexCount;
    uint missingItems;          ///< not 0: items or draws did not fit
    uint missingIndices;        ///< not 0: indices did not fit
    uint triangles;             ///< of all instances, modulo 2^32
    uint kindDraws[kDrawKinds]; ///< of drawCount: those of kind k begin at k * GpuFrame::drawCapacity
    uint reserved0, reserved1, reserved2;
};

/// A frame of a view: everything is found from here.
struct GpuFrame {
    // The host's.
    Address assets;       ///< GpuAsset, by id of the scene
    Address instances;    ///< GpuInstance, by id
    Address controls;     ///< GpuControl
    Address runs;         ///< GpuRun
    Address posedPatches; ///< GpuPosedPatch, by slot
    Address poseWeights;  ///< float: magnitudes of the weights of targets
    // The view's.
    Address states; ///< GpuInstanceState, by id
    Address slots;  ///< uint
    // Of a phase.
    Address wholeFirsts; ///< uint a state, then one for mixed instances: where their ids begin
    Address wholeCounts; ///< likewise: instances
    Address ranks;       ///< uint an instance: its place in ids
    Address ids;         ///< uint: what instances of draws are
    Address places;      ///< GpuRunPlace
    Address items;       ///< GpuItem
    Address totals;      ///< GpuTotals
    Address commands;    ///< VkDrawIndexedIndirectCommand, drawCapacity a kind
    Address draws;       ///< DrawRecord, likewise
    Address indices;     ///< uint
    uint instanceEnd;
    uint assetEnd;
    uint stateCapacity;
    uint runCount;
    uint itemCapacity;
    uint drawCapacity;
    uint indexCapacity;
    uint phase; ///< kPhase...

    // What is asked for: SelectionDesc.
    vec4 eye;
    vec4 forward;
    vec4 planes[6];
    uint planeCount;
    uint byBands; ///< policy
    uint bandCount;
    uint orthographic;
    float bands[kNoLevel + 1];
    float pixelsPerUnit;
    float nearest;
    float contributionPixels;
    uint cullBackfaces;
    float loosePixels, middlePixels, tightPixels;
    float looseBand, middleBand, tightBand;
    float wholeInner, wholeOuter, beltInner; ///< radii
    uint kindRuns[kDrawKinds - 1];           ///< where the runs of kinds 1 and on begin
    // Of the second phase.
    mat4 worldToClip;
    Address depth; ///< float: the pyramid of what the first one drew
    uint depthSize[2];
};

XGC_CONST uint kPhaseAll = 0;    ///< everything that is visible
XGC_CONST uint kPhaseSeen = 1;   ///< of that, what was seen in the last frame
XGC_CONST uint kPhaseUnseen = 2; ///< of the rest, what the depth of the first does not hide: not by gpu_select

struct GpuPush {
    Address frame;
    uint step; ///< of the shader
    uint reserved;
};

#ifdef __cplusplus
static_assert(sizeof(GpuPatch) == 96);
static_assert(sizeof(GpuAsset) == 176);
static_assert(sizeof(GpuInstance) == 144);
static_assert(sizeof(GpuPosedPatch) == 32);
static_assert(sizeof(GpuControl) == 32);
static_assert(sizeof(GpuFrame) % 16 == 0 && offsetof(GpuFrame, worldToClip) % 16 == 0);
} // namespace xgc::shader
#endif

#endif
