#pragma once

#include <xgc/asset.h>

#include <glm/vec2.hpp>

#include <vector>

namespace xgc::bake {

/// Ids of exact coordinates, equal where coordinates are (-0 equals 0), dense.
std::vector<uint32_t> pointIds(std::span<const glm::vec3> positions);

/// An asset's tables without slots, prefixes and face lists but the finest: one row of columns per vertex and face.
struct Expanded {
    explicit Expanded(const AssetView& asset);

    std::vector<uint32_t> point;   ///< vertex: id of its exact coordinates (-0 equals 0)
    std::vector<uint32_t> parent;  ///< vertex: row it collapses into
    std::vector<uint32_t> domain;  ///< vertex: domain, or domainCount + patch for an interior
    std::vector<glm::uvec3> faces; ///< rows at level 0
    std::vector<uint32_t> facePatch;
    std::vector<glm::uvec2> borders; ///< point pairs used an odd number of times at level 0, by one row each
    std::vector<std::vector<uint32_t>> adjacentPatches; ///< rising, the patch itself included
};

/// A state by definition: the representative of each row.
std::vector<uint32_t> representatives(const AssetView& asset, const Expanded& expanded,
                                      std::span<const uint8_t> levels);

/// Edges of triangles over point ids with the number of their uses, sorted.
struct EdgeUse {
    uint64_t edge; ///< lower id << 32 | higher id
    uint32_t uses;
};
std::vector<EdgeUse> countEdges(const std::vector<glm::uvec3>& triangles);

inline uint64_t edgeKey(uint32_t a, uint32_t b) {
    return a < b ? uint64_t(a) << 32 | b : uint64_t(b) << 32 | a;
}

} // namespace xgc::bake
