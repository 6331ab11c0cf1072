#include "surface_distance.h"

#include <xgc/bake/error.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

// E never falls with the level, so a level starts from the largest deviations of the one before, and a sample only
// matters where it lies farther from the other surface than that. Few samples do, and most are told so cheaply:
//
//   drawn to input   only triangles that the level before did not draw are measured;
//   input to drawn   a face that is drawn as it is deviates by nothing; else what its own image, or the triangle
//                    that was near it at the level before, leaves unproved is looked up in a tree.

namespace xgc::bake {
namespace {

constexpr double kEstimateMargin = 1.3;
constexpr uint32_t kChunkFaces = 2048;

/// Squared deviations, the largest of each patch.
using Worst = std::vector<double>;

/// Calls `measure(face, worst)` for the faces of a list, in parallel, and raises the worst of their patches. What a
/// chunk starts from does not depend on the others, so neither does the result.
template <typename Measure>
void forFaces(const std::vector<uint32_t>& faces, const std::vector<uint32_t>& facePatch, Worst& worst,
              const Measure& measure) {
    const auto count = uint32_t(faces.size());
    const uint32_t chunks = (count + kChunkFaces - 1) / kChunkFaces;
    std::vector<std::vector<std::pair<uint32_t, double>>> found(chunks); // the worst of each patch in a chunk
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, chunks, 1), [&](const tbb::blocked_range<uint32_t>& range) {
        for (uint32_t chunk = range.begin(); chunk != range.end(); ++chunk) {
            const uint32_t last = std::min(count, (chunk + 1) * kChunkFaces);
            for (uint32_t i = chunk * kChunkFaces; i < last; ++i) {
                const uint32_t patch = facePatch[faces[i]];
                if (found[chunk].empty() || found[chunk].back().first != patch) {
                    found[chunk].emplace_back(patch, worst[patch]);
                }
                measure(faces[i], found[chunk].back().second);
            }
        }
    });
    for (const auto& chunk : found) {
        for (const auto& [patch, squared] : chunk) worst[patch] = std::max(worst[patch], squared);
    }
}

std::array<glm::dvec3, 7> samplesOf(const Triangle& t) {
    const glm::dvec3 a(t.a), b(t.b), c(t.c);
    return {a, b, c, (a + b + c) / 3.0, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0};
}

class Estimator {
public:
    Estimator(const Mesh& mesh, const Hierarchy& hierarchy)
        : mesh_(mesh), h_(hierarchy), base_(allCorners(mesh.faces)), inputSurface_(base_), image_(mesh.faces),
          hint_(mesh.faces.size()), faces_(mesh.faces.size()), worst_(hierarchy.patchCount(), 0.0) {
        for (uint32_t f = 0; f < hint_.size(); ++f) hint_[f] = f;
        // By patch, so that a chunk meets few of them.
        for (uint32_t f = 0; f < faces_.size(); ++f) faces_[f] = f;
        std::stable_sort(faces_.begin(), faces_.end(),
                         [&](uint32_t a, uint32_t b) { return h_.facePatch[a] < h_.facePatch[b]; });
    }

    /// Takes the levels in turn.
    const Worst& measure(uint32_t level) {
        const DrawnSurface drawn = drawSurface(mesh_, h_, std::vector<uint8_t>(h_.patchCount(), uint8_t(level)));
        std::vector<uint32_t> fresh;
        std::vector<glm::uvec3> image(mesh_.faces.size(), glm::uvec3(kNone));
        for (size_t i = 0; i < drawn.face.size(); ++i) {
            image[drawn.face[i]] = drawn.triangles[i];
            if (image_[drawn.face[i]] != drawn.triangles[i]) fresh.push_back(drawn.face[i]);
        }
        image_ = std::move(image);
        forFaces(fresh, h_.facePatch, worst_, [&](uint32_t face, double& worst) { measureImage(face, worst); });
        const SurfaceDistance surface(allCorners(drawn.triangles));
        forFaces(faces_, h_.facePatch, worst_,
                 [&](uint32_t face, double& worst) { measureInput(face, surface, drawn, worst); });
        return worst_;
    }

private:
    Triangle corners(const glm::uvec3& t) const {
        const auto at = [&](uint32_t wedge) { return h_.positions[h_.wedgePosition[wedge]]; };
        return {at(t.x), at(t.y), at(t.z)};
    }

    std::vector<Triangle> allCorners(const std::vector<glm::uvec3>& triangles) const {
        std::vector<Triangle> out;
        out.reserve(triangles.size());
        for (const glm::uvec3& t : triangles) out.push_back(corners(t));
        return out;
    }

    void measureImage(uint32_t face, double& worst) const {
        for (const glm::dvec3& p : samplesOf(corners(image_[face]))) {
            worst = std::max(worst, inputSurface_.nearest(p, worst).squared);
        }
    }

    /// Whether the image of `face` lies within `worst` of all samples.
    bool isNear(const std::array<glm::dvec3, 7>& samples, uint32_t face, double worst) const {
        if (image_[face].x == kNone) return false;
        const Triangle t = corners(image_[face]);
        return std::all_of(samples.begin(), samples.end(),
                           [&](const glm::dvec3& p) { return squaredDistance(p, t.a, t.b, t.c) <= worst; });
    }

    void measureInput(uint32_t face, const SurfaceDistance& surface, const DrawnSurface& drawn, double& worst) {
        if (image_[face] == mesh_.faces[face]) return;
        const std::array<glm::dvec3, 7> samples = samplesOf(base_[face]);
        if (isNear(samples, face, worst) || isNear(samples, hint_[face], worst)) return;
        for (const glm::dvec3& p : samples) {
            const SurfaceDistance::Hit hit = surface.nearest(p, worst);
            worst = std::max(worst, hit.squared);
            if (!drawn.face.empty()) hint_[face] = drawn.face[hit.triangle];
        }
    }

    const Mesh& mesh_;
    const Hierarchy& h_;
    const std::vector<Triangle> base_;
    const SurfaceDistance inputSurface_;
    std::vector<glm::uvec3> image_; ///< what each face is drawn as; kNone where it is degenerate
    std::vector<uint32_t> hint_;    ///< face whose image was near each face; written by its own chunk alone
    std::vector<uint32_t> faces_;
    Worst worst_;
};

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
    Estimator estimator(mesh, hierarchy);
    for (uint32_t level = 1; level < levelCount; ++level) {
        const Worst& worst = estimator.measure(level);
        for (uint32_t p = 0; p < patchCount; ++p) {
            errors.values[size_t(p) * levelCount + level] = roundedUp(std::sqrt(worst[p]) * kEstimateMargin);
        }
        if (progress && !progress(double(level) / (levelCount - 1))) break;
    }
    return errors;
}

} // namespace xgc::bake
