#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
    void add(const glm::vec3& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void add(const Box& box) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
    }
    glm::vec3 center() const { return (low + high) * 0.5f; }
    /// Half of the surface.
    float area() const {
        const glm::vec3 d = high - low;
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
};

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
    /// Four numbers side by side: each is computed as it would be alone.
    using Float4 = float __attribute__((vector_size(16)));
    struct Node {
        Float4 low[3], high[3];
        uint32_t child[4]; ///< kLeaf set: a packet; kEmpty: none
    };
    /// Four triangles, side by side: corner, two edges.
    struct Packet {
        Float4 corner[3], edge1[3], edge2[3];
    };
    struct Ray;
    static float meet(const Packet& packet, const Ray& ray, float to);
    uint32_t build(std::span<uint32_t> triangles, uint32_t depth);
    uint32_t addPacket(std::span<const uint32_t> triangles);
    template <class Meet>
    void walk(const Ray& ray, const Meet& meet) const;

    std::span<const glm::vec3> soup_;
    std::vector<Box> boxes_; ///< of triangles, while building
    std::vector<Node> nodes_;
    std::vector<Packet> packets_;
    uint32_t root_ = 0;
};

} // namespace xgc::bake
