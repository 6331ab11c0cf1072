#include "open.h"

#include <algorithm>
#include <cmath>
#include <functional>

// Arrays that are cut into runs (domains into patches, parts into patches, ...) must be cut without gap or overlap
// and to the end: a running sum is then all that it takes to know that every range is valid.

namespace xgc {
namespace {

using namespace format;

bool finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool rising(std::span<const uint32_t> values) {
    return std::adjacent_find(values.begin(), values.end(), [](uint32_t a, uint32_t b) { return a >= b; }) ==
           values.end();
}

bool allBelow(std::span<const uint32_t> values, uint32_t end) {
    return std::all_of(values.begin(), values.end(), [&](uint32_t v) { return v < end; });
}

Status checkCounts(const AssetView& v) {
    const AssetRecord& r = *v.record;
    if (r.tierCount == 0 || r.tierCount > kMaxTiers || r.pageGroupCount == 0)
        return corrupt("tier or page count out of range", r.tierCount);
    if (v.patchPages.size() != (r.tierCount > 1 ? uint64_t(r.patchCount) * r.tierCount : 0))
        return corrupt("section patchPages has another count than patches times tiers");
    if (r.levelCount == 0 || r.levelCount > kMaxLevels) return corrupt("level count out of range", r.levelCount);
    if (r.listCount == 0 || r.listCount > kMaxFaceLists) return corrupt("face list count out of range", r.listCount);
    if (r.materialCount == 0 || r.partCount == 0 || r.patchCount == 0)
        return corrupt("the asset has no material, part or patch");
    if (v.levels.size() != r.levelCount) return corrupt("section levels has another count than the asset");
    if (v.domains.size() != r.domainCount) return corrupt("section domains has another count than the asset");
    if (v.patches.size() != r.patchCount) return corrupt("section patches has another count than the asset");
    if (v.parts.size() != r.partCount) return corrupt("section parts has another count than the asset");
    if (v.materials.size() != r.materialCount) return corrupt("section materials has another count than the asset");
    if (v.nodes.size() != r.nodeCount) return corrupt("section nodes has another count than the asset");
    if (v.vertexRanges.size() != uint64_t(r.domainCount) + r.patchCount)
        return corrupt("section vertexRanges has another count than domains and patches");
    if (v.patchErrors.size() != uint64_t(r.patchCount) * r.levelCount)
        return corrupt("section patchErrors has another count than patches times levels");
    if (v.faceLists.size() != uint64_t(r.patchCount) * r.listCount)
        return corrupt("section faceLists has another count than patches times lists");
    if (v.patchSlots.size() != v.patchDomains.size())
        return corrupt("section patchSlots has another count than patchDomains");
    if (r.baseVertexCount > r.vertexCount || r.positionCount > r.baseVertexCount)
        return corrupt("the asset has more base vertices or positions than vertex rows");
    if (!finite(r.boundsMin) || !finite(r.boundsMax) || !finite(r.sphereCenter) || !(r.sphereRadius >= 0) ||
        !std::isfinite(r.sphereRadius))
        return corrupt("bounds of the asset are not finite");
    return {};
}

Status checkLevels(const AssetView& v) {
    for (size_t i = 0; i < v.levels.size(); ++i) {
        const LevelRecord& level = v.levels[i];
        if (!std::isfinite(level.threshold) || !std::isfinite(level.maxError))
            return corrupt("level with an error that is not finite", i);
        if (level.faceCount > v.record->faceCount) return corrupt("level with more faces than the asset", i);
    }
    return {};
}

Status checkDomains(const AssetView& v) {
    uint64_t next = 0;
    for (uint32_t d = 0; d < v.domains.size(); ++d) {
        const DomainRecord& domain = v.domains[d];
        if (domain.firstPatch != next || domain.patchCount == 0 || domain.patchCount > v.domainPatches.size() - next)
            return corrupt("domain with a wrong run of patches", d);
        next += domain.patchCount;
        const std::span<const uint32_t> patches = v.patchesOf(d);
        if (!rising(patches) || patches.back() >= v.record->patchCount)
            return corrupt("domain with patches out of order or range", d);
        if (domain.pageGroup != 0) return corrupt("domain of a page group that is not there", d);
    }
    if (next != v.domainPatches.size()) return corrupt("section domainPatches holds more than the domains do");
    return {};
}

Status checkRanges(const AssetView& v) {
    uint64_t next = 0;
    for (uint64_t g = 0; g < v.vertexRanges.size(); ++g) {
        if (v.vertexRanges[g].first != next) return corrupt("vertex range that leaves a gap or overlaps", g);
        next += v.vertexRanges[g].count;
    }
    if (next != v.record->vertexCount) return corrupt("vertex ranges do not end at the vertex count");
    return {};
}

/// The domains of a patch, each of which lists the patch, and the slots of their rows.
Status checkPatchDomains(const AssetView& v, uint32_t p) {
    const std::span<const uint32_t> domains = v.domainsOf(p);
    if (!rising(domains) || !allBelow(domains, v.record->domainCount))
        return corrupt("patch with domains out of order or range", p);
    uint64_t slot = 0;
    for (size_t i = 0; i < domains.size(); ++i) {
        const std::span<const uint32_t> patches = v.patchesOf(domains[i]);
        if (!std::binary_search(patches.begin(), patches.end(), p))
            return corrupt("patch with a domain that does not list it", p);
        if (v.domainSlotsOf(p)[i] != slot) return corrupt("patch with a wrong first slot of a domain", p);
        slot += v.domainRange(domains[i]).count;
    }
    slot += v.interiorRange(p).count;
    if (slot != v.patches[p].slotCount) return corrupt("patch with another slot count than its vertex rows", p);
    return {};
}

Status checkFaceLists(const AssetView& v, uint32_t p) {
    const std::span<const FaceList> lists = v.listsOf(p);
    if (lists[0].level != 0 || lists[0].faceCount != v.patches[p].faceCount)
        return corrupt("patch whose first face list is not that of level 0", p);
    uint64_t faces = lists[0].faceCount;
    for (size_t i = 1; i < lists.size(); ++i) {
        const FaceList &list = lists[i], &before = lists[i - 1];
        const bool rises = list.level > before.level && list.level < v.record->levelCount;
        if (list.level != kNever && !rises) return corrupt("patch with face lists whose levels do not rise", p);
        const bool falls = list.faceCount <= before.faceCount;
        if (list.level == kNever ? list.faceCount != 0 : !falls) return corrupt("patch with face lists that grow", p);
        faces += list.faceCount;
    }
    if (faces != v.patches[p].listedFaceCount) return corrupt("patch with face lists that do not end at its count", p);
    return {};
}

Status checkPatchBounds(const AssetView& v, uint32_t p) {
    const PatchRecord& patch = v.patches[p];
    if (!finite(patch.boxMin) || !finite(patch.boxMax) || !finite(patch.sphereCenter) || !finite(patch.coneAxis) ||
        !std::isfinite(patch.sphereRadius) || !(patch.sphereRadius >= 0))
        return corrupt("patch with bounds that are not finite", p);
    if (!(patch.coneCosine >= -1 && patch.coneCosine <= 1) || patch.coneLevel >= v.record->levelCount)
        return corrupt("patch with a wrong normal cone", p);
    return {};
}

/// Where the runs of a patch must start.
struct PatchFirsts {
    uint64_t domain = 0, narrowFace = 0, wideFace = 0, narrowSlot = 0, wideSlot = 0;
};

Status checkPatchRuns(const AssetView& v, uint32_t p, PatchFirsts& next) {
    const PatchRecord& patch = v.patches[p];
    if (patch.flags & ~uint32_t(kWideSlots)) return unsupported("patch with unknown flags; update xgc", p);
    const bool wide = patch.flags & kWideSlots;
    if (!wide && patch.slotCount > 65536) return corrupt("patch with too many slots for 16 bits", p);
    if (patch.part >= v.record->partCount || patch.material >= v.record->materialCount)
        return corrupt("patch with a part or material that is not there", p);
    if (patch.pageGroup != 0) return corrupt("patch of a page group that is not there", p);
    if (patch.firstDomain != next.domain || patch.domainCount > v.patchDomains.size() - next.domain)
        return corrupt("patch with a wrong run of domains", p);
    uint64_t& nextFace = wide ? next.wideFace : next.narrowFace;
    uint64_t& nextSlot = wide ? next.wideSlot : next.narrowSlot;
    if (patch.firstCorner != 3 * nextFace || patch.firstParent != nextSlot)
        return corrupt("patch with a wrong first corner or parent", p);
    next.domain += patch.domainCount;
    nextFace += patch.listedFaceCount;
    nextSlot += patch.slotCount;
    return {};
}

Status checkPatches(const AssetView& v) {
    PatchFirsts next;
    uint32_t maxSlots = 0;
    uint64_t faces = 0, maxFaces = 0;
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        if (Status s = checkPatchRuns(v, p, next); !s.ok()) return s;
        if (Status s = checkPatchDomains(v, p); !s.ok()) return s;
        if (Status s = checkFaceLists(v, p); !s.ok()) return s;
        if (Status s = checkPatchBounds(v, p); !s.ok()) return s;
        maxSlots = std::max(maxSlots, v.patches[p].slotCount);
        maxFaces = std::max(maxFaces, uint64_t(v.patches[p].faceCount));
        faces += v.patches[p].faceCount;
    }
    if (next.domain != v.patchDomains.size()) return corrupt("section patchDomains holds more than the patches do");
    // Every pair of one side is in the other; equal counts make the two sides the same.
    if (v.patchDomains.size() != v.domainPatches.size()) return corrupt("a domain lists a patch that does not list it");
    if (faces != v.record->faceCount) return corrupt("the patches hold another count of faces than the asset");
    if (maxSlots != v.record->maxPatchSlots || maxFaces != v.record->maxPatchFaces)
        return corrupt("the asset's capacities are not those of its patches");
    if (3 * maxFaces > UINT32_MAX) return corrupt("a patch has more corners than 32 bits count");
    return {};
}

Status checkErrors(const AssetView& v) {
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        float before = 0;
        for (uint32_t level = 0; level < v.record->levelCount; ++level) {
            const float error = v.error(p, level);
            if (!std::isfinite(error) || !(error >= before)) return corrupt("patch with an error that falls", p);
            before = error;
        }
    }
    return {};
}

