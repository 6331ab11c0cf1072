/* The runtime in C: what scene.h, selection.h, index_cache.h and draw_list.h offer for a frame, for C11, C++ and
 * whatever calls C. What the parts do is said there and in README.md; this header says what C adds.
 *
 *   XgcAsset ---> XgcScene ---> XgcSelection ---> XgcDrawList ---> draws, batches
 *                                                  |     ^
 *                                    wanted states v     | ranges
 *                                              XgcIndexCache ---> copies
 *
 * Arguments. No pointer may be null, but where it is said. What is wrong with an argument (a null pointer, an id of
 * nothing, an index or a size out of range) is a status: nothing changes then and no output is written. A pointer to
 * memory that was freed, or is shorter than it was said to be, is not found out.
 *
 * Structs. One that starts with `size` may grow at its end: the library reads as much as the host's `size` says and
 * takes defaults for the rest; the host sets it with the struct's Defaults function, or by hand. Where the library
 * writes one, the host sets `size` before, and what lies behind the fields that the library knows is zeroed. All other
 * structs stay as they are for as long as XGC_ABI_VERSION does. Flags are 0 or 1 (any other value counts as 1).
 *
 * Ownership. The host owns all memory that it passes; a create or open gives an object that belongs to the host until
 * its destroy or close. Pointers that are returned belong to the library and stay valid as long as is said with them.
 *
 * Threads. The library starts none. An asset may be read by any number of threads. A scene may be read by any number
 * (updates of selections and draw lists read it) while none changes it. Each other object is used by one thread at a
 * time. xgcSetAllocator and xgcSetLog are called before all that, by one thread.
 *
 * Units and spaces. Mesh space and its units are the file's, world space is what placements lead to. Matrices are
 * column-major, and take columns from the left (clip = worldToClip * world). Angles are radians. */
#ifndef XGC_XGC_H
#define XGC_XGC_H

#include <stddef.h>
#include <stdint.h>

/* XGC_SHARED: the host uses the shared library (the CMake target xgc::c sets it). */
#if defined(_WIN32) && defined(XGC_SHARED) && defined(XGC_BUILDING)
#define XGC_API __declspec(dllexport)
#elif defined(_WIN32) && defined(XGC_SHARED)
#define XGC_API __declspec(dllimport)
#elif defined(__GNUC__)
#define XGC_API __attribute__((visibility("default")))
#else
#define XGC_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Hosts and libraries of one number fit together. New functions and grown structs do not change it. */
#define XGC_ABI_VERSION 1
/* XGC_ABI_VERSION of the library. */
XGC_API uint32_t xgcAbiVersion(void);

/* No such part, patch, level. */
#define XGC_NONE 0xffffffffu
/* Levels lie below this. */
#define XGC_MAX_LEVELS 254u
/* Bytes of assets start at a multiple of this. */
#define XGC_ALIGNMENT 64u

typedef struct XgcAsset XgcAsset;
typedef struct XgcScene XgcScene;
typedef struct XgcSelection XgcSelection;
typedef struct XgcIndexCache XgcIndexCache;
typedef struct XgcDrawList XgcDrawList;

/* Status ---------------------------------------------------------------------------------------------------------- */

enum {
    XGC_OK = 0,
    XGC_BAD_ARGUMENT = 1,
    XGC_NOT_AN_ASSET = 2,    /* the magic is missing */
    XGC_BAD_VERSION = 3,     /* written by another version of the format */
    XGC_UNSUPPORTED = 4,     /* valid, but uses a feature that this build does not read (compressed: use xgc::load) */
    XGC_TRUNCATED = 5,       /* the bytes end before the asset does */
    XGC_BAD_CHECKSUM = 6,    /* a section or page was altered */
    XGC_CORRUPT = 7,         /* an offset, count, order or index breaks a rule of FORMAT.md */
    XGC_OUT_OF_CAPACITY = 8, /* a fixed capacity is exhausted; the message names the setting to raise */
    XGC_DEVICE_REFUSED = 9   /* of graphics backends; the core never gives it */
};

typedef struct XgcStatus {
    uint32_t code; /* XGC_OK, ... */
    uint32_t reserved;
    const char* message; /* a static English sentence: what failed, and what to do */
    uint64_t element;    /* that the message speaks of: an index, an id, or the value that would have sufficed */
} XgcStatus;

/* The host's services ---------------------------------------------------------------------------------------------- */

