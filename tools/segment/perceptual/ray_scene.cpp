#include "ray_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace xgc::bake {

namespace {

constexpr uint32_t kLeaf = 0x80000000u;
constexpr uint32_t kEmpty = 0xffffffffu;
/// Nodes this deep are split by count: 16 levels more at most.
constexpr uint32_t kMostByPlace = 48;
constexpr uint32_t kMostDepth = kMostByPlace + 16;

/// Parts a range in two where the surface area heuristic is least, of seven planes across the longest axis of the
/// centres; by count where those part nothing.
template <class BoxOf>
size_t splitAt(std::span<uint32_t> triangles, const BoxOf& boxOf, uint32_t depth) {
    constexpr int kBins = 8;
    if (depth >= kMostByPlace) return triangles.size() / 2;
    Box centers;
    for (const uint32_t t : triangles) centers.add(boxOf(t).center());
    const glm::vec3 extent = centers.high - centers.low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    if (!(extent[axis] > 0)) return triangles.size() / 2;
    const float scale = float(kBins) * 0.9999f / extent[axis];
    const auto binOf = [&](uint32_t t) { return int((boxOf(t).center()[axis] - centers.low[axis]) * scale); };
    std::array<Box, kBins> boxes;
    std::array<uint32_t, kBins> counts = {};
    for (const uint32_t t : triangles) {
        boxes[size_t(binOf(t))].add(boxOf(t));
        ++counts[size_t(binOf(t))];
    }
    int best = 0;
    float least = 1e38f;
    for (int plane = 1; plane < kBins; ++plane) {
        Box left, right;
        uint32_t leftCount = 0, rightCount = 0;
        for (int b = 0; b < kBins; ++b) {
            (b < plane ? left : right).add(boxes[size_t(b)]);
            (b < plane ? leftCount : rightCount) += counts[size_t(b)];
        }
        if (leftCount == 0 || rightCount == 0) continue;
        const float cost = left.area() * float(leftCount) + right.area() * float(rightCount);
        if (cost >= least) continue;
        least = cost;
        best = plane;
    }
    size_t left = 0;
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (binOf(triangles[i]) < best) std::swap(triangles[i], triangles[left++]);
    }
    return left == 0 || left == triangles.size() ? triangles.size() / 2 : left;
}

} // namespace

struct RayScene::Ray {
    glm::vec3 origin, direction, inverse;
    float from, to;
};

RayScene::RayScene(std::span<const glm::vec3> soup) : soup_(soup) {
    const size_t count = soup.size() / 3;
    std::vector<uint32_t> order(count);
    boxes_.resize(count);
    for (size_t t = 0; t < count; ++t) {
        const glm::vec3 a = soup[3 * t], b = soup[3 * t + 1], c = soup[3 * t + 2];
        for (const glm::vec3& corner : {a, b, c}) boxes_[t].add(corner);
        order[t] = uint32_t(t);
    }
    nodes_.reserve(count / 4 + 1);
    packets_.reserve(count / 2 + 1);
    root_ = count == 0 ? kEmpty : count <= 4 ? addPacket(order) : build(order, 0);
    boxes_ = {};
    soup_ = {};
}

uint32_t RayScene::addPacket(std::span<const uint32_t> triangles) {
    Packet packet = {};
    for (size_t lane = 0; lane < triangles.size(); ++lane) {
        const glm::vec3 a = soup_[3 * triangles[lane]];
        const glm::vec3 u = soup_[3 * triangles[lane] + 1] - a, v = soup_[3 * triangles[lane] + 2] - a;
        for (int k = 0; k < 3; ++k) {
            packet.corner[k][lane] = a[k];
            packet.edge1[k][lane] = u[k];
            packet.edge2[k][lane] = v[k];
        }
    }
    packets_.push_back(packet);
    return kLeaf | uint32_t(packets_.size() - 1);
}

uint32_t RayScene::build(std::span<uint32_t> triangles, uint32_t depth) {
    const auto boxOf = [this](uint32_t t) -> const Box& { return boxes_[t]; };
    const auto index = uint32_t(nodes_.size());
    nodes_.emplace_back();
    std::array<std::span<uint32_t>, 4> parts = {};
    const size_t half = splitAt(triangles, boxOf, depth);
    const std::array<std::span<uint32_t>, 2> halves = {triangles.first(half), triangles.subspan(half)};
    for (size_t h = 0; h < 2; ++h) {
        if (halves[h].size() <= 4) {
            parts[2 * h] = halves[h];
            continue;
        }
        const size_t quarter = splitAt(halves[h], boxOf, depth);
        parts[2 * h] = halves[h].first(quarter);
        parts[2 * h + 1] = halves[h].subspan(quarter);
    }
    for (size_t i = 0; i < 4; ++i) {
        Box box;
        for (const uint32_t t : parts[i]) box.add(boxes_[t]);
        for (int k = 0; k < 3; ++k) {
            nodes_[index].low[k][i] = box.low[k];
            nodes_[index].high[k][i] = box.high[k];
        }
        const uint32_t child = parts[i].empty()       ? kEmpty
                               : parts[i].size() <= 4 ? addPacket(parts[i])
                                                      : build(parts[i], depth + 1);
        nodes_[index].child[i] = child;
    }
    return index;
}

