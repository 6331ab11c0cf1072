#pragma once

#include "float4.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

/// Triangles to shoot rays at. A tree of eight children a node, four triangles a leaf. Its own and not a library's
/// because what a ray meets must be the same on any machine: libraries choose their instructions by the processor.
class RayScene {
public:
    /// Three corners a triangle.
    explicit RayScene(std::span<const glm::vec3> soup);

    /// Distance to the nearest triangle beyond `from`, in lengths of `direction`; below 0 where there is none.
    float nearestHit(const glm::vec3& origin, const glm::vec3& direction, float from) const;
    /// Whether a triangle lies between the points. `occluder` remembers the leaf that stopped the last ray: the first
    /// to be tried. Start with 0.
    bool isBlocked(const glm::vec3& a, const glm::vec3& b, uint32_t& occluder) const;

    static constexpr uint32_t kWidth = 8, kChildBits = 3;
    using Lanes = std::array<Float4, kWidth / 4>; ///< a number a child
    struct alignas(64) Node {
        std::array<std::array<Lanes, 2>, 3> planes; ///< per axis: low, high sides of the children; low > high: none
        std::array<uint32_t, kWidth> child;         ///< kLeaf set: a packet
        std::array<uint32_t, 8> order;              ///< by octant of a direction: children, the farthest first
    };
    /// Four triangles, side by side: corner, two edges.
    struct Packet {
        std::array<Float4, 3> corner, edge1, edge2;
    };
    static constexpr uint32_t kLeaf = 0x80000000u;

private:
    struct Ray;

    std::vector<Node> nodes_;
    std::vector<Packet> packets_;
    uint32_t root_ = 0; ///< as a child
};

} // namespace xgc::bake
