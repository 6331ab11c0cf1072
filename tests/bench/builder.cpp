#include "builder.h"

#include <xgc/bake/error.h>
#include <xgc/bake/thesis_hierarchy.h>
#if __has_include(<xgc/bake/default_hierarchy.h>)
#include <xgc/bake/default_hierarchy.h>
#define XGC_DEFAULT_BUILDER 1
#endif

namespace xgc::bench {

bake::Hierarchy build(const Subject& subject, const bake::Segmentation& parts, const BuildRequest& request) {
#ifdef XGC_DEFAULT_BUILDER
    bake::HierarchyOptions options;
    options.placement = request.optimal ? bake::Placement::optimal : bake::Placement::subset;
    options.normalWeight = request.normalWeight;
    options.uvWeight = request.uvWeight;
    const bake::PatchAssignment patches = bake::splitPatches(subject.mesh, subject.topology, parts, request.patchFaces);
    return bake::buildDefaultHierarchy(subject.mesh, subject.topology, patches, options);
#else
    (void)request;
    return bake::buildThesisHierarchy(subject.mesh, subject.topology, parts, {});
#endif
}

bake::PatchErrors measureErrors(const Subject& subject, const bake::Hierarchy& hierarchy) {
    return bake::estimateErrors(subject.mesh, hierarchy);
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
