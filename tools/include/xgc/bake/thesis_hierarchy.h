#pragma once

#include <xgc/bake/patches.h>
#include <xgc/bake/xgc_mesh.h>

namespace xgc::bake {

struct ThesisHierarchyOptions {
    CurvatureNorm curvature = CurvatureNorm::trace;
    float lockCurvature = 0.5f; ///< see XgcOptions for these four
    float lockDihedralCosine = -1;
    EdgeOrder order = EdgeOrder::flattestFirst;
    uint32_t maxLevels = 32; ///< levels above 0, at most; building stops where no part collapses any more
};

/// Builds the thesis's hierarchy (chapter 4) with XgcMesh and converts it: patches are its segments. A patch that
/// stalls before the others stays as it is at the levels that follow. `report`: an entry a level.
Hierarchy buildThesisHierarchy(const Mesh& mesh, const Topology& topology, const Segmentation& parts,
                               const ThesisHierarchyOptions& options,
                               std::vector<HierarchyLevelReport>* report = nullptr);

/// The runtime form of a mesh at the levels at which its segments stand: none may have been refined on the way.
Hierarchy convertToHierarchy(const Mesh& mesh, const XgcMesh& simplified, const PatchAssignment& assignment);

} // namespace xgc::bake
