#include <xgc/bake/hierarchy.h>

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

} // namespace xgc::bake
