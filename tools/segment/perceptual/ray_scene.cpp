#include "ray_scene.h"
#include "ray_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace xgc::bake {

namespace {

/// Children that wait during a walk: all but one of each node above, and one node's more that are written and dropped.
constexpr size_t kMostWaiting = (RayScene::kWidth - 1) * RayTree::kMostDepth + 2 * RayScene::kWidth;

float inverseOf(float direction) {
    constexpr float kTiny = 1e-12f;
    return 1 / (std::abs(direction) > kTiny ? direction : direction < 0 ? -kTiny : kTiny);
}

} // namespace

/// A ray, each of its numbers four times over.
struct RayScene::Ray {
    std::array<Float4, 3> origin, direction, inverse;
    std::array<size_t, 3> nearSide; ///< of the boxes along each axis: 0 low, 1 high
    Float4 from;
    uint32_t octant = 0; ///< bit k: down along axis k

    Ray(const glm::vec3& o, const glm::vec3& d, float beyond) : from(fill4(beyond)) {
        for (int k = 0; k < 3; ++k) {
            const auto axis = size_t(k);
            origin[axis] = fill4(o[k]);
            direction[axis] = fill4(d[k]);
            inverse[axis] = fill4(inverseOf(d[k]));
            nearSide[axis] = inverse[axis][0] >= 0 ? 0 : 1;
            octant |= uint32_t(nearSide[axis]) << k;
        }
    }

    /// Which of a node's children it passes before `to`, as bits, and where it enters them.
    uint32_t passes(const Node& node, float to, Lanes& enter) const {
        uint32_t bits = 0;
        for (size_t half = 0; half < enter.size(); ++half) {
            Float4 in = from, out = fill4(to);
            for (size_t k = 0; k < 3; ++k) {
                in = max4((node.planes[k][nearSide[k]][half] - origin[k]) * inverse[k], in);
                out = min4((node.planes[k][1 - nearSide[k]][half] - origin[k]) * inverse[k], out);
            }
            enter[half] = in;
            bits |= bitsOf(in <= out * 1.0000004f) << 4 * half; // rounding must not lose a box
        }
        return bits;
    }

    /// Nearest of a packet's four hits before `to`, or a value beyond it (Möller and Trumbore 1997).
    float meet(const Packet& packet, float to) const {
        const auto& [e1x, e1y, e1z] = packet.edge1;
        const auto& [e2x, e2y, e2z] = packet.edge2;
        const auto& [dx, dy, dz] = direction;
        const Float4 px = dy * e2z - dz * e2y, py = dz * e2x - dx * e2z, pz = dx * e2y - dy * e2x;
        const Float4 det = e1x * px + e1y * py + e1z * pz;
        const Float4 sx = origin[0] - packet.corner[0];
        const Float4 sy = origin[1] - packet.corner[1];
        const Float4 sz = origin[2] - packet.corner[2];
        const Float4 qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
        const Float4 inverseDet = 1.0f / (det != 0 ? det : fill4(1));
        const Float4 u = (sx * px + sy * py + sz * pz) * inverseDet;
        const Float4 v = (dx * qx + dy * qy + dz * qz) * inverseDet;
        const Float4 t = (e2x * qx + e2y * qy + e2z * qz) * inverseDet;
        const auto isHit = (det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > from) & (t < to);
        if (bitsOf(isHit) == 0) return 1e30f;
        const Float4 at = isHit ? t : fill4(1e30f);
        return std::min(std::min(at[0], at[1]), std::min(at[2], at[3]));
    }
};

RayScene::RayScene(std::span<const glm::vec3> soup) {
    RayTree tree = buildRayTree(soup);
    nodes_ = std::move(tree.nodes);
    packets_ = std::move(tree.packets);
    root_ = tree.root;
}

/// Of the children that a ray passes the nearest is next, the others wait, nearer ones on top.
float RayScene::nearestHit(const glm::vec3& origin, const glm::vec3& direction, float from) const {
    struct Visit {
        uint32_t what;
        float at;
    };
    constexpr float kFar = 1e29f;
    const Ray ray(origin, direction, from);
    std::array<Visit, kMostWaiting> stack;
    size_t depth = 0;
    float nearest = kFar;
    for (Visit visit = {root_, from};;) {
        if (visit.what & kLeaf) {
            nearest = std::min(nearest, ray.meet(packets_[visit.what & ~kLeaf], nearest));
        } else {
            const Node& node = nodes_[visit.what];
            Lanes enter;
            const uint32_t bits = ray.passes(node, nearest, enter), order = node.order[ray.octant];
            for (uint32_t i = 0; i < kWidth; ++i) {
                const uint32_t c = order >> kChildBits * i & (kWidth - 1);
                stack[depth] = {node.child[c], enter[c / 4][c % 4]};
                depth += bits >> c & 1;
            }
        }
        do {
            if (depth == 0) return nearest < kFar ? nearest : -1;
            visit = stack[--depth];
        } while (visit.at > nearest);
    }
}

/// Any hit will do: no order.
bool RayScene::isBlocked(const glm::vec3& a, const glm::vec3& b, uint32_t& occluder) const {
    const Ray ray(a, b - a, 0);
    if (ray.meet(packets_[occluder], 1) < 1) return true;
    std::array<uint32_t, kMostWaiting> stack;
    size_t depth = 0;
    for (uint32_t what = root_;;) {
        if (what & kLeaf) {
            const uint32_t packet = what & ~kLeaf;
            if (ray.meet(packets_[packet], 1) < 1) {
                occluder = packet;
                return true;
            }
        } else {
            const Node& node = nodes_[what];
            Lanes enter;
            const uint32_t bits = ray.passes(node, 1, enter);
            for (uint32_t c = 0; c < kWidth; ++c) {
                stack[depth] = node.child[c];
                depth += bits >> c & 1;
            }
        }
        if (depth == 0) return false;
        what = stack[--depth];
    }
}

} // namespace xgc::bake