/* The host's heap. `allocate` returns null where there is no memory; `alignment` is a power of two. */
typedef struct XgcAllocator {
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*free)(void* user, void* memory, size_t bytes, size_t alignment);
    void* user;
} XgcAllocator;
/* Null: the C++ heap again. Refused while an object of this header lives; objects of the C++ API are not counted. */
XGC_API XgcStatus xgcSetAllocator(const XgcAllocator* allocator);

/* Is told of each call that fails, on the thread of the call, before it returns. `function` and `message` are static.
 * It must not call the library. */
typedef struct XgcLog {
    void (*write)(void* user, const char* function, uint32_t code, const char* message, uint64_t element);
    void* user;
} XgcLog;
/* Null: nobody is told, as at first. */
XGC_API void xgcSetLog(const XgcLog* log);

/* The host's scheduler: calls job(data, index) once for each index below `count`, on any threads in any order, and
 * returns when all have returned. Where `run` is null the library does the work on the calling thread. */
typedef struct XgcJobSystem {
    void (*run)(void* user, uint32_t count, void (*job)(void* data, uint32_t index), void* data);
    void* user;
} XgcJobSystem;

/* Views and placements --------------------------------------------------------------------------------------------- */

typedef struct XgcView {
    float eye[3];          /* world space */
    float pixelsPerUnit;   /* that one world unit covers at distance one; orthographic: at any */
    float nearest;         /* nothing nearer to the eye is drawn: the near plane's distance, or 0 */
    uint32_t orthographic; /* flag */
    float forward[3];      /* unit; where an orthographic view looks */
} XgcView;
/* Perspective. `fovY`: above 0 and below pi; `viewportHeight`: pixels. */
XGC_API XgcStatus xgcMakeView(const float eye[3], float fovY, float viewportHeight, XgcView* view);
/* `height` world units over `viewportHeight` pixels. `forward` need not be unit. */
XGC_API XgcStatus xgcMakeOrthographicView(const float eye[3], const float forward[3], float height,
                                          float viewportHeight, XgcView* view);

typedef struct XgcPlacement {
    float toWorld[12]; /* affine: four columns of three */
    float maxScale;    /* how much it lengthens a vector at most */
} XgcPlacement;
/* Of a 4x4 matrix, which must be affine, finite and not zero. */
XGC_API XgcStatus xgcMakePlacement(const float toWorld[16], XgcPlacement* placement);

typedef struct XgcFrustum {
    float planes[6][4];  /* world space, dot(plane.xyz, x) + plane.w >= 0 inside */
    uint32_t planeCount; /* 0: everything is inside */
} XgcFrustum;
/* Of a clip space with -w <= x, y <= w and 0 <= z <= w (Vulkan, D3D), reversed or not. */
XGC_API XgcStatus xgcMakeFrustum(const float worldToClip[16], XgcFrustum* frustum);

/* Assets ----------------------------------------------------------------------------------------------------------- */

/* Checks the bytes of a whole, uncompressed file and opens them in place. `bytes`: aligned to XGC_ALIGNMENT, unchanged
 * and kept until the asset is closed. Memory is safe whatever they are. */
XGC_API XgcStatus xgcAssetOpen(const void* bytes, size_t byteCount, XgcAsset** asset);
/* Refused while a scene or an index cache has it. Null: nothing happens. */
XGC_API XgcStatus xgcAssetClose(XgcAsset* asset);

enum { XGC_ERROR_IS_ESTIMATE = 1, XGC_INPUT_IS_CLOSED = 2 };

typedef struct XgcAssetInfo {
    uint32_t size;
    uint32_t levelCount;
    uint32_t patchCount;
    uint32_t partCount;
    uint32_t materialCount; /* at least 1 */
    uint32_t nodeCount;
    uint32_t domainCount;     /* groups of patches that share vertices */
    uint32_t vertexCount;     /* rows of each vertex stream */
    uint32_t baseVertexCount; /* of those, at level 0 */
    uint32_t faceCount;       /* triangles of level 0 */
    uint32_t vertexStreamCount;
    uint32_t maxPatchFaces;   /* for XgcIndexCacheConfig::faceCapacity */
    uint32_t maxPatchDomains; /* for XgcIndexCacheConfig::domainsPerPatchCapacity */
    uint32_t scratchCapacity; /* entries for xgcAssetBuildIndices; for XgcIndexCacheConfig::slotCapacity */
    uint32_t flags;           /* XGC_ERROR_IS_ESTIMATE, XGC_INPUT_IS_CLOSED */
    float boundsMin[3];       /* mesh space */
    float boundsMax[3];
    float sphereCenter[3];
    float sphereRadius;
    float positionStep; /* positions of level 0 are the input's, snapped to multiples of it; 0: as they were */
} XgcAssetInfo;
XGC_API XgcStatus xgcAssetInfo(const XgcAsset* asset, XgcAssetInfo* info);

