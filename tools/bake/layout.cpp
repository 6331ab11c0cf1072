#include "bake/layout.h"

#include <xgc/asset.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace xgc::bake {
namespace {

using namespace format;
using namespace layout;

/// A tier has so many times the vertices of the next coarser one: what is drawn from it then has about as much beside
/// it that is not drawn as the patches that are wanted no finer.
constexpr uint32_t kTierRatio = 2;

/// Names, one after the other.
class Strings {
public:
    Text add(const std::string& text) {
        const Text where = {uint32_t(bytes_.size()), uint32_t(text.size())};
        bytes_ += text;
        return where;
    }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// What the steps have made so far.
struct Layout {
    const Mesh& mesh;
    const Segmentation& parts;
    const Hierarchy& hierarchy;
    const PatchErrors& errors;
    uint32_t tierCount = 1;
    Domains domains{};
    Faces faces{};
    Rows rows{};
    Slots slots{};
    Strings strings{};
    FileBuilder file{};

    std::span<const uint32_t> facesOf(uint32_t patch) const {
        return std::span(faces.order)
            .subspan(faces.firstFace[patch], faces.firstFace[patch + 1] - faces.firstFace[patch]);
    }
    uint64_t listedFaceCount(uint32_t patch) const {
        uint64_t count = 0;
        for (const FacesOfLevel& list : faces.lists[patch]) count += list.triangles.size();
        return count;
    }
    /// Face lists of the patch that has most.
    uint32_t listCount() const {
        size_t count = 0;
        for (const auto& lists : faces.lists) count = std::max(count, lists.size());
        return uint32_t(count);
    }
};

Status refuse(const char* what, size_t element) {
    return {Outcome::promiseBroken, fmt::format("layout: {} {}", what, element)};
}

Status checkPatches(const Mesh& mesh, const Segmentation& parts, const Hierarchy& h) {
    if (h.levelCount == 0 || h.levelCount > kMaxLevels)
        return refuse("the hierarchy has a number of levels outside 1..254:", h.levelCount);
    if (parts.facePart.size() != mesh.faces.size())
        return refuse("parts label another number of faces:", parts.facePart.size());
    for (size_t m = 0; m < parts.merges.size(); ++m) {
        if (parts.merges[m].a >= parts.merges[m].b || parts.merges[m].b >= parts.partCount())
            return refuse("parts out of order or range, merge", m);
    }
    for (size_t p = 0; p < h.patches.size(); ++p) {
        const Patch& patch = h.patches[p];
        if (patch.part >= parts.partCount() || patch.material >= mesh.materials.size())
            return refuse("part or material out of range, patch", p);
        if (p > 0 && patch.part < h.patches[p - 1].part) return refuse("patches are not ordered by part, patch", p);
    }
    for (size_t d = 0; d < h.domainPatches.size(); ++d) {
        const std::vector<uint32_t>& set = h.domainPatches[d];
        if (set.empty() || set.back() >= h.patchCount() || !std::is_sorted(set.begin(), set.end(), std::less_equal<>()))
            return refuse("patches out of order or range, domain", d);
    }
    return {};
}

Status checkFaces(const Mesh& mesh) {
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        if (p.x == p.y || p.y == p.z || p.z == p.x) return refuse("two corners have one position, face", f);
    }
    return {};
}

Status checkColumns(const Hierarchy& h) {
    const size_t wedges = h.wedgePosition.size();
    const auto fits = [&](const auto& column) { return column.empty() || column.size() == wedges; };
    const Attributes& a = h.attributes;
    bool ok = fits(a.normals) && fits(a.tangents);
    for (const auto& uv : a.uvs) ok = ok && fits(uv);
    for (const auto& color : a.colors) ok = ok && fits(color);
    for (const auto& joints : a.joints) ok = ok && fits(joints);
    for (const auto& weights : a.weights) ok = ok && fits(weights);
    for (const MorphTarget& target : a.morphTargets) ok = ok && fits(target.positions) && fits(target.normals);
    return ok ? Status{} : refuse("an attribute has another number of rows than there are wedges:", wedges);
}

Status checkErrors(const Hierarchy& h, const PatchErrors& errors) {
    if (errors.values.size() != size_t(h.patchCount()) * h.levelCount)
        return refuse("errors are not one a patch and level:", errors.values.size());
    for (size_t i = 0; i < errors.values.size(); ++i) {
        const float before = i % h.levelCount ? errors.values[i - 1] : 0.0f;
        if (!std::isfinite(errors.values[i]) || !(errors.values[i] >= before))
            return refuse("an error is not finite or falls with the level, patch", i / h.levelCount);
    }
    return {};
}

Status checkInput(const Mesh& mesh, const Segmentation& parts, const Hierarchy& h, const PatchErrors& errors) {
    constexpr size_t kMostFaces = UINT32_MAX / 3;
    if (mesh.faces.empty() || h.patches.empty()) return refuse("nothing to lay out, patches:", h.patches.size());
    if (mesh.faces.size() > kMostFaces)
        return badInput(fmt::format("an asset holds at most {} faces, this mesh has {}: split it into several assets",
                                    kMostFaces, mesh.faces.size()));
    if (Status s = checkPatches(mesh, parts, h); !s.ok()) return s;
    if (Status s = checkHierarchy(mesh, h); !s.ok()) return s;
    if (Status s = checkFaces(mesh); !s.ok()) return s;
    if (Status s = checkColumns(h); !s.ok()) return s;
    return checkErrors(h, errors);
}

/// Limits that show only once the rows and slots are counted.
Status checkLimits(const Layout& l) {
    uint64_t slots = 0;
    for (uint32_t p = 0; p < l.hierarchy.patchCount(); ++p) {
        for (const uint32_t d : l.domains.ofPatch[p]) slots += l.rows.ranges[d].count;
        slots += l.rows.ranges[l.domains.sets.size() + p].count;
    }
    if (slots > UINT32_MAX)
        return badInput(fmt::format("the patches have {} vertices together, more than 2^32: use fewer patches or split "
                                    "the mesh into several assets",
                                    slots));
    uint64_t listed = 0;
    for (uint32_t p = 0; p < l.hierarchy.patchCount(); ++p) listed += l.listedFaceCount(p);
    if (listed > UINT32_MAX / 3)
        return badInput(fmt::format("the patches list {} faces together, more than {}: split the mesh into several "
                                    "assets",
                                    listed, UINT32_MAX / 3));
    return {};
}

void addAsset(Layout& l, bool inputIsClosed) {
    const Hierarchy& h = l.hierarchy;
    AssetRecord r = {};
    r.levelCount = h.levelCount;
    r.listCount = l.listCount();
    r.tierCount = r.pageGroupCount = 1;
    r.laidOutTiers = l.tierCount > 1 ? l.tierCount : 0;
    r.domainCount = uint32_t(l.domains.sets.size());
    r.patchCount = h.patchCount();
    r.partCount = l.parts.partCount();
    r.materialCount = uint32_t(l.mesh.materials.size());
    r.nodeCount = uint32_t(l.mesh.nodes.size());
    r.vertexCount = uint32_t(l.rows.wedgeOf.size());
    r.faceCount = l.mesh.faceCount();
    for (uint32_t p = 0; p < r.patchCount; ++p) {
        r.maxPatchSlots = std::max(r.maxPatchSlots, l.slots.patches[p].slotCount);
        r.maxPatchFaces = std::max(r.maxPatchFaces, uint32_t(l.facesOf(p).size()));
    }
    r.flags = (l.errors.estimate ? uint32_t(kErrorIsEstimate) : 0u) | (inputIsClosed ? uint32_t(kInputIsClosed) : 0u);

    r.positionStep = l.errors.positionStep;

    std::vector<uint8_t> seen(h.positions.size(), 0);
    std::vector<glm::vec3> points;
    for (const uint32_t wedge : l.rows.wedgeOf) {
        const uint32_t p = h.wedgePosition[wedge];
        r.baseVertexCount += h.birthLevel[p] == 0;
        r.positionCount += h.birthLevel[p] == 0 && !seen[p];
        if (!seen[p]) points.push_back(h.positions[p]);
        seen[p] = 1;
    }
    const Bounds bounds = boundsOf(points);
    std::memcpy(r.boundsMin, &bounds.low, sizeof r.boundsMin);
    std::memcpy(r.boundsMax, &bounds.high, sizeof r.boundsMax);
    std::memcpy(r.sphereCenter, &bounds.sphere.center, sizeof r.sphereCenter);
    r.sphereRadius = bounds.sphere.radius;
    l.file.section<AssetRecord>(SectionId::asset, std::span(&r, 1));
}

void addLevels(Layout& l) {
    const uint32_t levelCount = l.hierarchy.levelCount;
    std::vector<LevelRecord> levels(levelCount);
    for (uint32_t i = 0; i < levelCount; ++i) {
        levels[i].threshold = l.hierarchy.levelThreshold[i];
        levels[i].faceCount = l.faces.levelFaceCounts[i];
        for (size_t p = 0; p < l.hierarchy.patchCount(); ++p) {
            levels[i].maxError = std::max(levels[i].maxError, l.errors.values[p * levelCount + i]);
        }
    }
    l.file.section<LevelRecord>(SectionId::levels, levels);
    l.file.section<float>(SectionId::patchErrors, l.errors.values);
}

void addFaceLists(Layout& l) {
    std::vector<FaceList> lists;
    for (const std::vector<FacesOfLevel>& patch : l.faces.lists) {
        for (const FacesOfLevel& list : patch) lists.push_back({list.level, uint32_t(list.triangles.size())});
        lists.resize(lists.size() + l.listCount() - patch.size(), {kNever, 0});
    }
    l.file.section<FaceList>(SectionId::faceLists, lists);
    l.file.section<uint32_t>(SectionId::patchFaceCounts, l.faces.patchFaceCounts);
}

void addDomains(Layout& l) {
    std::vector<DomainRecord> records;
    std::vector<uint32_t> domainPatches, patchDomains;
    for (size_t d = 0; d < l.domains.sets.size(); ++d) {
        const std::vector<uint32_t>& set = l.domains.sets[d];
        records.push_back({uint32_t(domainPatches.size()), uint32_t(set.size()), 0, l.domains.tiers[d]});
        domainPatches.insert(domainPatches.end(), set.begin(), set.end());
    }
    for (const std::vector<uint32_t>& list : l.domains.ofPatch) {
        patchDomains.insert(patchDomains.end(), list.begin(), list.end());
    }
    l.file.section<DomainRecord>(SectionId::domains, records);
    l.file.section<uint32_t>(SectionId::domainPatches, domainPatches);
    l.file.section<uint32_t>(SectionId::patchDomains, patchDomains);
    l.file.section<uint32_t>(SectionId::patchSlots, l.slots.patchSlots);
    l.file.section<VertexRange>(SectionId::vertexRanges, l.rows.ranges);
}

void setBounds(const Bounds& bounds, const Cone& cone, PatchRecord& r) {
    std::memcpy(r.boxMin, &bounds.low, sizeof r.boxMin);
    std::memcpy(r.boxMax, &bounds.high, sizeof r.boxMax);
    std::memcpy(r.sphereCenter, &bounds.sphere.center, sizeof r.sphereCenter);
    r.sphereRadius = bounds.sphere.radius;
    std::memcpy(r.coneAxis, &cone.axis, sizeof r.coneAxis);
    r.coneCosine = cone.cosine;
    r.coneLevel = cone.level;
}

void addPatches(Layout& l) {
    const Hierarchy& h = l.hierarchy;
    std::vector<PatchRecord> records(h.patchCount());
    std::vector<uint32_t> scratch(h.wedgePosition.size(), 0);
    uint32_t firstDomain = 0;
    for (uint32_t p = 0; p < records.size(); ++p) {
        PatchRecord& r = records[p];
        const Slots::PatchRun& run = l.slots.patches[p];
        r.part = h.patches[p].part;
        r.material = h.patches[p].material;
        r.firstDomain = firstDomain;
        r.domainCount = uint32_t(l.domains.ofPatch[p].size());
        r.slotCount = run.slotCount;
        r.faceCount = uint32_t(l.facesOf(p).size());
        r.listedFaceCount = uint32_t(l.listedFaceCount(p));
        r.firstCorner = run.firstCorner;
        r.firstParent = run.firstParent;
        r.flags = run.wide ? uint32_t(kWideSlots) : 0u;
        setBounds(boundsOfPatch(l.mesh, h, l.facesOf(p), p, scratch), coneOfPatch(l.mesh, h, l.facesOf(p)), r);
        firstDomain += r.domainCount;
    }
    std::vector<Text> targetNames;
    for (const MorphTarget& target : h.attributes.morphTargets) targetNames.push_back(l.strings.add(target.name));
    addPose(l.mesh, h, l.faces, l.rows, l.errors, targetNames, records, l.file);
    l.file.section<PatchRecord>(SectionId::patches, records);
}

void addParts(Layout& l) {
    const std::vector<PartFigures> figures = measureParts(l.mesh, l.parts);
    std::vector<PartRecord> records(l.parts.partCount());
    std::vector<uint32_t> neighbours;
    std::vector<float> contours;
    uint32_t patch = 0;
    for (uint32_t i = 0; i < records.size(); ++i) {
        PartRecord& r = records[i];
        const std::string& name = l.parts.partNames[i];
        r.stableId = hash(std::as_bytes(std::span(name)));
        r.name = l.strings.add(name);
        r.firstPatch = patch;
        while (patch < l.hierarchy.patchCount() && l.hierarchy.patches[patch].part == i) ++patch;
        r.patchCount = patch - r.firstPatch;
        r.firstNeighbour = uint32_t(neighbours.size());
        r.neighbourCount = uint32_t(figures[i].neighbours.size());
        r.faceCount = figures[i].faceCount;
        r.importance = 1;
        r.area = float(figures[i].area);
        for (int k = 0; k < 3; ++k) r.centroid[k] = float(figures[i].centroid[k]);
        neighbours.insert(neighbours.end(), figures[i].neighbours.begin(), figures[i].neighbours.end());
        contours.insert(contours.end(), figures[i].contours.begin(), figures[i].contours.end());
    }
    std::vector<MergeRecord> merges;
    for (const PartMerge& m : l.parts.merges) merges.push_back({m.a, m.b, m.cost, 0});
    l.file.section<PartRecord>(SectionId::parts, records);
    l.file.section<uint32_t>(SectionId::partNeighbours, neighbours);
    l.file.section<float>(SectionId::contours, contours);
    l.file.section<PartShape>(SectionId::partShapes, shapesOfParts(l.mesh, l.parts, figures));
    l.file.section<MergeRecord>(SectionId::mergeTree, merges);
}

void addMaterials(Layout& l) {
    std::vector<MaterialRecord> records;
    for (const Material& m : l.mesh.materials) {
        MaterialRecord r = {};
        r.name = l.strings.add(m.name);
        std::memcpy(r.baseColor, &m.baseColor, sizeof r.baseColor);
        r.metallic = m.metallic;
        r.roughness = m.roughness;
        std::memcpy(r.emissive, &m.emissive, sizeof r.emissive);
        r.flags = (m.doubleSided ? uint32_t(kDoubleSided) : 0u) | (m.alphaMask ? uint32_t(kAlphaMask) : 0u) |
                  (m.alphaBlend ? uint32_t(kAlphaBlend) : 0u);
        records.push_back(r);
    }
    l.file.section<MaterialRecord>(SectionId::materials, records);
    std::vector<float> cutoffs;
    for (const Material& m : l.mesh.materials) cutoffs.push_back(m.alphaCutoff);
    const float usual = Material{}.alphaCutoff;
    if (std::any_of(cutoffs.begin(), cutoffs.end(), [&](float c) { return c != usual; }))
        l.file.section<float>(SectionId::alphaCutoffs, cutoffs);
}

void addNodes(Layout& l) {
    std::vector<NodeRecord> records;
    for (const SceneNode& node : l.mesh.nodes) {
        NodeRecord r = {};
        r.name = l.strings.add(node.name);
        r.parent = node.parent;
        std::memcpy(r.toMesh, &node.toMesh, sizeof r.toMesh);
        records.push_back(r);
    }
    l.file.section<NodeRecord>(SectionId::nodes, records);
}

void addStreams(Layout& l) {
    const Hierarchy& h = l.hierarchy;
    std::vector<uint8_t> collapse, birth;
    for (const uint32_t wedge : l.rows.wedgeOf) {
        collapse.push_back(h.collapseLevel[h.wedgePosition[wedge]]);
        birth.push_back(h.birthLevel[h.wedgePosition[wedge]]);
    }
    addVertexStreams(h, l.rows, l.file);
    l.file.stream<uint8_t>(StreamKind::collapseLevel, StreamFormat::u8, 0, collapse);
    if (std::any_of(birth.begin(), birth.end(), [](uint8_t b) { return b != 0; })) {
        l.file.stream<uint8_t>(StreamKind::birthLevel, StreamFormat::u8, 0, birth);
    }
    l.file.stream<uint16_t>(StreamKind::parentNarrow, StreamFormat::u16, 0, l.slots.parentsNarrow);
    l.file.stream<uint32_t>(StreamKind::parentWide, StreamFormat::u32, 0, l.slots.parentsWide);
    l.file.stream<uint16_t>(StreamKind::cornerNarrow, StreamFormat::u16, 0, l.slots.cornersNarrow);
    l.file.stream<uint32_t>(StreamKind::cornerWide, StreamFormat::u32, 0, l.slots.cornersWide);
}

/// No file that the runtime would refuse is handed out.
Status checkOpens(std::span<const std::byte> bytes) {
    const AlignedBytes copy = alignedCopy(bytes);
    AssetView view;
    const xgc::Status s = openAll(copy.span(), view);
    if (s.ok()) return {};
    return {Outcome::promiseBroken, fmt::format("layout: the asset does not open: {} ({})", s.message, s.element)};
}

} // namespace

