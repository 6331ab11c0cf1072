#pragma once

#include "ray_scene.h"
#include "superfacets.h"

namespace xgc::bake {

/// How thick a piece is below each superfacet (shape diameter: Shapira, Shamir, Cohen-Or 2008): the natural logarithm
/// of the depth. `normals` point outwards, one a cell. What a ray meets within `skin` does not count: bumps of the
/// surface itself, or its own coarser copy, lie in front of it.
std::vector<float> shapeDiameters(const CellGraph& graph, const Superfacets& superfacets,
                                  std::span<const glm::vec3> normals, const RayScene& scene, float skin);

/// Which pairs of superfacets see each other through the inside of a piece: all neighbours, and a sample of the others.
/// Symmetric matrices, a row a superfacet.
struct LinesOfSight {
    std::vector<float> seen;    ///< products of areas of pairs that do
    std::vector<float> sampled; ///< of all pairs that were looked at
};
LinesOfSight findLinesOfSight(const CellGraph& graph, const Superfacets& superfacets,
                              std::span<const glm::vec3> normals, std::span<const float> diameters,
                              const RayScene& scene);

} // namespace xgc::bake
