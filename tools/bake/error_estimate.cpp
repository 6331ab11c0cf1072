#include "surface_distance.h"

#include <xgc/bake/error.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

// E never falls with the level, so a level starts from the largest deviations of the one before, and a sample only
// matters where it lies farther from the other surface than that: most queries end at the first triangle that is
// near enough.

namespace xgc::bake {
namespace {

constexpr double kEstimateMargin = 1.3;
constexpr uint32_t kChunkFaces = 2048;

/// Faces to sample, sorted by patch.
struct SampledFaces {
    std::vector<Triangle> faces;
    std::vector<uint32_t> patch;
};

SampledFaces sortByPatch(const std::vector<Triangle>& faces, const std::vector<uint32_t>& patch, uint32_t patchCount) {
    std::vector<uint32_t> next(patchCount + 1, 0);
    for (const uint32_t p : patch) ++next[p + 1];
    for (uint32_t p = 0; p < patchCount; ++p) next[p + 1] += next[p];
    SampledFaces sorted{std::vector<Triangle>(faces.size()), std::vector<uint32_t>(faces.size())};
    for (size_t i = 0; i < faces.size(); ++i) {
        const uint32_t k = next[patch[i]]++;
        sorted.faces[k] = faces[i];
        sorted.patch[k] = patch[i];
    }
    return sorted;
}

double largestDeviation(const Triangle& face, const SurfaceDistance& surface, double worst) {
    const glm::dvec3 a(face.a), b(face.b), c(face.c);
    for (const glm::dvec3& p : {a, b, c, (a + b + c) / 3.0, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0}) {
        worst = std::max(worst, surface.squared(p, worst));
    }
    return worst;
}

/// Raises `worst` (squared, per patch) by the deviation of the faces from the surface.
void raise(const SampledFaces& sampled, const SurfaceDistance& surface, std::vector<double>& worst) {
    const auto count = uint32_t(sampled.faces.size());
    const uint32_t chunks = (count + kChunkFaces - 1) / kChunkFaces;
    std::vector<std::vector<std::pair<uint32_t, double>>> found(chunks); // the worst of each patch in a chunk
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, chunks, 1), [&](const tbb::blocked_range<uint32_t>& range) {
        for (uint32_t chunk = range.begin(); chunk != range.end(); ++chunk) {
            const uint32_t last = std::min(count, (chunk + 1) * kChunkFaces);
            for (uint32_t f = chunk * kChunkFaces; f < last; ++f) {
                const uint32_t patch = sampled.patch[f];
                if (found[chunk].empty() || found[chunk].back().first != patch) {
                    found[chunk].emplace_back(patch, worst[patch]);
                }
                double& w = found[chunk].back().second;
                w = largestDeviation(sampled.faces[f], surface, w);
            }
        }
    });
    for (const auto& chunk : found) {
        for (const auto& [patch, distance] : chunk) worst[patch] = std::max(worst[patch], distance);
    }
}

std::vector<Triangle> corners(const std::vector<glm::uvec3>& triangles, const Hierarchy& h) {
    std::vector<Triangle> out;
    out.reserve(triangles.size());
    const auto at = [&](uint32_t wedge) { return h.positions[h.wedgePosition[wedge]]; };
    for (const glm::uvec3& t : triangles) out.push_back({at(t.x), at(t.y), at(t.z)});
    return out;
}

/// The least float at or above a double.
float roundedUp(double value) {
    const auto f = float(value);
    return double(f) < value ? std::nextafter(f, INFINITY) : f;
}

} // namespace

PatchErrors estimateErrors(const Mesh& mesh, const Hierarchy& hierarchy, const std::function<bool(double)>& progress) {
    const uint32_t patchCount = hierarchy.patchCount(), levelCount = hierarchy.levelCount;
    PatchErrors errors;
    errors.values.assign(size_t(patchCount) * levelCount, 0.0f);
    const std::vector<Triangle> base = corners(mesh.faces, hierarchy);
    const SurfaceDistance baseSurface(base);
    const SampledFaces baseFaces = sortByPatch(base, hierarchy.facePatch, patchCount);

    std::vector<double> worst(patchCount, 0.0);
    for (uint32_t level = 1; level < levelCount; ++level) {
        const DrawnSurface drawn = drawSurface(mesh, hierarchy, std::vector<uint8_t>(patchCount, uint8_t(level)));
        std::vector<uint32_t> patch;
        patch.reserve(drawn.face.size());
        for (const uint32_t f : drawn.face) patch.push_back(hierarchy.facePatch[f]);
        std::vector<Triangle> faces = corners(drawn.triangles, hierarchy);
        raise(sortByPatch(faces, patch, patchCount), baseSurface, worst);
        raise(baseFaces, SurfaceDistance(std::move(faces)), worst);
        for (uint32_t p = 0; p < patchCount; ++p) {
            errors.values[size_t(p) * levelCount + level] = roundedUp(std::sqrt(worst[p]) * kEstimateMargin);
        }
        if (progress && !progress(double(level) / (levelCount - 1))) break;
    }
    return errors;
}

} // namespace xgc::bake