enum {
    XGC_STREAM_POSITION = 1,
    XGC_STREAM_NORMAL = 2,
    XGC_STREAM_TANGENT = 3, /* w: handedness */
    XGC_STREAM_UV = 4,
    XGC_STREAM_COLOR = 5,
    XGC_STREAM_JOINTS = 6,
    XGC_STREAM_WEIGHTS = 7
};
enum {
    XGC_FORMAT_U8 = 1,
    XGC_FORMAT_U16 = 2,
    XGC_FORMAT_U32 = 3,
    XGC_FORMAT_F32X2 = 4,
    XGC_FORMAT_F32X3 = 5,
    XGC_FORMAT_F32X4 = 6,
    XGC_FORMAT_UNORM8X4 = 7,
    XGC_FORMAT_U16X4 = 8,
    XGC_FORMAT_SNORM16X2 = 9, /* octahedral unit vector */
    XGC_FORMAT_SNORM16X4 = 10
};

/* What a renderer uploads: `count` elements of `format`, `stride` bytes apart. The first stream is the positions. */
typedef struct XgcVertexStream {
    uint32_t size;
    uint32_t kind;   /* XGC_STREAM_... */
    uint32_t format; /* XGC_FORMAT_... */
    uint32_t set;    /* UV, colour and joint sets count from 0 */
    uint32_t stride;
    uint32_t count;
    const void* bytes; /* in those of the asset */
    uint64_t byteCount;
} XgcVertexStream;
XGC_API XgcStatus xgcAssetVertexStream(const XgcAsset* asset, uint32_t index, XgcVertexStream* stream);

/* Texts are UTF-8 in the asset's bytes, without a terminator. */
typedef struct XgcPart {
    uint32_t size;
    uint32_t nameBytes;
    const char* name;
    uint64_t stableId; /* the same over bakes that keep the name */
    uint32_t firstPatch;
    uint32_t patchCount;
    uint32_t faceCount; /* at level 0 */
    float importance;
    float area;
    float centroid[3];
    const uint32_t* neighbours; /* parts that share an edge with it, in the asset's bytes */
    uint32_t neighbourCount;
    uint32_t reserved;
} XgcPart;
XGC_API XgcStatus xgcAssetPart(const XgcAsset* asset, uint32_t part, XgcPart* out);
/* `part` is XGC_NONE where the asset has none of that id or name. Linear in the number of parts. */
XGC_API XgcStatus xgcAssetFindPart(const XgcAsset* asset, uint64_t stableId, uint32_t* part);
/* `name` ends with a zero. */
XGC_API XgcStatus xgcAssetFindPartByName(const XgcAsset* asset, const char* name, uint32_t* part);
/* Joins parts, the least distinct first, until `wanted` (at least 1) groups are left, or more where the asset's merges
 * do not go so far. `groupOfPart`: partCount entries, all written: groups count from 0 in order of their lowest parts.
 */
XGC_API XgcStatus xgcAssetMergedParts(const XgcAsset* asset, uint32_t wanted, uint32_t* groupOfPart, uint32_t partCount,
                                      uint32_t* groupCount);

typedef struct XgcPatch {
    uint32_t size;
    uint32_t part;
    uint32_t material;
    uint32_t faceCount; /* at level 0 */
    float boxMin[3];    /* contains the patch in every state, mesh space */
    float boxMax[3];
    float sphereCenter[3]; /* likewise */
    float sphereRadius;
} XgcPatch;
XGC_API XgcStatus xgcAssetPatch(const XgcAsset* asset, uint32_t patch, XgcPatch* out);
/* How far the patch at a level lies from the input's surface at most, mesh units. */
XGC_API XgcStatus xgcAssetError(const XgcAsset* asset, uint32_t patch, uint32_t level, float* error);

typedef struct XgcLevel {
    uint32_t size;
    uint32_t faceCount; /* with all patches at the level */
    float maxError;     /* of all patches, mesh units */
    float threshold;    /* that the builder worked to, mesh units; 0: none */
} XgcLevel;
XGC_API XgcStatus xgcAssetLevel(const XgcAsset* asset, uint32_t level, XgcLevel* out);

enum { XGC_DOUBLE_SIDED = 1, XGC_ALPHA_MASK = 2, XGC_ALPHA_BLEND = 4 };

