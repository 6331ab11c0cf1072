// Structs and constants that C++ and GLSL both see. Layout: std430 with 16-byte vectors only, so that both sides agree
// without padding rules; addresses are 64 bits, a pair of words in GLSL.
#ifndef XGC_SHADERS_SHARED_H
#define XGC_SHADERS_SHARED_H

#include "types.h"

#ifdef __cplusplus
namespace xgc::shader {
#endif

XGC_CONST uint kModeShaded = 0;
XGC_CONST uint kModeParts = 1;
XGC_CONST uint kModeLevels = 2;
XGC_CONST uint kModeWire = 3;
XGC_CONST uint kModeError = 4;

XGC_CONST uint kPartColorCount = 12;

XGC_CONST uint kNothing = 0xffffffffu; ///< names no instance and no part

XGC_CONST uint kNoLambdas = 0xffffffffu;
XGC_CONST uint kMorphRows = 4; ///< xgc::kMorphRows

/// A view: a camera and how to colour what it sees.
struct ViewRecord {
    mat4 worldToClip;
    vec4 eye;   ///< xyz
    vec4 right; ///< the camera's unit vectors, which the lights hang on
    vec4 up;
    vec4 forward;
    vec4 sky;     ///< up in the world, for the ambient light
    vec4 measure; ///< of kModeError: xyz, the eye that errors are seen from; w, budgets that a world unit is at
                  ///< distance 1
    uint mode;
    float linePixels;       ///< width of an edge's line
    uint highlightInstance; ///< or kNothing
    uint highlightPart;
    // The sun and its shadows, where sunColor.w is not 0.
    mat4 worldToShadow; ///< clip space of the shadow map
    vec4 sun;           ///< xyz: unit, towards it; w: world units that a texel of the map covers
    vec4 sunColor;      ///< linear, xyz
    Address shadow;     ///< depths of the map, reversed, a float a texel, rows from the top
    uint shadowSize;    ///< texels a side
    uint reserved2;
};

/// An instance: where it stands and where its vertex streams lie. Address 0: the asset has none.
struct InstanceRecord {
    vec4 toWorld[3];   ///< rows
    Address positions; ///< float3 each row
    Address normals;   ///< octahedral snorm16x2
    Address colors;    ///< linear RGBA
    uint colorFormat;  ///< xgc::format::StreamFormat
    uint reserved;
    Address morphs; ///< xgc::MorphRow each row
    // Poses (xgc/skin.h).
    Address joints[2];    ///< u16 x 4 each row: two sets
    Address weights[2];   ///< float4 each row
    Address pose;         ///< three vec4 each joint, the rows of its matrix; 0: no joint moves it
    Address morphRows;    ///< a uint each row, and the end: of its displacements
    Address morphDeltas;  ///< seven words each: target, position, normal
    Address morphWeights; ///< a float a target; 0: no target moves it
    float maxScale;       ///< of toWorld
    uint reserved1;
};

/// A draw: what its triangles look like, and where its instances and indices lie.
struct DrawRecord {
    uint firstInstance; ///< of its ids in PushConstants::instanceIds
    uint material;
    uint partColor;      ///< below kPartColorCount, unlike those of adjacent parts; kPartColorCount: of several parts
    float levelFraction; ///< level / the asset's coarsest
    uint vertexOffset;   ///< row that index 0 stands for
    uint indexBytes;     ///< 2 or 4
    float error;         ///< E at its level, mesh units
    uint part;           ///< kNothing: of several parts
};

struct MaterialRecord {
    vec4 baseColor; ///< linear
    vec4 emissive;  ///< linear, xyz
    float metallic;
    float roughness;
    uint flags;
    float alphaCutoff; ///< of alpha-tested ones: what is below is not there
};

/// Everything is found from here: no descriptors.
struct PushConstants {
    Address view;
    Address instances;
    Address draws;
    Address materials;
    Address indices;
    Address instanceIds; ///< a uint each
    uint firstDraw;      ///< of the batch: gl_DrawID counts from it
    uint reserved;
    Address lambdaOffsets; ///< a uint each instance: of its lambdas, or kNoLambdas; 0: nothing morphs
    Address lambdas;       ///< a float a group
};

#ifdef __cplusplus
static_assert(sizeof(ViewRecord) == 288);
static_assert(sizeof(InstanceRecord) == 160);
static_assert(sizeof(DrawRecord) == 32);
static_assert(sizeof(MaterialRecord) == 48);
static_assert(sizeof(PushConstants) == 72);
} // namespace xgc::shader
#endif

#endif