bool inStrings(const AssetView& v, Text text) {
    return uint64_t(text.offset) + text.bytes <= v.strings.size();
}

Status checkParts(const AssetView& v) {
    uint64_t nextPatch = 0, nextNeighbour = 0;
    for (uint32_t i = 0; i < v.parts.size(); ++i) {
        const PartRecord& part = v.parts[i];
        if (!inStrings(v, part.name)) return corrupt("part with a name past the strings", i);
        if (part.firstPatch != nextPatch || part.patchCount > v.patches.size() - nextPatch)
            return corrupt("part with a wrong run of patches", i);
        for (uint32_t p = 0; p < part.patchCount; ++p) {
            if (v.patches[nextPatch + p].part != i) return corrupt("patch that its part does not hold", nextPatch + p);
        }
        if (part.firstNeighbour != nextNeighbour || part.neighbourCount > v.partNeighbours.size() - nextNeighbour)
            return corrupt("part with a wrong run of neighbours", i);
        const std::span<const uint32_t> neighbours = v.partNeighbours.subspan(nextNeighbour, part.neighbourCount);
        if (!rising(neighbours) || !allBelow(neighbours, v.record->partCount))
            return corrupt("part with neighbours out of order or range", i);
        if (!std::isfinite(part.importance) || !(part.importance >= 0) || !std::isfinite(part.area) ||
            !finite(part.centroid))
            return corrupt("part with figures that are not finite", i);
        nextPatch += part.patchCount;
        nextNeighbour += part.neighbourCount;
    }
    if (nextPatch != v.patches.size()) return corrupt("the parts do not hold all patches");
    if (nextNeighbour != v.partNeighbours.size()) return corrupt("section partNeighbours holds more than the parts do");
    return {};
}