typedef struct XgcMaterial {
    uint32_t size;
    uint32_t nameBytes;
    const char* name;
    float baseColor[4]; /* linear */
    float metallic;
    float roughness;
    float emissive[3]; /* linear */
    uint32_t flags;    /* XGC_DOUBLE_SIDED, ... */
} XgcMaterial;
XGC_API XgcStatus xgcAssetMaterial(const XgcAsset* asset, uint32_t material, XgcMaterial* out);

/* A node of the source scene, for attaching things. Geometry is in mesh space already. */
typedef struct XgcNode {
    uint32_t size;
    uint32_t nameBytes;
    const char* name;
    uint32_t parent; /* XGC_NONE: a root */
    float toMesh[16];
    uint32_t reserved;
} XgcNode;
XGC_API XgcStatus xgcAssetNode(const XgcAsset* asset, uint32_t node, XgcNode* out);

/* One asset without a scene ---------------------------------------------------------------------------------------- */

/* `levels`: of `patchCount` patches, which is the asset's. */
/* Level = the coarsest whose error projects to at most `pixels`, which is not negative. All levels are written. */
XGC_API XgcStatus xgcAssetSelectByError(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view,
                                        float pixels, uint8_t* levels, uint32_t patchCount);
/* Level = the number of thresholds, which rise, at or below the distance in radii of the asset. `thresholds`: null
 * where there are none. */
XGC_API XgcStatus xgcAssetSelectByDistance(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view,
                                           const float* thresholds, uint32_t thresholdCount, uint8_t* levels,
                                           uint32_t patchCount);
/* Largest projected error of a state; infinite where the eye is inside the bounds of a patch with an error. */
XGC_API XgcStatus xgcAssetProjectedError(const XgcAsset* asset, const XgcPlacement* placement, const XgcView* view,
                                         const uint8_t* levels, uint32_t patchCount, float* pixels);
/* Most indices that xgcAssetBuildIndices writes for a patch. */
XGC_API XgcStatus xgcAssetIndexCapacity(const XgcAsset* asset, uint32_t patch, const uint8_t* levels,
                                        uint32_t patchCount, uint32_t* indexCapacity);
/* Most triangles of a patch in a state; exact where all levels are one. */
XGC_API XgcStatus xgcAssetTriangleBound(const XgcAsset* asset, uint32_t patch, const uint8_t* levels,
                                        uint32_t patchCount, uint32_t* triangles);
/* The triangle list of a patch in a state: vertex rows, front faces counter-clockwise. `scratch`: XgcAssetInfo's
 * scratchCapacity entries, overwritten; one a thread. `indices`: at least xgcAssetIndexCapacity entries, all of which
 * may be overwritten. */
XGC_API XgcStatus xgcAssetBuildIndices(const XgcAsset* asset, uint32_t patch, const uint8_t* levels,
                                       uint32_t patchCount, uint32_t* scratch, uint32_t scratchCapacity,
                                       uint32_t* indices, uint32_t indexCapacity, uint32_t* indexCount);
/* `needed` is 1 where the triangles of the patch differ, or may differ, between two states. */
XGC_API XgcStatus xgcAssetNeedsRebuild(const XgcAsset* asset, uint32_t patch, const uint8_t* before,
                                       const uint8_t* after, uint32_t patchCount, uint32_t* needed);

/* Geomorphs (morph.h) ---------------------------------------------------------------------------------------------- */

/* A row as a vertex shader sees it. */
typedef struct XgcMorphRow {
    uint32_t target;        /* row that it goes to; itself where it never collapses */
    uint32_t groupAndLevel; /* group, and in the upper 8 bits its collapse level (255: never) */
} XgcMorphRow;
/* What a renderer uploads once: a MorphRow each row. `rowCount`: XgcAssetInfo::vertexCount. */
XGC_API XgcStatus xgcAssetMorphRows(const XgcAsset* asset, XgcMorphRow* rows, uint32_t rowCount);
/* What a renderer uploads each frame for each instance that morphs: a lambda each group. `fractions`: null, or one a
 * patch. `groupCount`: XgcAssetInfo's domainCount + patchCount. */
XGC_API XgcStatus xgcAssetGroupLambdas(const XgcAsset* asset, const uint8_t* levels, const float* fractions,
                                       uint32_t patchCount, float* lambdas, uint32_t groupCount);

/* Scene ------------------------------------------------------------------------------------------------------------ */

typedef struct XgcSceneConfig {
    uint32_t size;
    uint32_t assetCapacity;
    uint32_t instanceCapacity;
    uint32_t assetPatchCapacity;  /* sum of the patches of all assets */
    uint32_t patchCapacity;       /* sum of the patches of all instances */
    uint32_t steeredPartCapacity; /* sum of the parts of all instances with a part control */
} XgcSceneConfig;
/* Defaults functions: `size` is the struct's as the host knows it. */
XGC_API void xgcSceneConfigDefaults(XgcSceneConfig* config, uint32_t size);

