#pragma once

#include "linked_faces.h"

namespace xgc::bake {

/// Leaves every label of a component connected: all but its largest set of faces take the label that most of their
/// edges touch, of the same `group` (a number per face of the mesh; empty: any). `scratch` has an entry per face of the
/// mesh, all kNone, and is left so.
void joinLooseFaces(const LinkedFaces& linked, std::span<const uint32_t> component, std::span<const uint32_t> group,
                    std::vector<uint32_t>& scratch, std::vector<uint32_t>& labelOfFace);

} // namespace xgc::bake
