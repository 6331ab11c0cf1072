#include "hierarchy/vanish_components.h"

#include "bake/surface_distance.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace xgc::bake {

namespace {

constexpr size_t kWidestDomain = 16;

uint32_t findRoot(std::vector<uint32_t>& parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

} // namespace

ComponentVanisher::ComponentVanisher(const Topology& topology, std::span<const uint32_t> facePatch, SurfaceState& state,
                                     double limit)
    : state_(state), facePatch_(facePatch) {
    if (topology.componentCount < 2) return;
    group(topology);
    if (first_.size() > 2) price(limit);
}

/// Components that touch at a vertex are one.
void ComponentVanisher::group(const Topology& topology) {
    const Mesh& mesh = state_.mesh;
    std::vector<uint32_t> root(topology.componentCount);
    std::iota(root.begin(), root.end(), 0u);
    std::vector<uint32_t> firstOf(mesh.positions.size(), kNone);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            uint32_t& first = firstOf[corners[k]];
            if (first == kNone) first = topology.faceComponent[f];
            const uint32_t a = findRoot(root, first), b = findRoot(root, topology.faceComponent[f]);
            root[std::max(a, b)] = std::min(a, b);
        }
    }
    std::vector<uint32_t> number(root.size(), kNone);
    uint32_t count = 0;
    for (uint32_t c = 0; c < root.size(); ++c) {
        const uint32_t r = findRoot(root, c);
        if (number[r] == kNone) number[r] = count++;
        number[c] = number[r];
    }
    componentOf_.resize(mesh.positions.size());
    first_.assign(count + 1, 0);
    for (uint32_t p = 0; p < componentOf_.size(); ++p) {
        componentOf_[p] = number[firstOf[p]];
        ++first_[componentOf_[p] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    positions_.resize(mesh.positions.size());
    std::vector<uint32_t> slot(first_.begin(), first_.end() - 1);
    for (uint32_t p = 0; p < componentOf_.size(); ++p) positions_[slot[componentOf_[p]]++] = p;
}

void ComponentVanisher::price(double limit) {
    const Mesh& mesh = state_.mesh;
    const auto count = uint32_t(first_.size() - 1);
    std::vector<double> squaredRadius(count);
    for (uint32_t c = 0; c < count; ++c) {
        glm::dvec3 low(mesh.positions[positionsOf(c).front()]), high = low;
        for (const uint32_t p : positionsOf(c)) {
            low = glm::min(low, glm::dvec3(mesh.positions[p]));
            high = glm::max(high, glm::dvec3(mesh.positions[p]));
        }
        squaredRadius[c] = glm::dot(high - low, high - low) / 4;
    }
    std::vector<uint32_t> bySize(count), rank(count);
    std::iota(bySize.begin(), bySize.end(), 0u);
    std::stable_sort(bySize.begin(), bySize.end(),
                     [&](uint32_t a, uint32_t b) { return squaredRadius[a] > squaredRadius[b]; });
    for (uint32_t i = 0; i < count; ++i) rank[bySize[i]] = i;

    std::vector<Triangle> triangles;
    std::vector<uint32_t> triangleRank;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        triangles.push_back({mesh.positions[p.x], mesh.positions[p.y], mesh.positions[p.z]});
        triangleRank.push_back(rank[componentOf_[p.x]]);
    }
    const SurfaceDistance surface(std::move(triangles));
    for (uint32_t i = 1; i < count; ++i) {
        const uint32_t c = bySize[i];
        double price = squaredRadius[c], scale = 1;
        for (const uint32_t p : positionsOf(c)) scale = std::max(scale, state_.costScale[p]);
        const auto larger = [&](uint32_t triangle) { return triangleRank[triangle] < i; };
        for (const uint32_t p : positionsOf(c)) {
            if (price * scale > limit) break;
            price = std::max(price, surface.nearest(glm::dvec3(mesh.positions[p]), price, limit, larger).squared);
        }
        if (price * scale > limit) continue;
        waiting_.push_back({price * scale, c, carriersOf(c, price, surface, larger)});
    }
    std::sort(waiting_.begin(), waiting_.end(), [](const Component& a, const Component& b) {
        return a.price != b.price ? a.price > b.price : a.number > b.number;
    });
}

/// The component's own patches, and others only where those do not lie within `price`.
uint32_t ComponentVanisher::carriersOf(uint32_t component, double price, const SurfaceDistance& surface,
                                       const std::function<bool(uint32_t)>& counts) {
    uint32_t carriers = state_.domain[positionsOf(component).front()];
    for (const uint32_t p : positionsOf(component)) carriers = state_.domains.unite(carriers, state_.domain[p]);
    for (const uint32_t p : positionsOf(component)) {
        const glm::dvec3 point(state_.mesh.positions[p]);
        const auto carries = [&](uint32_t triangle) {
            return state_.domains.has(carriers, facePatch_[triangle]) && counts(triangle);
        };
        if (surface.nearest(point, price, price, carries).squared <= price) continue;
        if (state_.domains[carriers].size() >= kWidestDomain) break;
        const SurfaceDistance::Hit hit = surface.nearest(point, 0, price, counts);
        carriers = state_.domains.unite(carriers, state_.domains.single(facePatch_[hit.triangle]));
    }
    return carriers;
}

uint32_t ComponentVanisher::run(uint32_t level, double limit) {
    uint32_t gone = 0;
    while (!waiting_.empty() && waiting_.back().price <= limit) {
        vanish(waiting_.back(), level);
        waiting_.pop_back();
        ++gone;
    }
    return gone;
}

void ComponentVanisher::vanish(const Component& component, uint32_t level) {
    std::vector<uint32_t> alive;
    uint32_t target = kNone;
    for (uint32_t p : positionsOf(component.number)) {
        while (state_.parent[p] != kNone) p = state_.parent[p];
        alive.push_back(p);
    }
    std::sort(alive.begin(), alive.end());
    alive.erase(std::unique(alive.begin(), alive.end()), alive.end());
    target = alive.front();
    uint32_t domain = component.carriers;
    for (const uint32_t v : alive) domain = state_.domains.unite(domain, state_.domain[v]);
    if (state_.domains[domain].size() > kWidestDomain) return;
    state_.domain[target] = domain;
    const uint32_t wedge = state_.wedgesOf(target).front();
    for (const uint32_t v : alive) {
        if (!state_.isBoundary[v]) state_.makeBoundary(v);
        if (v == target) continue;
        state_.collapseLevel[v] = uint8_t(level);
        state_.parent[v] = target;
        state_.domain[v] = domain;
        for (const uint32_t w : state_.wedgesOf(v)) state_.wedgeParent[w] = wedge;
        state_.forGroup(v, [&](uint32_t m) {
            state_.representative[m] = target;
            for (const uint32_t w : state_.wedgesOf(m)) state_.wedgeRepresentative[w] = wedge;
        });
        std::swap(state_.groupNext[v], state_.groupNext[target]);
    }
}

} // namespace xgc::bake