/* Allocates all memory of the scene, as every create does. */
XGC_API XgcStatus xgcSceneCreate(const XgcSceneConfig* config, XgcScene** scene);
/* Selections and draw lists that were updated from it are of no further use, but to be destroyed (draw lists: cleared
 * before it). Null: nothing happens. */
XGC_API void xgcSceneDestroy(XgcScene* scene);

typedef struct XgcAssetDesc {
    uint32_t size;
    int32_t vertexOffset;   /* of its row 0 in the renderer's vertex buffers */
    uint32_t firstMaterial; /* its material 0 in the renderer's list */
} XgcAssetDesc;
XGC_API void xgcAssetDescDefaults(XgcAssetDesc* desc, uint32_t size);

/* Ids of assets and instances are reused after their removal. The asset stays open until it is removed. */
XGC_API XgcStatus xgcSceneAddAsset(XgcScene* scene, const XgcAsset* asset, const XgcAssetDesc* desc, uint32_t* id);
/* Its instances must be gone, and draw lists must have forgotten it. */
XGC_API XgcStatus xgcSceneRemoveAsset(XgcScene* scene, uint32_t asset);
XGC_API XgcStatus xgcSceneAddInstance(XgcScene* scene, uint32_t asset, const XgcPlacement* placement, uint32_t* id);
XGC_API XgcStatus xgcSceneRemoveInstance(XgcScene* scene, uint32_t instance);
XGC_API XgcStatus xgcSceneSetPlacement(XgcScene* scene, uint32_t instance, const XgcPlacement* placement);
XGC_API XgcStatus xgcScenePlacement(const XgcScene* scene, uint32_t instance, XgcPlacement* placement);
/* An instance that is not visible is culled in every view. They start visible. */
XGC_API XgcStatus xgcSceneSetVisible(XgcScene* scene, uint32_t instance, uint32_t visible);
XGC_API XgcStatus xgcSceneAssetOf(const XgcScene* scene, uint32_t instance, uint32_t* asset);
/* Ids of instances lie below this; not all of them name one. 0 for null. */
XGC_API uint32_t xgcSceneInstanceEnd(const XgcScene* scene);
/* 1 where the id names an instance. 0 for null. */
XGC_API uint32_t xgcSceneHasInstance(const XgcScene* scene, uint32_t instance);

/* How a part of an instance is steered. Applied after the policy: bias first, then the limits. */
typedef struct XgcPartControl {
    uint32_t size;
    float importance;  /* times the part's own: 2 asks for half the error; positive */
    int32_t bias;      /* levels added to the policy's choice: positive is coarser */
    uint32_t finest;   /* no level finer than this */
    uint32_t coarsest; /* no level coarser than this; wins over `finest` */
    uint32_t hidden;   /* flag: not drawn; its neighbours stay as they are */
} XgcPartControl;
XGC_API void xgcPartControlDefaults(XgcPartControl* control, uint32_t size);
XGC_API XgcStatus xgcSceneSetPart(XgcScene* scene, uint32_t instance, uint32_t part, const XgcPartControl* control);
XGC_API XgcStatus xgcScenePart(const XgcScene* scene, uint32_t instance, uint32_t part, XgcPartControl* control);
/* Gives all parts of the instance back to the policies. */
XGC_API XgcStatus xgcSceneClearParts(XgcScene* scene, uint32_t instance);

/* States of an asset as a whole: in each, every patch is at the coarsest level whose error, times its part's
 * importance, is at most `error` (mesh units), which rises with the state from 0. */
typedef struct XgcWholeState {
    uint32_t size;
    float error;
    uint32_t triangles;  /* or somewhat more than it draws */
    uint32_t stateCount; /* of the asset */
} XgcWholeState;
/* `levels`: of all patches, written; null: not asked for. */
XGC_API XgcStatus xgcSceneWholeState(const XgcScene* scene, uint32_t asset, uint32_t state, XgcWholeState* out,
                                     uint8_t* levels, uint32_t patchCount);

/* Selection -------------------------------------------------------------------------------------------------------- */

enum {
    XGC_POLICY_ERROR_PIXELS = 0,  /* the coarsest level whose error projects to at most `pixels` */
    XGC_POLICY_DISTANCE_BANDS = 1 /* the number of `bands` at or below the distance, in radii of the asset */
};

