#pragma once

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/hierarchy.h>

#include <functional>

namespace xgc::bake {

/// Measures E(patch, level) in the uniform state of each level: a bound for the distance from every point of the drawn
/// patch to the input surface and from every point of the patch's base faces to the whole drawn surface, up to the
/// rounding of floats; never falling with the level. Patches that vanish keep an error: their base faces' distance to
/// what is drawn. In states in which the levels differ a patch is meant to deviate by at most 1.05 times the largest E
/// of it and the patches it shares a domain with, each at its own level. For that E is raised by samples of states in
/// which one patch is coarser than the others, and by a twentieth where a patch shares a domain: tried, not proved.
/// Where a level draws nothing at all, E is the diagonal of the mesh's bounds at least. Parallel (TBB), with the same
/// result for any number of threads. `progress` is told the finished fraction and stops the work by returning false.
PatchErrors measureErrors(const Mesh& mesh, const Topology& topology, const Hierarchy& hierarchy,
                          const std::function<bool(double)>& progress = {});

} // namespace xgc::bake