Status layOutAsset(const Mesh& mesh, const Segmentation& parts, const Hierarchy& hierarchy, const PatchErrors& errors,
                   bool inputIsClosed, std::string_view provenance, std::vector<std::byte>& out, uint32_t tierCount) {
    if (Status s = checkInput(mesh, parts, hierarchy, errors); !s.ok()) return s;
    Layout l{mesh, parts, hierarchy, errors};
    const std::vector<uint8_t> used = usedWedges(mesh, hierarchy);
    Tiers tiers;
    if (tierCount > 1) tiers = findTiers(hierarchy, used, kTierRatio, tierCount);
    const Tiers* pages = tierCount > 1 ? &tiers : nullptr;
    l.tierCount = pages ? tiers.count() : 1;
    l.domains = orderDomains(hierarchy, used, pages);
    l.faces = orderFaces(mesh, hierarchy, pages);
    l.rows = orderRows(mesh, hierarchy, l.domains, l.faces);
    if (Status s = checkLimits(l); !s.ok()) return s;
    l.slots = numberSlots(hierarchy, l.domains, l.faces, l.rows);

    addAsset(l, inputIsClosed);
    addLevels(l);
    addFaceLists(l);
    addDomains(l);
    addPatches(l);
    addParts(l);
    addMaterials(l);
    addNodes(l);
    l.file.section<char>(SectionId::strings, l.strings.bytes());
    l.file.section<char>(SectionId::provenance, provenance);
    addStreams(l);
    std::vector<std::byte> bytes;
    l.file.finish(hierarchy.levelCount, bytes);
    if (Status s = checkOpens(bytes); !s.ok()) return s;
    out = std::move(bytes);
    return {};
}

} // namespace xgc::bake
