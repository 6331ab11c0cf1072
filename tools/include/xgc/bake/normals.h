#pragma once

#include <xgc/bake/mesh.h>

namespace xgc::bake {

/// Gives a mesh without normals smooth, area-weighted ones. Edges whose faces turn by more than 60 degrees
/// are creases: where two or more of them meet at a position, it gets a wedge for each side. Does
/// nothing where the mesh has normals.
void addMissingNormals(Mesh& mesh, const Topology& topology);

} // namespace xgc::bake
