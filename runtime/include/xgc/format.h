#pragma once

#include <array>
#include <cstdint>

/// The structs of an `.xgc` file, byte for byte. FORMAT.md states their meaning and invariants; a
/// change here bumps kVersion and edits that page. All fields are little-endian.
namespace xgc::format {

inline constexpr std::array<unsigned char, 8> kMagic = {'X', 'G', 'C', '\r', '\n', 0x1a, '\n', 0};
inline constexpr uint32_t kVersion = 2;
/// Sections and pages start at multiples of this, and so must the bytes given to `open`.
inline constexpr uint32_t kAlignment = 64;
/// "No such element" in u32 fields.
inline constexpr uint32_t kNone = 0xffffffffu;
/// A collapse level, or the level of a face list, that no state reaches.
inline constexpr uint8_t kNever = 255;
/// Levels 0..K with K + 1 <= kMaxLevels, so that every level is below kNever.
inline constexpr uint32_t kMaxLevels = 254;
inline constexpr uint32_t kMaxFaceLists = 16;
inline constexpr uint32_t kMaxTiers = 8;

enum class SectionId : uint32_t {
    asset = 1,           ///< one AssetRecord
    levels = 2,          ///< LevelRecord[levelCount]
    domains = 4,         ///< DomainRecord[domainCount], parents' before children's
    domainPatches = 5,   ///< u32[]: patches of each domain, rising
    vertexRanges = 6,    ///< VertexRange[(domainCount + patchCount) * tierCount]
    patches = 7,         ///< PatchRecord[patchCount], by part
    patchDomains = 8,    ///< u32[]: domains of each patch, rising; d is listed by p where p is in d's patches
    patchErrors = 9,     ///< f32[patchCount * levelCount]
    faceLists = 10,      ///< FaceList[patchCount * listCount]
    parts = 11,          ///< PartRecord[partCount]
    partNeighbours = 12, ///< u32[]: adjacent parts of each part, rising
    materials = 13,      ///< MaterialRecord[materialCount], at least one
    nodes = 14,          ///< NodeRecord[nodeCount], parents first; may be absent
    strings = 15,        ///< UTF-8, no terminators
    pages = 16,          ///< PageRecord[]
    streams = 17,        ///< StreamRecord[]
    patchSlots = 18,     ///< u32[]: beside patchDomains, times tierCount: first slot of the domain in the patch
    // Optional: a reader skips ids that it does not know, and opens files without them.
    mergeTree = 64,    ///< MergeRecord[]: how parts would join, in order; needs partShapes
    contours = 65,     ///< f32[]: beside partNeighbours: length of the contour between the two, mesh units
    morphTargets = 66, ///< MorphTargetRecord[]: blend shapes; needs morphRows, morphReach and morphErrors
    skins = 67,        ///< JointRecord[]: what rows' joints name; needs streams joints and weights, and patchJoints
    locks = 68,
    provenance = 69,      ///< UTF-8 JSON: settings, hash of the input, version of the tool (written by version 2)
    partShapes = 71,      ///< PartShape[partCount]
    patchFaceCounts = 72, ///< u32[patchCount * levelCount]: triangles of a patch in the uniform state of a level
    patchPages = 73,      ///< u32[patchCount * tierCount]: the page of each patch and tier; in files of several tiers
    patchJoints = 74,     ///< PatchJoint[]: joints of each patch, rising
    skinErrors = 75,      ///< SkinError[patchCount * levelCount]; with skins
    morphRows = 76,       ///< u32[vertexCount + 1]: first of morphDeltas for each row, and the end
    morphDeltas = 77,     ///< MorphDelta[]
    morphReach = 78,      ///< f32[patchCount * targets]: longest displacement in the patch, mesh units
    morphErrors = 79,     ///< f32[patchCount * levelCount * targets]: how much displacements change, mesh units
    alphaCutoffs = 80,    ///< f32[materialCount]: alpha below which an alpha-tested material is not there
};

/// How a section or stream lies in the file (FORMAT.md, "Codecs"). `open` reads none alone; xgc::load decodes the
/// others.
enum class Codec : uint32_t {
    none = 0,
    zstd = 1,    ///< a zstd frame
    meshopt = 2, ///< reserved
    rows = 3,    ///< vertex streams: RowsHeader, then a zstd frame of differences to the parent rows
    faces = 4,   ///< corners: FacesHeader, then a zstd frame of codes
    parents = 5, ///< parents: a zstd frame of distances
};

struct FileHeader {
    unsigned char magic[8];
    uint32_t version;
    uint32_t sectionCount;
    uint64_t fileBytes;
    uint64_t tableBytes;     ///< header, section table and all sections: pages follow
    uint64_t headerChecksum; ///< XXH64, seed 0, of header and section table with this field zero
    uint32_t flags;          ///< 0 in version 2
    uint32_t reserved[5];
};
static_assert(sizeof(FileHeader) == 64);

struct SectionRecord {
    SectionId id;
    Codec codec;
    uint64_t offset;      ///< from the start of the file
    uint64_t storedBytes; ///< in the file
    uint64_t rawBytes;    ///< after decoding
    uint64_t checksum;    ///< XXH64, seed 0, of the stored bytes
    uint32_t count;       ///< elements
    uint32_t stride;      ///< bytes an element
};
static_assert(sizeof(SectionRecord) == 48);

enum AssetFlags : uint32_t {
    kErrorIsEstimate = 1u << 0, ///< E is a guess, not a bound
    kInputIsClosed = 1u << 1,   ///< every edge of level 0 is used an even number of times
};

struct AssetRecord {
    uint32_t levelCount;     ///< K + 1
    uint32_t listCount;      ///< face lists of a patch, those that it leaves empty included
    uint32_t tierCount;      ///< 1: one page with everything; more: a file for streaming
    uint32_t pageGroupCount; ///< 1, or the pages of the tier that has most
    uint32_t domainCount;
    uint32_t patchCount;
    uint32_t partCount;
    uint32_t materialCount;
    uint32_t nodeCount;
    uint32_t vertexCount;     ///< vertex rows (wedges), made ones included
    uint32_t baseVertexCount; ///< rows of level 0
    uint32_t positionCount;   ///< distinct positions of level 0
    uint32_t faceCount;       ///< triangles of level 0
    uint32_t maxPatchSlots;
    uint32_t maxPatchFaces;
    uint32_t flags; ///< AssetFlags
    float boundsMin[3];
    float boundsMax[3];
    float sphereCenter[3];
    float sphereRadius;
    float positionStep;    ///< positions of level 0 are the input's, snapped to multiples of it; 0: as they were
    uint32_t laidOutTiers; ///< 0, or the tiers that the domains tell of and that the file is, or may be, cut into
    uint32_t reserved[4];
};
static_assert(sizeof(AssetRecord) == 128);

struct LevelRecord {
    float threshold;    ///< error threshold that the builder worked to, mesh units; 0 where it has none
    float maxError;     ///< largest E of the level, mesh units
    uint32_t faceCount; ///< triangles of the uniform state
    uint32_t reserved;
};
static_assert(sizeof(LevelRecord) == 16);

struct DomainRecord {
    uint32_t firstPatch; ///< in domainPatches
    uint32_t patchCount; ///< at least 1; version 2 keeps rows of one patch in its interior and writes 2 or more
    uint32_t pageGroup;  ///< 0
    uint32_t tier;       ///< of its rows; interiors are of the last one. Never falls from domain to domain
};
static_assert(sizeof(DomainRecord) == 16);

/// Rows of one domain or of one patch's interior in one tier. Entry g * tierCount + tier, where g
/// counts the domains and then the patches. Together the ranges tile the vertex rows.
struct VertexRange {
    uint32_t first;
    uint32_t count;
};
static_assert(sizeof(VertexRange) == 8);

enum PatchFlags : uint32_t {
    kWideSlots = 1u << 0, ///< slots are u32 (more than 65,536 of them), else u16
};

struct PatchRecord {
    uint32_t part;
    uint32_t material;
    uint32_t firstDomain; ///< in patchDomains
    uint32_t domainCount;
    uint32_t slotCount;       ///< vertices of its domains in list order, then of its interior
    uint32_t faceCount;       ///< at level 0
    uint32_t listedFaceCount; ///< of all its face lists together
    uint32_t firstCorner;     ///< in the narrow or wide corner stream, three a listed face
    uint32_t firstParent;     ///< in the narrow or wide parent stream, one a slot
    uint32_t pageGroup;       ///< 0
    uint32_t flags;           ///< PatchFlags
    float boxMin[3];          ///< contains the patch in every state, mesh space
    float boxMax[3];
    float sphereCenter[3]; ///< likewise
    float sphereRadius;
    float coneAxis[3]; ///< unit; face normals n of the patch have dot(n, axis) >= coneCosine ...
    float coneCosine;  ///< ... at its levels <= coneLevel, whatever its neighbours do; -1 where there is no cone
    uint32_t coneLevel;
    uint32_t firstJoint; ///< in patchJoints; of an asset without skins 0
    uint32_t jointCount;
    uint32_t reserved[4];
};
static_assert(sizeof(PatchRecord) == 128);

/// What a patch draws with all patches at one level, which holds all that it can draw where none of its groups is at a
/// finer one. Entry patch * listCount + list; the lists of a patch follow one another in the corner stream.
struct FaceList {
    uint32_t level; ///< kNever: empty, and so are those behind it
    uint32_t faceCount;
};
static_assert(sizeof(FaceList) == 8);

struct Text {
    uint32_t offset; ///< in strings
    uint32_t bytes;
};

struct PartRecord {
    uint64_t stableId; ///< XXH64 of the name: the same over bakes that keep the name
    Text name;
    uint32_t firstPatch;
    uint32_t patchCount;
    uint32_t firstNeighbour; ///< in partNeighbours
    uint32_t neighbourCount;
    uint32_t faceCount;
    float importance; ///< 1 by default; larger asks for finer levels
    float area;
    float centroid[3];
    uint32_t reserved[2];
};
static_assert(sizeof(PartRecord) == 64);

/// What a part looks like, and when it joins another.
struct PartShape {
    float boxCenter[3];
    float boxAxes[3][3]; ///< unit vectors at right angles, right-handed, along the longest side first
    float boxHalfSizes[3];
    float salience;    ///< how strongly it stands out: cost of the first merge that it is in, at most 1; 1: of none
    uint32_t joinedBy; ///< merge in which it joins another; kNone: it stays to the end
    uint32_t reserved[3];
};
static_assert(sizeof(PartShape) == 80);

/// One step of joining parts: `b` joins `a`, a lower one, which stands for both from then on.
struct MergeRecord {
    uint32_t a;
    uint32_t b;
    float cost; ///< how much is lost: about .5 and more where people see two parts
    uint32_t reserved;
};
static_assert(sizeof(MergeRecord) == 16);

enum MaterialFlags : uint32_t { kDoubleSided = 1u << 0, kAlphaMask = 1u << 1, kAlphaBlend = 1u << 2 };

struct MaterialRecord {
    Text name;
    float baseColor[4]; ///< linear
    float metallic;
    float roughness;
    float emissive[3]; ///< linear
    uint32_t flags;    ///< MaterialFlags
};
static_assert(sizeof(MaterialRecord) == 48);

/// A node of the source scene, by name. Geometry is flattened into one space already: the transform
/// tells where a node stood, for attaching things.
struct NodeRecord {
    Text name;
    uint32_t parent; ///< kNone for roots
    uint32_t reserved;
    float toMesh[16]; ///< column-major, node space to mesh space
};
static_assert(sizeof(NodeRecord) == 80);

/// A joint that moves rows: a node, and where it stood when the rows were bound to it. In a pose that puts the node at
/// `toMesh`, the joint takes mesh space to mesh space by toMesh * inverseBind.
struct JointRecord {
    uint32_t node;
    float inverseBind[12]; ///< column-major, four columns of three: affine
    uint32_t reserved[3];
};
static_assert(sizeof(JointRecord) == 64);

/// A joint that moves rows of a patch, and a sphere around all of those that it moves, in any state.
struct PatchJoint {
    uint32_t joint;
    float center[3]; ///< mesh space, unposed
    float radius;
    uint32_t reserved[3];
};
static_assert(sizeof(PatchJoint) == 32);

/// By how much what a level draws of a patch differs in what joints do to it: at a point v of level 0 and the point y
/// of the drawn surface nearest to it, summed over the joints; c is the centre of the patch's sphere.
struct SkinError {
    float weight; ///< |w(v) - w(y)|
    float moment; ///< |w(v) (v - c) - the same at y, interpolated over y's triangle|, mesh units
};
static_assert(sizeof(SkinError) == 8);

struct MorphTargetRecord {
    Text name;
    uint32_t reserved[2];
};
static_assert(sizeof(MorphTargetRecord) == 16);

/// What one target adds to one row at weight 1.
struct MorphDelta {
    uint32_t target;
    float position[3];
    float normal[3];
};
static_assert(sizeof(MorphDelta) == 28);

/// A run of bytes that is loaded as a whole: what a range of levels (tier 0 is the coarsest) adds to a group of
/// patches. Files of one tier have one page with everything.
struct PageRecord {
    uint32_t tier;
    uint32_t group;      ///< counts the pages of the tier
    uint32_t firstLevel; ///< finest level that it serves
    uint32_t lastLevel;  ///< coarsest
    uint64_t offset;
    uint64_t storedBytes;
    uint64_t rawBytes;
    uint64_t checksum; ///< XXH64, seed 0, of the stored bytes
    Codec codec;
    uint32_t firstStream;
    uint32_t streamCount;
    uint32_t reserved;
};
static_assert(sizeof(PageRecord) == 64);

/// A reader skips kinds that it does not know.
enum class StreamKind : uint32_t {
    // one element a vertex row
    position = 1,
    normal = 2,
    tangent = 3, ///< w: handedness
    uv = 4,
    color = 5,
    joints = 6,
    weights = 7,
    collapseLevel = 8, ///< u8, falling within each vertex range
    birthLevel = 9,    ///< u8, rows made by the builder only; absent where there are none
    // one element a slot of a patch
    parentNarrow = 16, ///< u16
    parentWide = 17,   ///< u32
    // three elements a listed face
    cornerNarrow = 18, ///< u16
    cornerWide = 19,   ///< u32
};

enum class StreamFormat : uint32_t {
    u8 = 1,
    u16 = 2,
    u32 = 3,
    f32x2 = 4,
    f32x3 = 5,
    f32x4 = 6,
    unorm8x4 = 7,
    u16x4 = 8,
    snorm16x2 = 9, ///< octahedral unit vector
    snorm16x4 = 10,
};

struct StreamRecord {
    StreamKind kind;
    StreamFormat format;
    uint32_t set; ///< UV, colour, joint sets count from 0
    Codec codec;
    uint64_t offset; ///< from the start of the page
    uint64_t storedBytes;
    uint64_t rawBytes;
    uint32_t firstElement; ///< 0
    uint32_t count;
    uint32_t stride;
    uint32_t reserved[3];
};
static_assert(sizeof(StreamRecord) == 64);

/// What the lanes of a stream of Codec::rows are made of.
enum class RowTransform : uint32_t {
    none = 0,   ///< the lanes as they are
    floats = 1, ///< bits of floats, turned so that they are ordered as the floats are
    grid = 2,   ///< floats that are integers (32 bits, signed) times 2^parameter
    snorm = 3,  ///< snorm16 of `parameter` bits (8..15), widened to 16 by repeating them
};

/// Before the zstd frame of a stream of Codec::rows.
struct RowsHeader {
    RowTransform transform;
    int32_t parameter;
    uint32_t planes;  ///< low bytes stored of each lane's difference; the others are zero
    uint32_t base[4]; ///< the first row
};
static_assert(sizeof(RowsHeader) == 28);

enum FacesFlags : uint32_t {
    kRotations = 1u << 0, ///< a byte a face tells its first corner; else that is the lowest slot
};

/// Before the zstd frame of a stream of Codec::faces.
struct FacesHeader {
    uint32_t flags;      ///< FacesFlags
    uint32_t missCount;  ///< faces that share no recent edge
    uint32_t farCount;   ///< corners that are no recent vertex
    uint32_t strayCount; ///< slots that lie in no run
    uint32_t runBytes;   ///< of the table of runs
};
static_assert(sizeof(FacesHeader) == 20);

} // namespace xgc::format