/// Calls meet(packet) for leaves that the ray passes, nearer first as a rule, until it returns a reach below 0. What it
/// returns is how far the ray still goes.
template <class Meet>
void RayScene::walk(const Ray& ray, const Meet& meet) const {
    struct Visit {
        uint32_t what;
        float at;
    };
    std::array<Visit, 3 * kMostDepth + 4> stack;
    size_t depth = 0;
    float to = ray.to;
    if (root_ != kEmpty) stack[depth++] = {root_, ray.from};
    while (depth > 0) {
        const Visit visit = stack[--depth];
        if (visit.at > to) continue;
        if (visit.what & kLeaf) {
            to = meet(visit.what & ~kLeaf, to);
            if (to < 0) return;
            continue;
        }
        const Node& node = nodes_[visit.what];
        Float4 enter = Float4{} + ray.from, leave = Float4{} + to;
        for (int k = 0; k < 3; ++k) {
            const bool isUp = ray.inverse[k] >= 0;
            const Float4 a = ((isUp ? node.low[k] : node.high[k]) - ray.origin[k]) * ray.inverse[k];
            const Float4 b = ((isUp ? node.high[k] : node.low[k]) - ray.origin[k]) * ray.inverse[k];
            enter = a > enter ? a : enter;
            leave = b < leave ? b : leave;
        }
        leave *= 1.0000004f; // rounding must not lose a box
        const size_t first = depth;
        for (int i = 0; i < 4; ++i) {
            if (node.child[i] == kEmpty || enter[i] > leave[i]) continue;
            size_t at = depth++; // nearest on top
            for (; at > first && stack[at - 1].at < enter[i]; --at) stack[at] = stack[at - 1];
            stack[at] = {node.child[i], enter[i]};
        }
    }
}

namespace {

glm::vec3 inverseOf(const glm::vec3& direction) {
    glm::vec3 inverse;
    for (int k = 0; k < 3; ++k) {
        constexpr float kTiny = 1e-12f;
        const float d = std::abs(direction[k]) > kTiny ? direction[k] : (direction[k] < 0 ? -kTiny : kTiny);
        inverse[k] = 1 / d;
    }
    return inverse;
}

} // namespace

/// Nearest of a packet's four hits between from and to, or a value beyond `to` (Möller and Trumbore 1997).
float RayScene::meet(const Packet& packet, const Ray& ray, float to) {
    const auto& [e1x, e1y, e1z] = packet.edge1;
    const auto& [e2x, e2y, e2z] = packet.edge2;
    const glm::vec3 d = ray.direction;
    const Float4 px = d.y * e2z - d.z * e2y, py = d.z * e2x - d.x * e2z, pz = d.x * e2y - d.y * e2x;
    const Float4 det = e1x * px + e1y * py + e1z * pz;
    const Float4 sx = ray.origin.x - packet.corner[0];
    const Float4 sy = ray.origin.y - packet.corner[1];
    const Float4 sz = ray.origin.z - packet.corner[2];
    const Float4 qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
    const Float4 inverse = 1.0f / (det != 0 ? det : Float4{} + 1.0f);
    const Float4 u = (sx * px + sy * py + sz * pz) * inverse;
    const Float4 v = (d.x * qx + d.y * qy + d.z * qz) * inverse;
    const Float4 t = (e2x * qx + e2y * qy + e2z * qz) * inverse;
    const auto isHit = (det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > ray.from) & (t < to);
    const Float4 at = isHit ? t : Float4{} + 1e30f;
    return std::min(std::min(at[0], at[1]), std::min(at[2], at[3]));
}

float RayScene::nearestHit(const glm::vec3& origin, const glm::vec3& direction, float from) const {
    const Ray ray = {origin, direction, inverseOf(direction), from, 1e29f};
    float nearest = -1;
    walk(ray, [&](uint32_t packet, float to) {
        const float at = meet(packets_[packet], ray, to);
        if (at >= to) return to;
        return nearest = at;
    });
    return nearest;
}

bool RayScene::isBlocked(const glm::vec3& a, const glm::vec3& b, uint32_t& occluder) const {
    const glm::vec3 direction = b - a;
    const Ray ray = {a, direction, inverseOf(direction), 0, 1};
    if (packets_.empty()) return false;
    if (meet(packets_[occluder], ray, 1) < 1) return true;
    bool blocked = false;
    walk(ray, [&](uint32_t packet, float to) {
        if (meet(packets_[packet], ray, to) >= to) return to;
        occluder = packet;
        blocked = true;
        return -1.0f;
    });
    return blocked;
}

} // namespace xgc::bake
