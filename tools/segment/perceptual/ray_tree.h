#pragma once

#include "ray_scene.h"

namespace xgc::bake {

/// The tree of a RayScene. A ray's walk never has more than kMostDepth nodes above it.
struct RayTree {
    static constexpr uint32_t kMostDepth = 64;
    std::vector<RayScene::Node> nodes;
    std::vector<RayScene::Packet> packets; ///< one or more
    uint32_t root = RayScene::kLeaf;       ///< a packet that no ray meets, where there is no triangle
};

/// Three corners a triangle.
RayTree buildRayTree(std::span<const glm::vec3> soup);

} // namespace xgc::bake
