#include <xgc/bake/hierarchy.h>

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {

uint32_t Hierarchy::domainLevel(uint32_t d, std::span<const uint8_t> levels) const {
    uint32_t level = kNeverCollapses;
    for (const uint32_t p : domainPatches[d]) level = std::min<uint32_t>(level, levels[p]);
    return level;
}

DrawnSurface drawSurface(const Mesh& mesh, const Hierarchy& hierarchy, std::span<const uint8_t> levels) {
    std::vector<uint32_t> domainLevels(hierarchy.domainPatches.size());
    for (uint32_t d = 0; d < domainLevels.size(); ++d) domainLevels[d] = hierarchy.domainLevel(d, levels);
    const auto representative = [&](uint32_t wedge) {
        uint32_t p = hierarchy.wedgePosition[wedge];
        while (hierarchy.collapseLevel[p] <= domainLevels[hierarchy.domain[p]]) {
            wedge = hierarchy.wedgeParent[wedge];
            p = hierarchy.wedgePosition[wedge];
        }
        return wedge;
    };
    DrawnSurface surface;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 corner = mesh.faces[f];
        const glm::uvec3 rep(representative(corner.x), representative(corner.y), representative(corner.z));
        const glm::uvec3 position(hierarchy.wedgePosition[rep.x], hierarchy.wedgePosition[rep.y],
                                  hierarchy.wedgePosition[rep.z]);
        if (position.x == position.y || position.y == position.z || position.z == position.x) continue;
        surface.triangles.push_back(rep);
        surface.face.push_back(f);
    }
    return surface;
}

namespace {

bool includes(const std::vector<uint32_t>& wide, const std::vector<uint32_t>& narrow) {
    return std::includes(wide.begin(), wide.end(), narrow.begin(), narrow.end());
}

Status broken(const char* what, uint32_t element) {
    return {Outcome::promiseBroken, fmt::format("hierarchy: {} {}", what, element)};
}

Status checkWedge(const Hierarchy& h, uint32_t wedge, std::vector<uint32_t>& parentPosition) {
    const uint32_t p = h.wedgePosition[wedge];
    const uint32_t parent = h.wedgeParent[wedge];
    if (h.collapseLevel[p] == kNeverCollapses) {
        return parent == kNone ? Status{} : broken("a vertex that never collapses has a parent, wedge", wedge);
    }
    if (h.collapseLevel[p] == 0 || h.collapseLevel[p] >= h.levelCount)
        return broken("collapse level out of range, position", p);
    if (parent >= h.wedgePosition.size()) return broken("no parent, wedge", wedge);
    const uint32_t q = h.wedgePosition[parent];
    if (q == p) return broken("a vertex is its own parent, wedge", wedge);
    if (h.collapseLevel[q] < h.collapseLevel[p]) return broken("the parent collapses first, wedge", wedge);
    if (h.birthLevel[q] > h.collapseLevel[p])
        return broken("the parent is born after its child collapses, wedge", wedge);
    if (!includes(h.domainPatches[h.domain[q]], h.domainPatches[h.domain[p]]))
        return broken("the parent's domain is not wider, wedge", wedge);
    if (parentPosition[p] != kNone && parentPosition[p] != q)
        return broken("wedges of one position part ways, position", p);
    parentPosition[p] = q;
    return {};
}

} // namespace

Status checkHierarchy(const Mesh& mesh, const Hierarchy& h) {
    const size_t positions = h.positions.size(), wedges = h.wedgePosition.size();
    if (h.collapseLevel.size() != positions || h.birthLevel.size() != positions || h.domain.size() != positions ||
        h.wedgeParent.size() != wedges || h.facePatch.size() != mesh.faces.size() ||
        h.levelThreshold.size() != h.levelCount) {
        return broken("columns differ in length, positions", uint32_t(positions));
    }
    std::vector<uint32_t> parentPosition(positions, kNone);
    for (uint32_t w = 0; w < wedges; ++w) {
        if (Status s = checkWedge(h, w, parentPosition); !s.ok()) return s;
    }
    for (uint32_t p = 0; p < positions; ++p) { // chains end: levels never fall along them, so only equal ones can loop
        uint32_t q = p, steps = 0;
        while (parentPosition[q] != kNone && h.collapseLevel[parentPosition[q]] == h.collapseLevel[p]) {
            q = parentPosition[q];
            if (++steps > positions) return broken("parents form a loop, position", p);
        }
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            const std::vector<uint32_t>& d = h.domainPatches[h.domain[corners[k]]];
            if (!std::binary_search(d.begin(), d.end(), h.facePatch[f]))
                return broken("a corner's domain misses the patch of face", f);
        }
    }
    return {};
}

} // namespace xgc::bake
