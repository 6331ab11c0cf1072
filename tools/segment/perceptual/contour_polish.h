#pragma once

#include "component.h"

namespace xgc::bake {

/// Straightens contours where cells of many faces left steps: a face takes the label of the cells that lie around it,
/// rather than of the one it is in. Every label of the component stays connected. `labelOfFace`: per face of the mesh,
/// one label a cell before. `scratch` has an entry per face of the mesh, all kNone, and is left so.
void polishContours(const Mesh& mesh, const LinkedFaces& linked, const Component& component,
                    std::vector<uint32_t>& scratch, std::vector<uint32_t>& labelOfFace);

} // namespace xgc::bake
