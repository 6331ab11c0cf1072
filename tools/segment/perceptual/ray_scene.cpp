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

/// Halves a range: by the middle of the centres along their longest axis, or by count where that halves nothing.
size_t splitAt(std::span<uint32_t> triangles, const auto& centerOf, uint32_t depth) {
    if (depth >= kMostByPlace) return triangles.size() / 2;
    glm::vec3 low(1e30f), high(-1e30f);
    for (const uint32_t t : triangles) {
        low = glm::min(low, centerOf(t));
        high = glm::max(high, centerOf(t));
    }
    const glm::vec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const float middle = (low[axis] + high[axis]) * 0.5f;
    size_t left = 0;
    for (size_t i = 0; i < triangles.size(); ++i) {
        if (centerOf(triangles[i])[axis] < middle) std::swap(triangles[i], triangles[left++]);
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
        boxes_[t] = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
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
    const auto centerOf = [this](uint32_t t) { return boxes_[t].low + boxes_[t].high; };
    const auto index = uint32_t(nodes_.size());
    nodes_.emplace_back();
    std::array<std::span<uint32_t>, 4> parts = {};
    const size_t half = splitAt(triangles, centerOf, depth);
    const std::array<std::span<uint32_t>, 2> halves = {triangles.first(half), triangles.subspan(half)};
    for (size_t h = 0; h < 2; ++h) {
        if (halves[h].size() <= 4) {
            parts[2 * h] = halves[h];
            continue;
        }
        const size_t quarter = splitAt(halves[h], centerOf, depth);
        parts[2 * h] = halves[h].first(quarter);
        parts[2 * h + 1] = halves[h].subspan(quarter);
    }
    for (size_t i = 0; i < 4; ++i) {
        glm::vec3 low(1e30f), high(-1e30f);
        for (const uint32_t t : parts[i]) {
            low = glm::min(low, boxes_[t].low);
            high = glm::max(high, boxes_[t].high);
        }
        for (int k = 0; k < 3; ++k) {
            nodes_[index].low[k][i] = low[k];
            nodes_[index].high[k][i] = high[k];
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
        float enter[4], leave[4];
        for (int i = 0; i < 4; ++i) {
            enter[i] = ray.from;
            leave[i] = to;
        }
        for (int k = 0; k < 3; ++k) {
            const float* nearSide = ray.inverse[k] >= 0 ? node.low[k] : node.high[k];
            const float* farSide = ray.inverse[k] >= 0 ? node.high[k] : node.low[k];
            for (int i = 0; i < 4; ++i) {
                const float a = (nearSide[i] - ray.origin[k]) * ray.inverse[k];
                const float b = (farSide[i] - ray.origin[k]) * ray.inverse[k];
                enter[i] = a > enter[i] ? a : enter[i];
                leave[i] = b < leave[i] ? b : leave[i];
            }
        }
        const size_t first = depth;
        for (int i = 0; i < 4; ++i) {
            if (node.child[i] == kEmpty || enter[i] > leave[i] * 1.0000004f) continue;
            size_t at = depth++; // nearest on top
            for (; at > first && stack[at - 1].at < enter[i]; --at) stack[at] = stack[at - 1];
            stack[at] = {node.child[i], enter[i]};
        }
    }
}

namespace {

/// Nearest of a packet's four hits between from and to, or a value beyond `to`.
float meetPacket(const auto& packet, const auto& ray, float to) {
    float at[4];
    for (int i = 0; i < 4; ++i) {
        const float e1x = packet.edge1[0][i], e1y = packet.edge1[1][i], e1z = packet.edge1[2][i];
        const float e2x = packet.edge2[0][i], e2y = packet.edge2[1][i], e2z = packet.edge2[2][i];
        const float px = ray.direction.y * e2z - ray.direction.z * e2y;
        const float py = ray.direction.z * e2x - ray.direction.x * e2z;
        const float pz = ray.direction.x * e2y - ray.direction.y * e2x;
        const float det = e1x * px + e1y * py + e1z * pz;
        const float sx = ray.origin.x - packet.corner[0][i];
        const float sy = ray.origin.y - packet.corner[1][i];
        const float sz = ray.origin.z - packet.corner[2][i];
        const float qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
        const float inverse = 1.0f / (det != 0 ? det : 1.0f);
        const float u = (sx * px + sy * py + sz * pz) * inverse;
        const float v = (ray.direction.x * qx + ray.direction.y * qy + ray.direction.z * qz) * inverse;
        const float t = (e2x * qx + e2y * qy + e2z * qz) * inverse;
        const bool hit = int(det != 0) & int(u >= 0) & int(v >= 0) & int(u + v <= 1) & int(t > ray.from) & int(t < to);
        at[i] = hit ? t : 1e30f;
    }
    return std::min(std::min(at[0], at[1]), std::min(at[2], at[3]));
}

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

float RayScene::nearestHit(const glm::vec3& origin, const glm::vec3& direction, float from) const {
    const Ray ray = {origin, direction, inverseOf(direction), from, 1e29f};
    float nearest = -1;
    walk(ray, [&](uint32_t packet, float to) {
        const float at = meetPacket(packets_[packet], ray, to);
        if (at >= to) return to;
        return nearest = at;
    });
    return nearest;
}

bool RayScene::isBlocked(const glm::vec3& a, const glm::vec3& b, uint32_t& occluder) const {
    const glm::vec3 direction = b - a;
    const Ray ray = {a, direction, inverseOf(direction), 0, 1};
    if (packets_.empty()) return false;
    if (meetPacket(packets_[occluder], ray, 1) < 1) return true;
    bool blocked = false;
    walk(ray, [&](uint32_t packet, float to) {
        if (meetPacket(packets_[packet], ray, to) >= to) return to;
        occluder = packet;
        blocked = true;
        return -1.0f;
    });
    return blocked;
}

} // namespace xgc::bake
