#pragma once

#include <xgc/bake/hierarchy.h>

namespace xgc::bake {

/// How the thesis's curvature K of a vertex comes from the covariance matrix of its face normals.
enum class CurvatureNorm {
    trace,     ///< sqrt of the trace: does not depend on rotation
    sum,       ///< sqrt of the sum of all entries: reproduces the thesis's figures, depends on rotation
    frobenius, ///< sqrt of the sum of squared entries, as printed in Eq. 4.4
};

struct ThesisHierarchyOptions {
    CurvatureNorm curvature = CurvatureNorm::trace;
    float lockCurvature = 0.5f; ///< vertices with K at or above it are locked with their edges
    uint32_t maxLevels = 32;    ///< levels above 0, at most; building stops where no part collapses any more
};

/// Builds the thesis's hierarchy (chapter 4) with XgcMesh and converts it. One patch for each part and material.
Hierarchy buildThesisHierarchy(const Mesh& mesh, const Topology& topology, const Segmentation& parts,
                               const ThesisHierarchyOptions& options,
                               std::vector<HierarchyLevelReport>* report = nullptr);

} // namespace xgc::bake
