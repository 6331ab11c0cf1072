#pragma once

#include <xgc/bake/mesh.h>

namespace xgc::bake {

/// Fills the counts of a report that speak of the welded mesh: zero area, back to back, edges, vertices, components.
void classify(const Mesh& mesh, const Topology& topology, WeldReport& report);

} // namespace xgc::bake
