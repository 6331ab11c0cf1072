#include "hierarchy/vanish_components.h"

#include <algorithm>

namespace xgc::bake {

ComponentVanisher::ComponentVanisher(const Pieces& pieces, std::span<const uint32_t> facePatch, SurfaceState& state,
                                     double limit, std::function<bool(uint32_t)> stays)
    : pieces_(pieces), facePatch_(facePatch), state_(state), stays_(std::move(stays)) {
    if (pieces.count() > 1) price(limit);
}

void ComponentVanisher::price(double limit) {
    const Mesh& mesh = state_.mesh;
    const std::vector<uint32_t> bySize = pieces_.bySize();
    std::vector<uint32_t> rank(bySize.size());
    for (uint32_t i = 0; i < rank.size(); ++i) rank[bySize[i]] = i;

    std::vector<Triangle> triangles;
    std::vector<uint32_t> triangleRank;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        triangles.push_back({mesh.positions[p.x], mesh.positions[p.y], mesh.positions[p.z]});
        triangleRank.push_back(rank[pieces_.ofPosition(p.x)]);
    }
    const SurfaceDistance surface(std::move(triangles));
    for (uint32_t i = 1; i < bySize.size(); ++i) {
        const uint32_t c = bySize[i];
        if (stays_(c)) continue;
        double price = pieces_.squaredRadius(c), scale = 1;
        for (const uint32_t p : pieces_.positionsOf(c)) scale = std::max(scale, state_.costScale[p]);
        const auto larger = [&](uint32_t triangle) { return triangleRank[triangle] < i; };
        for (const uint32_t p : pieces_.positionsOf(c)) {
            if (price * scale > limit) break;
            price = std::max(price, surface.nearest(glm::dvec3(mesh.positions[p]), price, limit, larger).squared);
        }
        if (price * scale > limit) continue;
        waiting_.push_back({price * scale, c, carriersOf(c, price, surface, larger)});
    }
    std::sort(waiting_.begin(), waiting_.end(), [](const Piece& a, const Piece& b) {
        return a.price != b.price ? a.price > b.price : a.number > b.number;
    });
}

/// The piece's own patches, and others only where those do not lie within `price`.
uint32_t ComponentVanisher::carriersOf(uint32_t piece, double price, const SurfaceDistance& surface,
                                       const std::function<bool(uint32_t)>& counts) {
    uint32_t carriers = state_.domain[pieces_.positionsOf(piece).front()];
    for (const uint32_t p : pieces_.positionsOf(piece)) carriers = state_.domains.unite(carriers, state_.domain[p]);
    for (const uint32_t p : pieces_.positionsOf(piece)) {
        const glm::dvec3 point(state_.mesh.positions[p]);
        const auto carries = [&](uint32_t triangle) {
            return state_.domains.has(carriers, facePatch_[triangle]) && counts(triangle);
        };
        if (surface.nearest(point, price, price, carries).squared <= price) continue;
        if (state_.domains[carriers].size() >= DomainSets::kWidest) break;
        const SurfaceDistance::Hit hit = surface.nearest(point, 0, price, counts);
        carriers = state_.domains.unite(carriers, state_.domains.single(facePatch_[hit.triangle]));
    }
    return carriers;
}

uint32_t ComponentVanisher::run(uint32_t level, double limit) {
    uint32_t gone = 0;
    while (!waiting_.empty() && waiting_.back().price <= limit) {
        const Piece piece = waiting_.back();
        waiting_.pop_back();
        if (stays_(piece.number)) continue;
        vanish(piece, level);
        ++gone;
    }
    return gone;
}

void ComponentVanisher::vanish(const Piece& piece, uint32_t level) {
    std::vector<uint32_t> alive;
    uint32_t target = kNone;
    for (uint32_t p : pieces_.positionsOf(piece.number)) {
        while (state_.parent[p] != kNone) p = state_.parent[p];
        alive.push_back(p);
    }
    std::sort(alive.begin(), alive.end());
    alive.erase(std::unique(alive.begin(), alive.end()), alive.end());
    target = alive.front();
    uint32_t domain = piece.carriers;
    for (const uint32_t v : alive) domain = state_.domains.unite(domain, state_.domain[v]);
    if (state_.domains[domain].size() > DomainSets::kWidest) return;
    state_.domain[target] = domain;
    for (const uint32_t v : alive) {
        if (!state_.isBoundary[v]) state_.makeBoundary(v);
    }
    for (const uint32_t v : alive) {
        if (v != target) state_.collapseWhole(v, target, domain, level);
    }
}

} // namespace xgc::bake