/* What a view asks for; the fields are those of xgc::SelectionDesc. */
typedef struct XgcSelectionDesc {
    uint32_t size;
    uint32_t policy; /* XGC_POLICY_... */
    XgcView view;
    XgcFrustum frustum;
    float pixels;       /* not negative */
    float hysteresis;   /* 0 to below 1 */
    const float* bands; /* rising; read during the update alone; null where there are none */
    uint32_t bandCount;
    uint32_t cullBackfaces;        /* flag */
    float contributionPixels;      /* culls what covers a smaller radius on screen */
    float wholeBeyond;             /* radii from which on an instance is decided at once, by errors; infinite: never */
    uint32_t triangleBudget;       /* 0: none; error-pixels only */
    uint32_t boundPixels;          /* flag: also computes XgcSelectionStats::pixelsBound */
    const XgcSelection* reference; /* null: none; updated before from the same scene (a shadow's: the main view's) */
    uint32_t coarserThanReference; /* levels that a patch may be above what it has there */
    uint32_t morph;                /* flag: levels change continuously; without hysteresis and budget */
    float morphRate;               /* most levels by which a patch may change in an update; positive */
    uint32_t reserved;
    XgcJobSystem jobs;
} XgcSelectionDesc;
XGC_API void xgcSelectionDescDefaults(XgcSelectionDesc* desc, uint32_t size);

typedef struct XgcSelectionStats {
    uint32_t size;
    uint32_t visibleInstances;
    uint32_t wholeInstances;    /* of those: decided at once */
    uint32_t consideredPatches; /* of the others */
    uint32_t culledPatches;     /* of those */
    uint32_t changedPatches;    /* of those: other level than in the last update */
    float pixels;               /* that the levels hold: the desc's, or more under a budget */
    uint32_t triangleBudget;
    uint64_t triangleBound; /* under a budget: the levels draw no more than this */
    uint32_t overBudget;    /* flag: even the coarsest levels, which were chosen then, exceed it */
    float pixelsBound;      /* where asked for: no choice of levels holds less */
} XgcSelectionStats;

enum {
    XGC_INSTANCE_CULLED = 0, /* not drawn */
    XGC_INSTANCE_WHOLE = 1,  /* in state `wholeState` of its asset (xgcSceneWholeState) */
    XGC_INSTANCE_MIXED = 2   /* patches at `levels`, where `visible` */
};

typedef struct XgcInstanceLevels {
    uint32_t size;
    uint32_t kind;          /* XGC_INSTANCE_... */
    uint32_t wholeState;    /* of kind whole, else XGC_NONE */
    uint32_t patchCount;    /* of kind mixed, else 0 */
    const uint8_t* levels;  /* of kind mixed, else null */
    const uint8_t* visible; /* likewise, 1 where the patch is drawn; of a selection only */
    const float* fractions; /* of the way to the next level, a patch each; null where it does not morph */
} XgcInstanceLevels;

/* For scenes of the same capacities, or smaller ones. */
XGC_API XgcStatus xgcSelectionCreate(const XgcSceneConfig* config, XgcSelection** selection);
XGC_API void xgcSelectionDestroy(XgcSelection* selection);
/* Chooses the levels for all instances; allocates nothing. */
XGC_API XgcStatus xgcSelectionUpdate(XgcSelection* selection, const XgcScene* scene, const XgcSelectionDesc* desc);
/* The host's own choice for an instance, in place of a policy's, until the next update. `fractions`: a patch each,
 * from 0 to 1 - 1/16384; null: it does not morph. */
XGC_API XgcStatus xgcSelectionSet(XgcSelection* selection, const XgcScene* scene, uint32_t instance,
                                  const uint8_t* levels, const float* fractions, uint32_t patchCount);
/* The pointers stay valid until the next change of the scene or the selection. */
XGC_API XgcStatus xgcSelectionInstance(const XgcSelection* selection, uint32_t instance, XgcInstanceLevels* out);
XGC_API XgcStatus xgcSelectionStats(const XgcSelection* selection, XgcSelectionStats* stats);

/* Index cache ------------------------------------------------------------------------------------------------------ */

