#pragma once

#include <xgc/bake/hierarchy.h>

#include <functional>

namespace xgc::bake {

/// The RMS distance between the input and each uniform state, both ways, from `samples` points each way; mesh
/// units. Infinite where a level draws nothing. `progress` is told the finished fraction and stops by returning false.
std::vector<float> sampleLevels(const Mesh& mesh, const Hierarchy& hierarchy, uint32_t samples,
                                const std::function<bool(double)>& progress);

} // namespace xgc::bake
