#include <xgc/select.h>

#include "largest_scale.h"
#include "level_test.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>

namespace xgc {
namespace {

void checkArguments([[maybe_unused]] const AssetView& asset, [[maybe_unused]] const Placement& placement,
                    [[maybe_unused]] const View& view, [[maybe_unused]] size_t levels) {
    assert(levels >= asset.patchCount());
    assert(placement.maxScale > 0 && "use makePlacement");
    assert(view.pixelsPerUnit >= 0 && "use makeView");
}

[[maybe_unused]] bool rising(std::span<const float> thresholds) {
    for (size_t i = 0; i < thresholds.size(); ++i) {
        if (std::isnan(thresholds[i]) || (i && thresholds[i] < thresholds[i - 1])) return false;
    }
    return true;
}

/// Clears the entry (p, q) of a symmetric matrix by a rotation in that plane.
void rotateAway(glm::dmat3& a, int p, int q) {
    if (a[p][q] == 0) return;
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    glm::dmat3 g(1);
    g[p][p] = g[q][q] = c;
    g[p][q] = -s;
    g[q][p] = s;
    a = glm::transpose(g) * a * g;
}

/// Largest singular value by Jacobi's method on the Gram matrix; what is left off the diagonal is added
/// (Gershgorin), so the value is never too small.
double largestSingularValue(const glm::dmat3& m) {
    glm::dmat3 a = glm::transpose(m) * m;
    for (int sweep = 0; sweep < 8; ++sweep) {
        rotateAway(a, 0, 1);
        rotateAway(a, 0, 2);
        rotateAway(a, 1, 2);
    }
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        largest = std::max(largest, std::fabs(a[i][0]) + std::fabs(a[i][1]) + std::fabs(a[i][2]));
    return std::sqrt(largest);
}

float roundedUp(double value) {
    const auto nearest = float(value);
    return double(nearest) < value ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

} // namespace

float largestScale(const glm::mat3& linear) {
    return roundedUp(largestSingularValue(glm::dmat3(linear)));
}

View makeView(const glm::vec3& eye, float fovY, float viewportHeight) {
    assert(fovY > 0 && fovY < 3.1415926f);
    assert(viewportHeight > 0);
    return {.eye = eye, .pixelsPerUnit = viewportHeight / (2 * glm::tan(fovY / 2))};
}

Placement makePlacement(const glm::mat4& toWorld) {
    assert(toWorld[0].w == 0 && toWorld[1].w == 0 && toWorld[2].w == 0 && toWorld[3].w == 1 && "not affine");
    const Placement placement{glm::mat4x3(toWorld), roundedUp(largestSingularValue(glm::dmat3(toWorld)))};
    assert(placement.maxScale > 0 && placement.maxScale <= FLT_MAX && "the matrix is zero or not finite");
    return placement;
}

void select(const AssetView& asset, const Placement& placement, const View& view, const DistanceBands& policy,
            std::span<uint8_t> levels) {
    checkArguments(asset, placement, view, levels.size());
    assert(rising(policy.thresholds));
    const size_t coarsest = std::min<size_t>(policy.thresholds.size(), asset.levelCount() - 1);
    const float radius = asset.record->sphereRadius;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        const Standing at = standing(placement, view, sphereOf(asset.patches[patch]));
        size_t level = 0;
        while (level < coarsest && bandReached(policy.thresholds[level], radius, at)) ++level;
        levels[patch] = uint8_t(level);
    }
}

void select(const AssetView& asset, const Placement& placement, const View& view, const ErrorPixels& policy,
            std::span<uint8_t> levels) {
    checkArguments(asset, placement, view, levels.size());
    assert(policy.pixels >= 0);
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        const Standing at = errorStanding(placement, view, sphereOf(asset.patches[patch]));
        const auto fits = [&](uint32_t level) { return errorFits(asset.error(patch, level), view, policy.pixels, at); };
        uint32_t level = 0;
        while (level + 1 < asset.levelCount() && fits(level + 1)) ++level;
        levels[patch] = uint8_t(level);
    }
}

View makeOrthographicView(const glm::vec3& eye, const glm::vec3& forward, float height, float viewportHeight) {
    assert(height > 0 && viewportHeight > 0);
    return {
        .eye = eye, .pixelsPerUnit = viewportHeight / height, .orthographic = true, .forward = glm::normalize(forward)};
}

float projectedError(const AssetView& asset, const Placement& placement, const View& view,
                     std::span<const uint8_t> levels) {
    checkArguments(asset, placement, view, levels.size());
    double largest = 0;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        const double error = asset.error(patch, levels[patch]);
        if (error == 0) continue;
        if (view.orthographic) {
            largest = std::max(largest, error * double(placement.maxScale) * double(view.pixelsPerUnit));
            continue;
        }
        const Sphere sphere = sphereOf(asset.patches[patch]);
        const glm::dvec3 center = glm::dmat4x3(placement.toWorld) * glm::dvec4(sphere.center, 1);
        const double scale = placement.maxScale;
        const double bounds = glm::length(center - glm::dvec3(view.eye)) - scale * double(sphere.radius);
        const double away = std::max(bounds, double(view.nearest));
        if (!(away > 0)) return std::numeric_limits<float>::infinity();
        largest = std::max(largest, error * scale * double(view.pixelsPerUnit) / away);
    }
    return float(largest);
}

} // namespace xgc