Status checkPartShapes(const AssetView& v) {
    if (!v.partShapes.empty() && v.partShapes.size() != v.parts.size())
        return corrupt("section partShapes has another count than the parts");
    for (uint32_t i = 0; i < v.partShapes.size(); ++i) {
        const PartShape& shape = v.partShapes[i];
        const bool axes = std::all_of(std::begin(shape.boxAxes), std::end(shape.boxAxes),
                                      [](const float(&axis)[3]) { return finite(axis); });
        if (!axes || !finite(shape.boxCenter) || !finite(shape.boxHalfSizes))
            return corrupt("part with a box that is not finite", i);
        if (std::any_of(std::begin(shape.boxHalfSizes), std::end(shape.boxHalfSizes), [](float s) { return s < 0; }))
            return corrupt("part with a box of a negative size", i);
        if (!(shape.salience >= 0 && shape.salience <= 1)) return corrupt("part with a salience outside 0..1", i);
        if (shape.joinedBy == kNone) continue;
        if (shape.joinedBy >= v.merges.size() || v.merges[shape.joinedBy].b != i)
            return corrupt("part that names a merge of another", i);
    }
    return {};
}

/// A part joins once at most, as it names the merge, and a lower one that stands for itself until then.
Status checkMerges(const AssetView& v) {
    if (!v.merges.empty() && v.partShapes.empty()) return corrupt("section mergeTree without partShapes");
    for (uint32_t i = 0; i < v.merges.size(); ++i) {
        const MergeRecord& merge = v.merges[i];
        if (merge.a >= merge.b || merge.b >= v.record->partCount)
            return corrupt("merge with parts out of order or range", i);
        if (v.partShapes[merge.b].joinedBy != i) return corrupt("merge of a part that joins in another", i);
        if (v.partShapes[merge.a].joinedBy <= i) return corrupt("merge into a part that has joined another", i);
        if (!std::isfinite(merge.cost) || !(merge.cost >= 0)) return corrupt("merge with a wrong cost", i);
    }
    return {};
}

