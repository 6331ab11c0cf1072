#pragma once

#include <xgc/bake/patches.h>

namespace xgc::bake {

/// Where a collapse puts the vertex that stays.
enum class Placement {
    subset,  ///< at the vertex that stays: every vertex ever drawn is one of the input's
    optimal, ///< at the quadric's minimum, a vertex of its own, where both ends answer to the same patches
    midpoint ///< half-way, likewise
};

struct HierarchyOptions {
    Placement placement = Placement::subset;
    /// K at most; 1..253.
    uint32_t maxLevels = 26;
    /// Error of level 1 in diagonals of the mesh's box; each further level allows sqrt 2 times the one before.
    double firstError = 2e-5;
    /// Weights of attribute deviation in the cost, in lengths relative to the box's diagonal: a normal turned by 1 rad,
    /// a UV moved by 1, a colour by 1 cost as much as that length. 0: only the wedges' map counts. The defaults are as
    /// large as they can be at no loss of shape (bench_hierarchy --attributes).
    double normalWeight = 5e-4;
    double uvWeight = 0.2;
    double colorWeight = 0.02;
    /// Per part: its costs are multiplied by this squared (2: half the error at the same level). Empty: all 1.
    std::vector<float> partImportance;
    /// Per position: its cost is multiplied by this squared; infinity locks it. Empty: all 1.
    std::vector<float> vertexImportance;
};

/// Builds the hierarchy in which boundaries coarsen too, by quadrics, level by level at error thresholds (hierarchy.md
/// of the design; Garland and Heckbert 1997): every state of levels is free of cracks and of flips against
/// the input. `patches` are those of `splitPatches` or `patchesOfParts`. The same at any number of threads.
Hierarchy buildDefaultHierarchy(const Mesh& mesh, const Topology& topology, const PatchAssignment& patches,
                                const HierarchyOptions& options, std::vector<HierarchyLevelReport>* report = nullptr);

} // namespace xgc::bake
