#pragma once

#include <xgc/asset.h>

#include <glm/mat4x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

namespace xgc {

// Poses: joints and blend shapes move the rows of an asset, whatever levels it is drawn at. A row v stands at
//
//     P(v) = sum over joints j of  w(v, j) / sum(w(v)) * M(j) * (v + sum over targets t of  weight(t) * delta(v, t))
//
// where M(j) takes mesh space to mesh space. That is one function of the row, so no state of levels opens a crack in a
// pose; geomorphs (morph.h) blend posed rows.
//
// Bounds: a posed row is a mean of the points to which its joints take it, so it lies in the convex hull of where they
// take the spheres of format::PatchJoint.
//
// Errors: let y be the point of the drawn surface nearest to a vertex v of level 0, no farther than E. With any joint r
// of the patch, c the centre of its sphere and L the linear parts,
//
//     P(v) - P(y) = M(r) (v - y) + sum over j of (M(j) - M(r)) (difference of w(j) [v; 1] between v and y)
//     |P(v) - P(y)| <= |L(r)| E + max |(M(j) - M(r)) c| * SkinError::weight + max |L(j) - L(r)| * SkinError::moment
//
// and targets add weight * |delta(v) - delta(y)|, which morphErrors bounds. So `posedError` bounds how far the vertices
// of level 0 lie from what is drawn; between them it is measured, not proved. Rigid poses change no error of patches
// with one joint.

/// What moves an instance. Empty spans: nothing of that kind.
struct Pose {
    std::span<const glm::mat4x3> joints; ///< a matrix each of AssetView::joints, from jointMatrices
    std::span<const float> morphWeights; ///< a weight each of AssetView::morphTargets; any sign
};

/// Transforms of all nodes of the asset to mesh space, from those to their parents. `toMesh` may be `toParent`.
void nodesToMesh(const AssetView& asset, std::span<const glm::mat4> toParent, std::span<glm::mat4> toMesh);
/// As the file has them: the pose in which the model came.
void restNodes(const AssetView& asset, std::span<glm::mat4> toMesh);
/// The matrices of a pose that puts nodes at `toMesh`: a matrix each joint.
void jointMatrices(const AssetView& asset, std::span<const glm::mat4> toMesh, std::span<glm::mat4x3> out);

/// Where a row stands in a pose: what the vertex shader does.
glm::vec3 posedPosition(const AssetView& asset, const Pose& pose, uint32_t row);

/// What a pose does to a patch.
struct PosedPatch {
    glm::vec4 sphere{0}; ///< centre and radius: contains all that the patch draws in the pose, in any state
    float stretch = 1;   ///< |L(r)| and the other two factors from above, rounded up
    float offset = 0;
    float bend = 0;
    float added = 0; ///< to any error, mesh units: of skins and targets together
};

/// A PosedPatch each patch, and a sphere around them all. No allocation; time linear in patchJoints.
glm::vec4 posePatches(const AssetView& asset, const Pose& pose, std::span<PosedPatch> out);

/// E of a patch at a level in a pose, mesh units; never falls with the level.
float posedError(const AssetView& asset, uint32_t patch, uint32_t level, const PosedPatch& posed,
                 std::span<const float> morphWeights);

} // namespace xgc
