#pragma once

#include <xgc/bake/segment.h>

#include <functional>

namespace xgc::bake {

/// Area of each face, summed up in double: the same on any machine.
std::vector<double> faceAreas(const Mesh& mesh);

/// What a set of equal labels became.
using PartNamer = std::function<std::string(uint32_t part, uint32_t label)>;

/// Turns any labels per face into parts: dense, by area descending, ties by lowest face. Names that `name` gives
/// twice are made unique by a suffix.
Segmentation orderParts(const Mesh& mesh, std::span<const uint32_t> faceLabels, const PartNamer& name);

/// Names parts after the node, else the material, that holds nearly all of a part and no other: where the mesh has
/// several. Names stay unique; those of other parts stay.
void nameParts(const Mesh& mesh, Segmentation& parts);

} // namespace xgc::bake