Status checkFaceCounts(const AssetView& v) {
    const uint32_t levelCount = v.record->levelCount;
    if (v.patchFaceCounts.empty()) return {};
    if (v.patchFaceCounts.size() != uint64_t(v.record->patchCount) * levelCount)
        return corrupt("section patchFaceCounts has another count than patches times levels");
    for (uint32_t p = 0; p < v.record->patchCount; ++p) {
        const uint32_t* counts = v.patchFaceCounts.data() + size_t(p) * levelCount;
        const bool falling = std::is_sorted(counts, counts + levelCount, std::greater<>());
        if (counts[0] != v.patches[p].faceCount || !falling) return corrupt("patch with wrong counts of triangles", p);
    }
    return {};
}

Status checkContours(const AssetView& v) {
    if (!v.contours.empty() && v.contours.size() != v.partNeighbours.size())
        return corrupt("section contours has another count than partNeighbours");
    for (size_t i = 0; i < v.contours.size(); ++i) {
        if (!std::isfinite(v.contours[i]) || !(v.contours[i] >= 0)) return corrupt("contour of a wrong length", i);
    }
    return {};
}

Status checkMaterials(const AssetView& v) {
    for (uint32_t i = 0; i < v.materials.size(); ++i) {
        const MaterialRecord& m = v.materials[i];
        if (!inStrings(v, m.name)) return corrupt("material with a name past the strings", i);
        if (!finite(m.baseColor) || !finite(m.emissive) || !std::isfinite(m.metallic) || !std::isfinite(m.roughness))
            return corrupt("material with figures that are not finite", i);
    }
    if (!v.alphaCutoffs.empty() && v.alphaCutoffs.size() != v.materials.size())
        return corrupt("section alphaCutoffs has another count than the materials");
    for (uint32_t i = 0; i < v.alphaCutoffs.size(); ++i) {
        if (!std::isfinite(v.alphaCutoffs[i])) return corrupt("material with an alpha cutoff that is not finite", i);
    }
    return {};
}

Status checkNodes(const AssetView& v) {
    for (uint32_t i = 0; i < v.nodes.size(); ++i) {
        const NodeRecord& node = v.nodes[i];
        if (!inStrings(v, node.name)) return corrupt("node with a name past the strings", i);
        if (node.parent != kNone && node.parent >= i) return corrupt("node before its parent", i);
        if (!finite(node.toMesh)) return corrupt("node with a transform that is not finite", i);
    }
    return {};
}

Status checkOnePage(const AssetView& v) {
    if (v.pages.size() != 1) return corrupt("the asset has not one page", v.pages.size());
    const PageRecord& page = v.pages[0];
    const FileHeader& header = *reinterpret_cast<const FileHeader*>(v.bytes.data());
    if (page.codec != Codec::none) return unsupported("the page is compressed; decode the file with xgc::load first");
    if (page.tier != 0 || page.group != 0 || page.firstLevel != 0 || page.lastLevel + 1 != v.record->levelCount)
        return corrupt("the page has a wrong tier, group or range of levels");
    if (page.offset != header.tableBytes || page.storedBytes != page.rawBytes ||
        page.storedBytes != header.fileBytes - header.tableBytes)
        return corrupt("the page does not fill the file behind the tables");
    if (page.firstStream != 0 || page.streamCount != v.streams.size())
        return corrupt("the page has a wrong run of streams");
    return {};
}

Status checkPageTable(const AssetView& v) {
    return v.tierCount() > 1 ? checkPageTables(v) : checkOnePage(v);
}

} // namespace

Status checkTables(const AssetView& view) {
    for (Status (*check)(const AssetView&) :
         {checkCounts, checkLevels, checkDomains, checkRanges, checkPatches, checkErrors, checkParts, checkPartShapes,
          checkMerges, checkContours, checkFaceCounts, checkMaterials, checkNodes, checkSkins, checkMorphTargets,
          checkPageTable}) {
        if (Status s = check(view); !s.ok()) return s;
    }
    return {};
}

} // namespace xgc
