#include "builder.h"

#include <xgc/bake/error.h>

namespace xgc::bench {

bake::Hierarchy build(const Subject& subject, const bake::Segmentation& parts, const bake::HierarchyOptions& options,
                      uint32_t patchFaces) {
    const bake::PatchAssignment patches = bake::splitPatches(subject.mesh, subject.topology, parts, patchFaces);
    return bake::buildDefaultHierarchy(subject.mesh, subject.topology, patches, options);
}

bake::PatchErrors measureErrors(const Subject& subject, const bake::Hierarchy& hierarchy) {
    return bake::measureErrors(subject.mesh, subject.topology, hierarchy);
}

std::vector<uint32_t> uniformFaces(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy) {
    std::vector<uint32_t> faces;
    for (uint32_t level = 0; level < hierarchy.levelCount; ++level) {
        const std::vector<uint8_t> levels(hierarchy.patchCount(), uint8_t(level));
        faces.push_back(uint32_t(bake::drawSurface(mesh, hierarchy, levels).triangles.size()));
    }
    return faces;
}

} // namespace xgc::bench
