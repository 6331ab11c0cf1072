#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

/// Triangles to shoot rays at. A tree of four children a node, four triangles a leaf. Its own and not a library's
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

private:
    struct alignas(16) Node {
        float low[3][4], high[3][4];
        uint32_t child[4]; ///< kLeaf set: a packet; kEmpty: none
    };
    /// Four triangles, side by side: corner, two edges.
    struct alignas(16) Packet {
        float corner[3][4], edge1[3][4], edge2[3][4];
    };
    struct Ray;
    uint32_t build(std::span<uint32_t> triangles, uint32_t depth);
    uint32_t addPacket(std::span<const uint32_t> triangles);
    template <class Meet>
    void walk(const Ray& ray, const Meet& meet) const;

    struct Source {
        glm::vec3 low, high;
    };
    std::span<const glm::vec3> soup_;
    std::vector<Source> boxes_; ///< of triangles, while building
    std::vector<Node> nodes_;
    std::vector<Packet> packets_;
    uint32_t root_ = 0;
};

} // namespace xgc::bake
