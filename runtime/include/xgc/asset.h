#pragma once

#include <xgc/format.h>
#include <xgc/status.h>

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace xgc {

/// A vertex stream as the file holds it: `count` elements of `format`, `stride` bytes apart.
struct VertexStream {
    format::StreamKind kind{};
    format::StreamFormat format{};
    uint32_t set = 0;
    uint32_t stride = 0;
    uint32_t count = 0;
    std::span<const std::byte> bytes;
};

/// Where the parents and the corners lie that one tier of a patch adds (residency.h).
struct PatchPlace {
    const std::byte* parents = nullptr; ///< u16 or u32, of `firstSlot` and on
    const std::byte* corners = nullptr; ///< likewise, of the lists of the tier's levels
    uint32_t firstSlot = 0;
};

/// How much of a streamed asset is in memory; changes between frames (residency.h).
struct Residence {
    std::span<const PatchPlace> places;    ///< patch * tierCount + tier
    std::span<const uint8_t> tierCounts;   ///< a patch each: tiers of it that can be read
    std::span<const uint8_t> finestLevels; ///< a patch each: no state may have it finer
    std::span<const uint32_t> stamps;      ///< a patch each: another one where its index lists may name other rows
};

/// An opened asset: spans into the bytes that were opened, which must outlive it. Copying it copies
/// no data. All of it is immutable, so any number of threads may read one view.
///
/// Everything in it was checked once by `open`: counts, ranges, orders and indices are safe to use
/// without further tests (FORMAT.md lists the invariants).
struct AssetView {
    static constexpr uint32_t kMaxVertexStreams = 16;

    std::span<const std::byte> bytes;
    const format::AssetRecord* record = nullptr;
    std::span<const format::LevelRecord> levels;
    std::span<const format::DomainRecord> domains;
    std::span<const uint32_t> domainPatches;
    std::span<const format::VertexRange> vertexRanges;
    std::span<const format::PatchRecord> patches;
    std::span<const uint32_t> patchDomains;
    std::span<const uint32_t> patchSlots;        ///< beside patchDomains: first slot of the domain in the patch
    std::span<const float> patchErrors;          ///< patch * levelCount + level, mesh units
    std::span<const uint32_t> patchFaceCounts;   ///< likewise: triangles in uniform states; may be empty
    std::span<const format::FaceList> faceLists; ///< patch * listCount + list
    std::span<const format::PartRecord> parts;
    std::span<const uint32_t> partNeighbours;
    std::span<const float> contours;               ///< beside partNeighbours, mesh units; empty where the file has none
    std::span<const format::PartShape> partShapes; ///< a part each; empty where the file has none
    std::span<const format::MergeRecord> merges;   ///< empty where no parts join (parts.h)
    std::span<const format::MaterialRecord> materials;
    std::span<const float> alphaCutoffs; ///< a material each; empty where all have the usual one
    std::span<const format::NodeRecord> nodes;
    // Of assets that can be posed (skin.h); else empty.
    std::span<const format::JointRecord> joints;
    std::span<const format::PatchJoint> patchJoints;
    std::span<const format::SkinError> skinErrors; ///< patch * levelCount + level
    std::span<const format::MorphTargetRecord> morphTargets;
    std::span<const uint32_t> morphRows; ///< first of morphDeltas for each row, and the end
    std::span<const format::MorphDelta> morphDeltas;
    std::span<const float> morphReach;  ///< patch * targets + target, mesh units
    std::span<const float> morphErrors; ///< (patch * levelCount + level) * targets + target, mesh units
    std::string_view strings;
    std::span<const format::PageRecord> pages;
    std::span<const format::StreamRecord> streams;
    std::span<const uint32_t> patchPages;                ///< patch * tierCount + tier; empty where there is one tier
    std::array<uint8_t, format::kMaxTiers> tierLevels{}; ///< finest level of each tier, falling to 0
    std::string_view provenance;                         ///< JSON; empty where the file has none

    // Filled when pages are installed (`openAll`).
    std::span<const glm::vec3> positions;    ///< a vertex row each
    std::span<const uint8_t> collapseLevels; ///< a vertex row each
    std::span<const uint8_t> birthLevels;    ///< a vertex row each, or empty
    std::span<const uint16_t> parentsNarrow; ///< PatchRecord::firstParent + slot
    std::span<const uint32_t> parentsWide;
    std::span<const uint16_t> cornersNarrow; ///< PatchRecord::firstCorner + 3 * face + corner
    std::span<const uint32_t> cornersWide;
    std::array<VertexStream, kMaxVertexStreams> vertexStreams; ///< what a renderer uploads, position first
    uint32_t vertexStreamCount = 0;

    /// Of a Residency's view, where rows are those of its pool; else null.
    const Residence* residence = nullptr;

    uint32_t levelCount() const { return record->levelCount; }
    uint32_t patchCount() const { return record->patchCount; }
    std::string_view text(format::Text t) const { return strings.substr(t.offset, t.bytes); }
    uint32_t tierCount() const { return record->tierCount; }
    /// The tier whose pages a level needs, with those of the tiers before it.
    uint32_t tierOf(uint32_t level) const {
        uint32_t tier = 0;
        while (tier + 1 < record->tierCount && level < tierLevels[tier]) ++tier;
        return tier;
    }
    /// Finest level at which a patch may be in a state: 0 but in streamed assets.
    uint32_t finestLevel(uint32_t patch) const { return residence ? residence->finestLevels[patch] : 0; }
    /// Alpha below which an alpha-tested material is not there: glTF's default where the file has none.
    float alphaCutoff(uint32_t material) const { return alphaCutoffs.empty() ? 0.5f : alphaCutoffs[material]; }
    /// E of a patch at a level, mesh units.
    float error(uint32_t patch, uint32_t level) const {
        return patchErrors[size_t(patch) * record->levelCount + level];
    }
    std::span<const uint32_t> domainsOf(uint32_t patch) const {
        return patchDomains.subspan(patches[patch].firstDomain, patches[patch].domainCount);
    }
    /// Joints that move a patch; none where the asset has no skins.
    std::span<const format::PatchJoint> jointsOf(uint32_t patch) const {
        if (joints.empty()) return {};
        return patchJoints.subspan(patches[patch].firstJoint, patches[patch].jointCount);
    }
    /// Face lists of a patch, the finest first.
    std::span<const format::FaceList> listsOf(uint32_t patch) const {
        return faceLists.subspan(size_t(patch) * record->listCount, record->listCount);
    }
    /// First slot of each of those domains.
    std::span<const uint32_t> domainSlotsOf(uint32_t patch) const {
        return patchSlots.subspan(patches[patch].firstDomain, patches[patch].domainCount);
    }
    std::span<const uint32_t> patchesOf(uint32_t domain) const {
        return domainPatches.subspan(domains[domain].firstPatch, domains[domain].patchCount);
    }
    /// Parts that share an edge with a part.
    std::span<const uint32_t> neighboursOf(uint32_t part) const {
        return partNeighbours.subspan(parts[part].firstNeighbour, parts[part].neighbourCount);
    }
    /// Length of the contour with each of those, mesh units; empty where the file has none.
    std::span<const float> contoursOf(uint32_t part) const {
        if (contours.empty()) return {};
        return contours.subspan(parts[part].firstNeighbour, parts[part].neighbourCount);
    }
    /// Vertex rows of a domain, and of a patch's interior.
    format::VertexRange domainRange(uint32_t domain) const { return vertexRanges[domain]; }
    format::VertexRange interiorRange(uint32_t patch) const {
        return vertexRanges[size_t(record->domainCount) + patch];
    }
};

/// Checks and opens the tables of an asset: memory safety and one genealogy for all patches (ranges,
/// orders, inclusion of domains, capacities), not the truth of errors, bounds and face lists, which is the
/// tool's `verify`.
///
/// `bytes`: at least FileHeader::tableBytes of the file, aligned to format::kAlignment, kept alive
/// by the caller. One pass over what it reads; no allocation, no exception. On failure `out` is
/// untouched and the status names the element.
Status openTables(std::span<const std::byte> bytes, AssetView& out);

/// `openTables`, and checks and installs every page, in place. `bytes` is the whole uncompressed
/// file, of one tier: those that are cut into pages are streamed (residency.h), or joined by `xgc::decode`. Same
/// contract.
Status openAll(std::span<const std::byte> bytes, AssetView& out);

} // namespace xgc