typedef struct XgcIndexCacheConfig {
    uint32_t size;
    uint32_t arenaBytes;
    uint32_t rangeCapacity; /* states of patches that are kept at once */
    uint32_t keyBytes;      /* for their names: 9 bytes each and one for each domain of the patch */
    uint32_t assetCapacity;
    uint32_t slotCapacity;            /* largest XgcAssetInfo::scratchCapacity */
    uint32_t faceCapacity;            /* largest XgcAssetInfo::maxPatchFaces */
    uint32_t patchCapacity;           /* largest XgcAssetInfo::patchCount */
    uint32_t domainsPerPatchCapacity; /* largest XgcAssetInfo::maxPatchDomains */
    uint32_t copyCapacity;            /* copies a frame */
    uint32_t framesInFlight;          /* at least 1 */
    uint32_t narrowIndices;           /* flag; 0: all indices take four bytes */
} XgcIndexCacheConfig;
XGC_API void xgcIndexCacheConfigDefaults(XgcIndexCacheConfig* config, uint32_t size);

/* Bytes to copy from the frame's staging memory into the index arena: multiples of 4, as all three are. */
typedef struct XgcCopyRange {
    uint32_t staging;
    uint32_t arena;
    uint32_t bytes;
} XgcCopyRange;

typedef struct XgcIndexRange {
    uint32_t firstIndex;   /* in indices of its own size */
    uint32_t indexCount;   /* 0: nothing to draw */
    uint32_t indexBytes;   /* 2 or 4 */
    uint32_t vertexOffset; /* asset row that index 0 stands for */
} XgcIndexRange;

typedef struct XgcIndexCacheStats {
    uint32_t size;
    /* Since xgcIndexCacheBeginFrame. */
    uint32_t hits;
    uint32_t misses;    /* built, and copied where there is something to draw */
    uint32_t evictions; /* ranges that others took the place of */
    uint32_t refusals;  /* staging, copies or a capacity was full */
    uint32_t uploadBytes;
    /* Now. */
    uint32_t ranges; /* held or not */
    uint32_t heldRanges;
    uint32_t usedBytes; /* of the arena, held or not */
    uint32_t largestFreeBytes;
} XgcIndexCacheStats;

XGC_API XgcStatus xgcIndexCacheCreate(const XgcIndexCacheConfig* config, XgcIndexCache** cache);
/* Draw lists must be cleared before, or only be destroyed after it. Null: nothing happens. */
XGC_API void xgcIndexCacheDestroy(XgcIndexCache* cache);
/* `id`: a scene's for the asset, free here. */
XGC_API XgcStatus xgcIndexCacheAddAsset(XgcIndexCache* cache, uint32_t id, const XgcAsset* asset);
/* All its ranges must be released: draw lists must have forgotten it. */
XGC_API XgcStatus xgcIndexCacheRemoveAsset(XgcIndexCache* cache, uint32_t asset);

/* Starts a frame, when the one framesInFlight before it has left the GPU. Indices are written to `staging` (aligned to
 * 4; never read), which stays valid until the renderer has copied from it. Its size is the frame's upload cap. Null
 * where there are no bytes. */
XGC_API XgcStatus xgcIndexCacheBeginFrame(XgcIndexCache* cache, void* staging, uint32_t stagingBytes);
XGC_API XgcStatus xgcIndexCacheEndFrame(XgcIndexCache* cache);
/* What to copy before any draw of the frame. Valid from the end of a frame to the begin of the next. Null for null. */
XGC_API const XgcCopyRange* xgcIndexCacheCopies(const XgcIndexCache* cache, uint32_t* count);
XGC_API XgcStatus xgcIndexCacheStats(const XgcIndexCache* cache, XgcIndexCacheStats* stats);

/* For hosts that draw without a draw list. Holds the range of a patch in a state, built where the cache has none; in a
 * frame. Undone by one release. Out of capacity: nothing is held. */
XGC_API XgcStatus xgcIndexCacheAcquire(XgcIndexCache* cache, uint32_t asset, uint32_t patch, const uint8_t* levels,
                                       uint32_t patchCount, uint32_t* range);
/* The triangles of all patches of a material in a state of the whole asset. `number` names the state: the same levels
 * in all calls with it; draw lists number the states as the scene does. */
XGC_API XgcStatus xgcIndexCacheAcquireWhole(XgcIndexCache* cache, uint32_t asset, uint32_t material, uint32_t number,
                                            const uint8_t* levels, uint32_t patchCount, uint32_t* range);
/* Once more. In or between frames, as release. */
XGC_API XgcStatus xgcIndexCacheHold(XgcIndexCache* cache, uint32_t range);
XGC_API XgcStatus xgcIndexCacheRelease(XgcIndexCache* cache, uint32_t range);
/* Where a range that is held lies in the arena. */
XGC_API XgcStatus xgcIndexCacheRange(const XgcIndexCache* cache, uint32_t range, XgcIndexRange* out);
/* Bytes of staging that an acquire would take at most, and that are free in the frame. */
XGC_API XgcStatus xgcIndexCacheBytesNeeded(const XgcIndexCache* cache, uint32_t asset, uint32_t patch,
                                           const uint8_t* levels, uint32_t patchCount, uint64_t* bytes);
