#pragma once

#include <xgc/bake/hierarchy.h>

namespace xgc::bake {

/// Gives each position the set of patches of its faces: fills `domain` (as long as the mesh's positions at least) and
/// `domainPatches`. Sets of one patch come with the first position that has them.
void assignFirstDomains(const Mesh& mesh, Hierarchy& hierarchy);

} // namespace xgc::bake
