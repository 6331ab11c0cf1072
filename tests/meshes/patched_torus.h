#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

/// A closed mesh with a hierarchy that is known by construction, and its asset in memory: for tests and benchmarks
/// of what lies behind the hierarchy builders.
namespace xgc::test {

struct Patched {
    bake::Mesh mesh;
    bake::Segmentation parts;
    bake::Hierarchy hierarchy;
    bake::PatchErrors errors;
};

struct TorusShape {
    uint32_t patches = 4; ///< around and along, at least 2
    uint32_t levels = 3;  ///< a patch has 2^levels x 2^levels quads at level 0 and one at the last
    uint32_t materials = 2;
    uint32_t repeatedLevels = 0; ///< coarser levels that draw what the last one draws
};

namespace detail {

inline bake::Mesh torusMesh(const TorusShape& shape) {
    bake::Mesh mesh;
    const uint32_t n = shape.patches << shape.levels;
    for (uint32_t j = 0; j < n; ++j) {
        for (uint32_t i = 0; i < n; ++i) {
            const float u = 6.2831853f * float(i) / float(n), v = 6.2831853f * float(j) / float(n);
            const float r = 2 + std::cos(v);
            mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), std::sin(v));
            mesh.wedgePosition.push_back(j * n + i);
        }
    }
    for (uint32_t j = 0; j < n; ++j) {
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t i1 = (i + 1) % n, j1 = (j + 1) % n;
            mesh.faces.emplace_back(j * n + i, j * n + i1, j1 * n + i1);
            mesh.faces.emplace_back(j * n + i, j1 * n + i1, j1 * n + i);
        }
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) mesh.faceInput.push_back(f);
    mesh.faceNode.assign(mesh.faces.size(), bake::kNone);
    mesh.inputFaceCount = mesh.faceCount();
    mesh.materials.resize(shape.materials);
    return mesh;
}

/// Patches that hold a coordinate: two on a line between patches.
inline std::vector<uint32_t> patchesAt(uint32_t x, const TorusShape& shape) {
    const uint32_t p = x >> shape.levels;
    if (x & ((1u << shape.levels) - 1)) return {p};
    return {p, (p + shape.patches - 1) % shape.patches};
}

} // namespace detail

/// A vertex at (i, j) collapses when the grid of its patch becomes too coarse to hold it, to the nearest lower
/// vertex that stays one level longer: along the line where it lies between two patches.
inline Patched patchedTorus(const TorusShape& shape) {
    Patched built;
    built.mesh = detail::torusMesh(shape);
    bake::Mesh& mesh = built.mesh;
    bake::Hierarchy& h = built.hierarchy;
    const uint32_t n = shape.patches << shape.levels, patchCount = shape.patches * shape.patches;
    h.levelCount = shape.levels + 1 + shape.repeatedLevels;
    h.levelThreshold.assign(h.levelCount, 0);
    h.positions = mesh.positions;
    h.wedgePosition = mesh.wedgePosition;
    h.birthLevel.assign(n * n, 0);
    for (uint32_t p = 0; p < patchCount; ++p) {
        h.patches.push_back({p, p % shape.materials});
        built.parts.partNames.push_back("part" + std::to_string(p));
        for (uint32_t level = 0; level < h.levelCount; ++level)
            built.errors.values.push_back(0.01f * float((1u << std::min(level, shape.levels)) - 1));
    }
    const auto zeros = [&](uint32_t x) { return std::min(uint32_t(std::countr_zero(x | n)), shape.levels); };
    for (uint32_t j = 0; j < n; ++j) {
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t stays = std::min(zeros(i), zeros(j));
            const bool collapses = stays < shape.levels;
            h.collapseLevel.push_back(collapses ? uint8_t(stays + 1) : bake::kNeverCollapses);
            const uint32_t pi = zeros(i) == stays ? i - (1u << stays) : i,
                           pj = zeros(j) == stays ? j - (1u << stays) : j;
            h.wedgeParent.push_back(collapses ? pj * n + pi : bake::kNone);

            std::vector<uint32_t> domain;
            for (const uint32_t q : detail::patchesAt(j, shape)) {
                for (const uint32_t p : detail::patchesAt(i, shape)) domain.push_back(q * shape.patches + p);
            }
            std::sort(domain.begin(), domain.end());
            const auto known = std::find(h.domainPatches.begin(), h.domainPatches.end(), domain);
            h.domain.push_back(uint32_t(known - h.domainPatches.begin()));
            if (known == h.domainPatches.end()) h.domainPatches.push_back(domain);
        }
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const uint32_t quad = f / 2, i = quad % n, j = quad / n;
        const uint32_t patch = (j >> shape.levels) * shape.patches + (i >> shape.levels);
        h.facePatch.push_back(patch);
        built.parts.facePart.push_back(patch);
        mesh.faceMaterial.push_back(patch % shape.materials);
    }
    return built;
}

/// An asset in memory, opened.
struct OpenAsset {
    bake::AlignedBytes bytes;
    AssetView view;
    std::string failure; ///< empty where it opened
};

inline OpenAsset openBuilt(const Patched& built, uint32_t tiers = 1) {
    OpenAsset asset;
    std::vector<std::byte> bytes;
    const bake::Status laidOut =
        bake::layOutAsset(built.mesh, built.parts, built.hierarchy, built.errors, true, "{}", bytes, tiers);
    if (!laidOut.ok()) {
        asset.failure = laidOut.message;
        return asset;
    }
    asset.bytes.blocks.resize((bytes.size() + 63) / 64);
    asset.bytes.size = bytes.size();
    std::memcpy(asset.bytes.blocks.data(), bytes.data(), bytes.size());
    const Status opened = openAll(asset.bytes.span(), asset.view);
    if (!opened.ok()) asset.failure = opened.message;
    return asset;
}

} // namespace xgc::test
