#pragma once

#include <xgc/bake/hierarchy.h>

namespace xgc::bake {

/// The patches of a mesh, ordered by part, then material, and the patch of each face.
struct PatchAssignment {
    std::vector<Patch> patches;
    std::vector<uint32_t> facePatch;
};

/// One patch for each part and material that meet in a face.
PatchAssignment patchesOfParts(const Mesh& mesh, const Segmentation& parts);

inline constexpr uint32_t kDefaultPatchFaces = 2048;

/// Splits parts, material by material, into patches of about `maxFaces` faces at most (0: no bound): regions grown over
/// edges around seeds that move to their middles (Lloyd's iterations on the dual graph). Pieces that are
/// not connected share a patch where they are small. Deterministic.
PatchAssignment splitPatches(const Mesh& mesh, const Topology& topology, const Segmentation& parts,
                             uint32_t maxFaces = kDefaultPatchFaces);

} // namespace xgc::bake
