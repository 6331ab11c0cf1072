#include "ray_tree.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// Nodes this deep are split by count: 16 levels more at most.
constexpr uint32_t kMostByPlace = RayTree::kMostDepth - 16;
constexpr size_t kLeafSize = 4;

/// Axis-aligned; the fourth lane is idle.
struct Box {
    Float4 low = fill4(1e30f), high = fill4(-1e30f);
    void add(const Box& box) {
        low = min4(low, box.low);
        high = max4(high, box.high);
    }
    Float4 center() const { return (low + high) * 0.5f; }
    /// Half of the surface.
    float area() const {
        const Float4 d = high - low;
        return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
};

/// A triangle on its way to a leaf.
struct Item {
    Box box;
    uint32_t triangle, bin;
};

Float4 lanesOf(const glm::vec3& p) {
    return Float4{p.x, p.y, p.z, 0};
}

constexpr size_t kBins = 8;

/// What a range is split by: the longest axis of its centres, in bins.
struct Bins {
    size_t axis = 0;
    float low = 0, scale = 0; ///< scale 0: all centres in one place
    uint32_t of(const Box& box) const {
        const float center = (box.low[axis] + box.high[axis]) * 0.5f;
        return uint32_t(int((center - low) * scale));
    }
};

Bins binsOf(std::span<const Item> items) {
    Box centers;
    for (const Item& item : items) {
        const Float4 center = item.box.center();
        centers.add({center, center});
    }
    const Float4 extent = centers.high - centers.low;
    Bins bins;
    bins.axis = extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : extent[1] >= extent[2] ? 1 : 2;
    bins.low = centers.low[bins.axis];
    if (extent[bins.axis] > 0) bins.scale = float(kBins) * 0.9999f / extent[bins.axis];
    return bins;
}

/// The bin before which the surface area heuristic is least; 0 where no plane parts anything.
size_t bestPlane(const std::array<Box, kBins>& boxes, const std::array<uint32_t, kBins>& counts) {
    std::array<Box, kBins> after; // a bin and all behind it
    after[kBins - 1] = boxes[kBins - 1];
    uint32_t rightCount = 0;
    for (size_t b = kBins - 1; b-- > 0;) {
        after[b] = boxes[b];
        after[b].add(after[b + 1]);
        rightCount += counts[b + 1];
    }
    Box before;
    uint32_t leftCount = 0;
    size_t best = 0;
    float least = 1e38f;
    for (size_t plane = 1; plane < kBins; ++plane) {
        before.add(boxes[plane - 1]);
        leftCount += counts[plane - 1];
        if (plane > 1) rightCount -= counts[plane - 1];
        if (leftCount == 0 || rightCount == 0) continue;
        const float cost = before.area() * float(leftCount) + after[plane].area() * float(rightCount);
        if (cost >= least) continue;
        least = cost;
        best = plane;
    }
    return best;
}

/// A range in two, the lower part first.
struct Split {
    size_t at, axis;
};

/// Parts a range in two where the surface area heuristic is least, of seven planes across the longest axis of the
/// centres; by count where those part nothing.
Split split(std::span<Item> items, uint32_t depth) {
    const size_t half = items.size() / 2;
    if (depth >= kMostByPlace) return {half, 0};
    const Bins bins = binsOf(items);
    if (!(bins.scale > 0)) return {half, 0};
    std::array<Box, kBins> boxes;
    std::array<uint32_t, kBins> counts = {};
    for (Item& item : items) {
        item.bin = bins.of(item.box);
        boxes[item.bin].add(item.box);
        ++counts[item.bin];
    }
    const size_t best = bestPlane(boxes, counts);
    size_t left = 0;
    for (Item& item : items) { // without a branch, which would be taken at random
        const bool isLeft = item.bin < best;
        std::swap(item, items[left]);
        left += isLeft;
    }
    return {left == 0 || left == items.size() ? half : left, bins.axis};
}

constexpr size_t kWidth = RayScene::kWidth;
/// Of a node: the split before child i is along axis [i].
using Axes = std::array<size_t, kWidth>;

/// Children in the order of a ray that goes down along the axes whose bits are set, the farthest first.
uint32_t farthestFirst(uint32_t octant, const Axes& axes) {
    uint32_t order = 0;
    for (uint32_t i = 0; i < kWidth; ++i) {
        uint32_t child = 0;
        for (uint32_t step = kWidth / 2; step > 0; step /= 2) {
            const uint32_t isDown = octant >> axes[child + step] & 1, isLate = i & step ? 1 : 0;
            if (isDown == isLate) child += step;
        }
        order |= child << RayScene::kChildBits * i;
    }
    return order;
}

class Builder {
public:
    explicit Builder(std::span<const glm::vec3> soup) : soup_(soup), items_(soup.size() / 3) {
        for (uint32_t t = 0; t < items_.size(); ++t) {
            for (uint32_t k = 0; k < 3; ++k) {
                const Float4 corner = lanesOf(soup[3 * t + k]);
                items_[t].box.add({corner, corner});
            }
            items_[t].triangle = t;
        }
    }

