#include <xgc/bake/thesis_hierarchy.h>

#include "hierarchy/average_attributes.h"
#include "hierarchy/first_domains.h"

#include <algorithm>
#include <cassert>
#include <chrono>

namespace xgc::bake {

namespace {

class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

HierarchyLevelReport levelReport(const XgcMesh& mesh, const XgcPass& pass, double seconds) {
    return {mesh.faceCount(), pass.collapses, pass.linkRefused, pass.flipRefused, pass.wedgeRefused, seconds};
}

/// Adds the vertices that interior collapses made, children first.
void addMadeVertices(const XgcMesh& x, Hierarchy& h) {
    const std::span<const XgcMesh::Vertex> vertices = x.vertices();
    for (uint32_t v = x.baseVertexCount(); v < vertices.size(); ++v) {
        const Genealogy& g = x.genealogies()[vertices[v].genealogy];
        const auto [i, j] = g.ancestors;
        h.positions.push_back(vertices[v].position);
        h.birthLevel.push_back(g.level);
        h.collapseLevel.push_back(kNeverCollapses);
        h.domain.push_back(h.domain[i]);
        h.wedgePosition.push_back(v);
        h.wedgeParent.push_back(kNone);
        appendAverage(h.attributes, vertices[i].wedge, vertices[j].wedge);
    }
}

} // namespace

Hierarchy convertToHierarchy(const Mesh& mesh, const XgcMesh& simplified, const PatchAssignment& assignment) {
    Hierarchy h;
    for (uint32_t s = 0; s < simplified.segmentCount(); ++s)
        h.levelCount = std::max(h.levelCount, simplified.level(s) + 1);
    h.positions = mesh.positions;
    h.collapseLevel.assign(mesh.positions.size(), kNeverCollapses);
    h.birthLevel.assign(mesh.positions.size(), 0);
    h.domain.resize(mesh.positions.size());
    h.wedgePosition = mesh.wedgePosition;
    h.wedgeParent.assign(mesh.wedgePosition.size(), kNone);
    h.attributes = mesh.attributes;
    h.patches = assignment.patches;
    h.facePatch = assignment.facePatch;
    h.levelThreshold.assign(h.levelCount, 0);
    assignFirstDomains(mesh, h);
    addMadeVertices(simplified, h);
    for (const Genealogy& g : simplified.genealogies()) {
        const uint32_t gone = g.type == CollapseType::interior ? 2 : 1;
        for (uint32_t k = 0; k < gone; ++k) {
            h.collapseLevel[g.ancestors[k]] = g.level;
            h.wedgeParent[simplified.vertices()[g.ancestors[k]].wedge] = g.wedge;
        }
    }
    return h;
}

Hierarchy buildThesisHierarchy(const Mesh& mesh, const Topology& topology, const Segmentation& parts,
                               const ThesisHierarchyOptions& options, std::vector<HierarchyLevelReport>* report) {
    assert(options.maxLevels < kNeverCollapses);
    Stopwatch start;
    const PatchAssignment assignment = patchesOfParts(mesh, parts);
    XgcMesh simplified(mesh, topology, assignment.facePatch, uint32_t(assignment.patches.size()),
                       {options.curvature, options.lockCurvature, options.lockDihedralCosine, options.order});
    if (report) *report = {levelReport(simplified, {}, start.seconds())};
    for (uint32_t level = 1; level <= options.maxLevels; ++level) {
        Stopwatch watch;
        const XgcPass pass = simplified.simplifyAll();
        if (pass.collapses == 0) break;
        if (report) report->push_back(levelReport(simplified, pass, watch.seconds()));
    }
    return convertToHierarchy(mesh, simplified, assignment);
}

} // namespace xgc::bake
