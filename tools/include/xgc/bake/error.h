#pragma once

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/hierarchy.h>

#include <functional>

namespace xgc::bake {

/// Estimates E(patch, level) by sampling, in the uniform state of each level: from vertices, edge midpoints and
/// centroids of the drawn patch to the input surface, and from those of its base faces to the whole
/// drawn surface; the largest deviation, times 1.3, never falling with the level. `progress` is told the finished
/// fraction and stops the work by returning false.
PatchErrors estimateErrors(const Mesh& mesh, const Hierarchy& hierarchy,
                           const std::function<bool(double)>& progress = {});

} // namespace xgc::bake
