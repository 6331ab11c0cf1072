#include "expanded.h"

#include <xgc/indices.h>

#include <algorithm>
#include <numeric>

namespace xgc::bake {
namespace {

uint32_t parentSlot(const AssetView& asset, const format::PatchRecord& patch, uint32_t slot) {
    return patch.flags & format::kWideSlots ? asset.parentsWide[patch.firstParent + slot]
                                            : asset.parentsNarrow[patch.firstParent + slot];
}

uint32_t cornerSlot(const AssetView& asset, const format::PatchRecord& patch, uint32_t corner) {
    return patch.flags & format::kWideSlots ? asset.cornersWide[patch.firstCorner + corner]
                                            : asset.cornersNarrow[patch.firstCorner + corner];
}

/// Vertex rows of a patch's slots.
std::vector<uint32_t> rowsOf(const AssetView& asset, uint32_t patch) {
    std::vector<uint32_t> rows;
    const auto append = [&](format::VertexRange range) {
        for (uint32_t k = 0; k < range.count; ++k) rows.push_back(range.first + k);
    };
    for (const uint32_t d : asset.domainsOf(patch)) append(asset.domainRange(d));
    append(asset.interiorRange(patch));
    return rows;
}

std::vector<std::vector<uint32_t>> adjacency(const AssetView& asset) {
    std::vector<std::vector<uint32_t>> adjacent(asset.patchCount());
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        adjacent[p].push_back(p);
        for (const uint32_t d : asset.domainsOf(p)) {
            const std::span<const uint32_t> sharers = asset.patchesOf(d);
            adjacent[p].insert(adjacent[p].end(), sharers.begin(), sharers.end());
        }
        std::sort(adjacent[p].begin(), adjacent[p].end());
        adjacent[p].erase(std::unique(adjacent[p].begin(), adjacent[p].end()), adjacent[p].end());
    }
    return adjacent;
}

} // namespace

std::vector<uint32_t> pointIds(std::span<const glm::vec3> positions) {
    const auto less = [&](uint32_t i, uint32_t j) {
        const glm::vec3 &a = positions[i], &b = positions[j];
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    std::vector<uint32_t> order(positions.size()), ids(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), less);
    uint32_t id = 0;
    for (size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && less(order[i - 1], order[i])) ++id;
        ids[order[i]] = id;
    }
    return ids;
}

Expanded::Expanded(const AssetView& asset)
    : point(pointIds(asset.positions)), parent(asset.positions.size(), format::kNone),
      domain(asset.positions.size(), format::kNone), adjacentPatches(adjacency(asset)) {
    const uint32_t domainCount = asset.record->domainCount;
    for (uint32_t g = 0; g < domainCount + asset.patchCount(); ++g) {
        const format::VertexRange range = asset.vertexRanges[g];
        std::fill_n(domain.begin() + range.first, range.count, g);
    }
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        const format::PatchRecord& patch = asset.patches[p];
        const std::vector<uint32_t> rows = rowsOf(asset, p);
        for (uint32_t slot = 0; slot < rows.size(); ++slot) {
            parent[rows[slot]] = rows[parentSlot(asset, patch, slot)];
        }
        for (uint32_t f = 0; f < patch.faceCount; ++f) {
            const auto row = [&](uint32_t k) { return rows[cornerSlot(asset, patch, 3 * f + k)]; };
            faces.emplace_back(row(0), row(1), row(2));
            facePatch.push_back(p);
        }
    }
    // One row stands for each end of a border edge: all rows of a point move together.
    std::vector<uint32_t> rowOfPoint(point.size(), format::kNone);
    std::vector<glm::uvec3> triangles;
    for (const glm::uvec3& f : faces) {
        for (int k = 0; k < 3; ++k) rowOfPoint[point[f[k]]] = f[k];
        triangles.emplace_back(point[f.x], point[f.y], point[f.z]);
    }
    for (const EdgeUse& e : countEdges(triangles)) {
        if (e.uses % 2) borders.emplace_back(rowOfPoint[e.edge >> 32], rowOfPoint[uint32_t(e.edge)]);
    }
}

std::vector<uint32_t> representatives(const AssetView& asset, const Expanded& expanded,
                                      std::span<const uint8_t> levels) {
    const uint32_t domainCount = asset.record->domainCount;
    std::vector<uint32_t> rangeLevel(domainCount + asset.patchCount());
    for (uint32_t d = 0; d < domainCount; ++d) {
        uint32_t least = format::kNever;
        for (const uint32_t p : asset.patchesOf(d)) least = std::min<uint32_t>(least, levels[p]);
        rangeLevel[d] = least;
    }
    for (uint32_t p = 0; p < asset.patchCount(); ++p) rangeLevel[domainCount + p] = levels[p];
    std::vector<uint32_t> rep(expanded.point.size());
    for (uint32_t v = 0; v < rep.size(); ++v) {
        uint32_t r = v;
        while (asset.collapseLevels[r] <= rangeLevel[expanded.domain[r]]) r = expanded.parent[r];
        rep[v] = r;
    }
    return rep;
}

std::vector<EdgeUse> countEdges(const std::vector<glm::uvec3>& triangles) {
    std::vector<uint64_t> keys;
    keys.reserve(3 * triangles.size());
    for (const glm::uvec3& t : triangles) {
        for (int k = 0; k < 3; ++k) keys.push_back(edgeKey(t[k], t[(k + 1) % 3]));
    }
    std::sort(keys.begin(), keys.end());
    std::vector<EdgeUse> edges;
    for (const uint64_t key : keys) {
        if (edges.empty() || edges.back().edge != key) edges.push_back({key, 0});
        ++edges.back().uses;
    }
    return edges;
}

} // namespace xgc::bake
