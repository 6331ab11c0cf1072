#pragma once

#include <xgc/bake/asset_writer.h>
#include <xgc/format.h>

#include <glm/vec3.hpp>

// The steps of `layOutAsset`. Each is a function of the mesh, its hierarchy and the results of the steps before:
// domains -> faces (lists, order) -> rows (order of the vertices) -> slots (parents, corners), and beside
// them bounds, parts and the attribute streams.

namespace xgc::bake::layout {

/// Vertices by the levels to which they, or any that collapse into them, live.
struct Tiers {
    std::vector<uint8_t> of;           ///< a position each; 0: the coarsest
    std::vector<uint32_t> firstLevels; ///< a tier each, falling to 0: from there on vertices of finer tiers are gone
    uint32_t count() const { return uint32_t(firstLevels.size()); }
};
/// One vertex in `ratio` lives on into the next coarser tier.
Tiers findTiers(const Hierarchy& hierarchy, const std::vector<uint8_t>& used, uint32_t ratio, uint32_t mostTiers);

/// Domains of two patches or more in the file's order, each cut into up to four by the levels to which its vertices
/// live, or by the tiers of the pages. A domain of one patch has its rows in that patch's interior, but for those of
/// coarser pages.
struct Domains {
    std::vector<std::vector<uint32_t>> sets; ///< equal ones where a domain is cut
    std::vector<uint8_t> tiers;              ///< of the pages
    /// Per position its *group*: an index in `sets`, or sets.size() + patch. kNone where no face uses it.
    std::vector<uint32_t> groupOf;
    std::vector<std::vector<uint32_t>> ofPatch; ///< rising
};

/// Wedges that a corner of a face, or a parent up from one, refers to: 1, else 0.
std::vector<uint8_t> usedWedges(const Mesh& mesh, const Hierarchy& hierarchy);
Domains orderDomains(const Hierarchy& hierarchy, const std::vector<uint8_t>& used, const Tiers* pages);

/// What a patch draws in the uniform state of a level, in order.
struct FacesOfLevel {
    uint32_t level = 0;
    std::vector<glm::uvec3> triangles; ///< wedges
};

/// Faces patch by patch, ordered for the vertex cache.
struct Faces {
    std::vector<uint32_t> order;                  ///< mesh faces, as the patches' first lists hold them
    std::vector<uint32_t> firstFace;              ///< per patch, and the end
    std::vector<std::vector<FacesOfLevel>> lists; ///< per patch, rising levels, the first of level 0
    std::vector<uint32_t> levelFaceCounts;        ///< triangles of the uniform states
    std::vector<uint32_t> patchFaceCounts;        ///< patch * levelCount + level: likewise
};
/// A list begins where each tier of `pages` does, if there are any.
Faces orderFaces(const Mesh& mesh, const Hierarchy& hierarchy, const Tiers* pages);

/// Vertex rows group by group.
struct Rows {
    std::vector<uint32_t> wedgeOf; ///< per row
    std::vector<uint32_t> rowOf;   ///< per wedge; kNone where it has none
    std::vector<format::VertexRange> ranges;
};
Rows orderRows(const Mesh& mesh, const Hierarchy& hierarchy, const Domains& domains, const Faces& faces);

/// Parents and corners as slots of their patches, 16 or 32 bits wide by patch.
struct Slots {
    struct PatchRun {
        uint32_t slotCount = 0;
        uint32_t firstParent = 0;
        uint32_t firstCorner = 0;
        bool wide = false;
    };
    std::vector<PatchRun> patches;
    std::vector<uint32_t> patchSlots; ///< first slot of each domain of each patch
    std::vector<uint16_t> parentsNarrow, cornersNarrow;
    std::vector<uint32_t> parentsWide, cornersWide;
};
Slots numberSlots(const Hierarchy& hierarchy, const Domains& domains, const Faces& faces, const Rows& rows);

struct Sphere {
    glm::vec3 center{0};
    float radius = 0;
};
struct Bounds {
    glm::vec3 low{0}, high{0};
    Sphere sphere;
};
/// A box, and a sphere with a small radius, around points. Rounded outwards.
Bounds boundsOf(std::span<const glm::vec3> points);
/// Around all that a patch can draw in any state. `scratch`: one entry a wedge, zero before the first call.
Bounds boundsOfPatch(const Mesh& mesh, const Hierarchy& hierarchy, std::span<const uint32_t> faces, uint32_t patch,
                     std::vector<uint32_t>& scratch);

struct Cone {
    glm::vec3 axis{0, 0, 1};
    float cosine = -1; ///< -1: no cone
    uint32_t level = 0;
};
/// A cone around the normals of all that the patch can draw at levels up to the cone's.
Cone coneOfPatch(const Mesh& mesh, const Hierarchy& hierarchy, std::span<const uint32_t> faces);

struct PartFigures {
    uint32_t faceCount = 0;
    double area = 0;
    glm::dvec3 centroid{0};
    std::vector<uint32_t> neighbours; ///< parts that share an edge, rising
    std::vector<float> contours;      ///< length of the edges shared with each of those
};
std::vector<PartFigures> measureParts(const Mesh& mesh, const Segmentation& parts);

/// Boxes of the parts along the principal axes of their area, and what `parts.merges` says of each.
std::vector<format::PartShape> shapesOfParts(const Mesh& mesh, const Segmentation& parts,
                                             std::span<const PartFigures> figures);

/// Collects sections and streams, and joins them into the bytes of a file.
class FileBuilder {
public:
    template <typename T>
    void section(format::SectionId id, std::span<const T> elements) {
        addSection(id, std::as_bytes(elements), uint32_t(elements.size()), sizeof(T));
    }
    template <typename T>
    void stream(format::StreamKind kind, format::StreamFormat format, uint32_t set, std::span<const T> elements) {
        addStream(kind, format, set, std::as_bytes(elements), uint32_t(elements.size()), sizeof(T));
    }
    /// What a codec made of a section or stream of another file; its figures but codec and stored bytes stay.
    void codedSection(const format::SectionRecord& record, format::Codec codec, std::span<const std::byte> stored);
    void codedStream(const format::StreamRecord& record, format::Codec codec, std::span<const std::byte> stored);
    /// Streams belong to the page that was begun last; where none was, to one with all levels.
    void beginPage(uint32_t tier, uint32_t group, uint32_t firstLevel, uint32_t lastLevel);
    /// Sections, and streams of a page, may come in any order; empty ones are left out.
    void finish(uint32_t levelCount, std::vector<std::byte>& out);

private:
    struct Section {
        format::SectionRecord record;
        std::vector<std::byte> bytes;
    };
    struct Stream {
        format::StreamRecord record;
        std::vector<std::byte> bytes;
        size_t page;
    };
    size_t page() const { return pages_.empty() ? 0 : pages_.size() - 1; }
    std::vector<format::StreamRecord> placeStreams();
    void addSection(format::SectionId id, std::span<const std::byte> bytes, uint32_t count, uint32_t stride);
    void addStream(format::StreamKind kind, format::StreamFormat format, uint32_t set, std::span<const std::byte> bytes,
                   uint32_t count, uint32_t stride);

    std::vector<Section> sections_;
    std::vector<Stream> streams_;
    std::vector<format::PageRecord> pages_;
};

/// Adds the streams that a renderer uploads.
void addVertexStreams(const Hierarchy& hierarchy, const Rows& rows, FileBuilder& file);

/// Adds what lets an asset be posed, where the mesh has skins or morph targets: joints, displacements, and their bounds
/// and errors a patch. Writes the records' runs of joints.
void addPose(const Mesh& mesh, const Hierarchy& hierarchy, const Faces& faces, const Rows& rows,
             const PatchErrors& errors, std::span<const format::Text> targetNames,
             std::span<format::PatchRecord> records, FileBuilder& file);

/// XXH64 with seed 0.
uint64_t hash(std::span<const std::byte> bytes);

} // namespace xgc::bake::layout