    RayTree run() {
        tree_.nodes.reserve(items_.size() / 4 + 1);
        tree_.packets.reserve(items_.size() / 2 + 1);
        tree_.root = items_.size() <= kLeafSize ? addPacket(items_) : addNode(items_, 0);
        return std::move(tree_);
    }

private:
    uint32_t addPacket(std::span<const Item> items) {
        RayScene::Packet packet = {};
        for (size_t lane = 0; lane < items.size(); ++lane) {
            const glm::vec3* corners = &soup_[3 * items[lane].triangle];
            const glm::vec3 a = corners[0], u = corners[1] - a, v = corners[2] - a;
            for (int k = 0; k < 3; ++k) {
                packet.corner[size_t(k)][lane] = a[k];
                packet.edge1[size_t(k)][lane] = u[k];
                packet.edge2[size_t(k)][lane] = v[k];
            }
        }
        tree_.packets.push_back(packet);
        return RayScene::kLeaf | uint32_t(tree_.packets.size() - 1);
    }

    /// Splits within splits, until there is a range a child.
    uint32_t addNode(std::span<Item> items, uint32_t depth) {
        const auto index = uint32_t(tree_.nodes.size());
        tree_.nodes.emplace_back();
        std::array<std::span<Item>, kWidth> parts = {items};
        Axes axes = {};
        for (size_t step = kWidth / 2; step > 0; step /= 2) {
            for (size_t i = 0; i < kWidth; i += 2 * step) {
                if (parts[i].size() <= kLeafSize) continue;
                const Split at = split(parts[i], depth);
                axes[i + step] = at.axis;
                parts[i + step] = parts[i].subspan(at.at);
                parts[i] = parts[i].first(at.at);
            }
        }
        for (uint32_t octant = 0; octant < 8; ++octant) tree_.nodes[index].order[octant] = farthestFirst(octant, axes);
        for (size_t i = 0; i < kWidth; ++i) addChild(index, i, parts[i], depth);
        return index;
    }

    void addChild(uint32_t node, size_t i, std::span<Item> items, uint32_t depth) {
        Box box;
        for (const Item& item : items) box.add(item.box);
        for (size_t k = 0; k < 3; ++k) {
            tree_.nodes[node].planes[k][0][i / 4][i % 4] = box.low[k];
            tree_.nodes[node].planes[k][1][i / 4][i % 4] = box.high[k];
        }
        if (items.empty()) return;
        const uint32_t child = items.size() <= kLeafSize ? addPacket(items) : addNode(items, depth + 1);
        tree_.nodes[node].child[i] = child;
    }

    std::span<const glm::vec3> soup_;
    std::vector<Item> items_;
    RayTree tree_;
};

} // namespace

RayTree buildRayTree(std::span<const glm::vec3> soup) {
    return Builder(soup).run();
}

} // namespace xgc::bake
