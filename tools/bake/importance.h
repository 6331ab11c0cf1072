#pragma once

#include <xgc/bake/bake.h>

namespace xgc::bake {

/// Fills the importances of a hierarchy's options from parts and painted vertex colours. Refuses parts that are not
/// there, factors that are not positive, and meshes without the colours.
Status findImportances(const BakeOptions& options, const Mesh& mesh, const Segmentation& parts, HierarchyOptions& out);

} // namespace xgc::bake