XGC_API XgcStatus xgcIndexCacheFreeStagingBytes(const XgcIndexCache* cache, uint64_t* bytes);

/* Draw list -------------------------------------------------------------------------------------------------------- */

typedef struct XgcDrawListConfig {
    uint32_t size;
    uint32_t materialCapacity;   /* renderer-wide */
    uint32_t wholeTriangles;     /* whole instances of at most so many triangles are drawn as one range a material */
    uint32_t wholeRangeCapacity; /* materials of all states of whole assets that are drawn at once */
    uint32_t domainCapacity;     /* largest XgcAssetInfo::domainCount */
} XgcDrawListConfig;
XGC_API void xgcDrawListConfigDefaults(XgcDrawListConfig* config, uint32_t size);

/* Byte for byte a VkDrawIndexedIndirectCommand and D3D12_DRAW_INDEXED_ARGUMENTS. */
typedef struct XgcDrawCommand {
    uint32_t indexCount;
    uint32_t instanceCount;
    uint32_t firstIndex;
    int32_t vertexOffset;
    uint32_t firstInstance; /* of its ids in xgcDrawListInstances */
} XgcDrawCommand;

/* What a draw command draws: index for index beside the commands. */
typedef struct XgcDrawSource {
    uint32_t asset;
    uint32_t patch; /* XGC_NONE: all patches of one material of a whole asset */
    uint32_t level; /* or the finest of a whole asset's */
} XgcDrawSource;

/* A run of draw commands that share a material and a size of index. */
typedef struct XgcDrawBatch {
    uint32_t material;   /* renderer-wide: the asset's firstMaterial + its own number */
    uint32_t indexBytes; /* 2 or 4 */
    uint32_t firstDraw;
    uint32_t drawCount;
} XgcDrawBatch;

typedef struct XgcDrawStats {
    uint32_t size;
    uint32_t instances; /* drawn, whole or in part */
    uint64_t triangles;
    uint32_t changedPatches;    /* of mixed instances: got another level */
    uint32_t reboundPatches;    /* of mixed instances: got another index range, built or found */
    uint32_t deferredInstances; /* are not drawn as selected: staging, copies or arena were full */
    uint32_t reserved;
} XgcDrawStats;

/* For scenes of the same capacities, or smaller ones. */
XGC_API XgcStatus xgcDrawListCreate(const XgcSceneConfig* scene, const XgcDrawListConfig* config, XgcDrawList** list);
XGC_API void xgcDrawListDestroy(XgcDrawList* list);
/* Brings the draws up to the selection, as far as staging and arena allow; within a frame of the cache, after the
 * selection's update from the same scene. The cache has the scene's assets by the scene's ids. Until it is cleared, a
 * list stays with one scene and one cache. What had to wait is no failure: see xgcDrawListRefusal. */
XGC_API XgcStatus xgcDrawListUpdate(XgcDrawList* list, const XgcScene* scene, const XgcSelection* selection,
                                    XgcIndexCache* cache);
/* Lets go of all ranges that belong to an asset, or to any. */
XGC_API XgcStatus xgcDrawListForgetAsset(XgcDrawList* list, uint32_t asset);
XGC_API XgcStatus xgcDrawListClear(XgcDrawList* list);

/* Valid until the next update. Null, and a count of 0, for null. */
XGC_API const XgcDrawCommand* xgcDrawListDraws(const XgcDrawList* list, uint32_t* count);
XGC_API const XgcDrawSource* xgcDrawListSources(const XgcDrawList* list, uint32_t* count);
/* By material. */
XGC_API const XgcDrawBatch* xgcDrawListBatches(const XgcDrawList* list, uint32_t* count);
/* Ids of instances of the scene. */
XGC_API const uint32_t* xgcDrawListInstances(const XgcDrawList* list, uint32_t* count);
/* How an instance is drawn; the pointers stay valid until the next update. */
XGC_API XgcStatus xgcDrawListInstance(const XgcDrawList* list, uint32_t instance, XgcInstanceLevels* out);
XGC_API XgcStatus xgcDrawListStats(const XgcDrawList* list, XgcDrawStats* stats);
/* Why the latest update deferred instances: the last refusal, or ok. It is not logged. */
XGC_API XgcStatus xgcDrawListRefusal(const XgcDrawList* list, XgcStatus* refusal);

#ifdef __cplusplus
}
#endif

#endif
