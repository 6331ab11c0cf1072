#include <xgc/select.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cassert>
#include <cfloat>
#include <cmath>
#include <limits>

// With s = maxScale, r the radius of a patch's sphere and D the distance from the eye to its centre, both policies
// ask whether the sphere is far enough away:
//
//   bands   t * R * s       <= D - r * s          <=>   s * (t * R + r)              <= D
//   error   E * s * k / (D - r * s) <= pixels     <=>   s * (E * k + pixels * r)     <= pixels * D
//
// Both sides are squared, so that D needs no root. The eye inside the sphere (D < r * s) fails by itself.

namespace xgc {
namespace {

struct Sphere {
    glm::vec3 center;
    float radius;
};

Sphere sphereOf(const format::PatchRecord& patch) {
    return {{patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2]}, patch.sphereRadius};
}

/// Squared distance from the eye to a point of mesh space. The translation goes first: moving eye and asset
/// together changes nothing as long as their difference is exact.
float distanceSquared(const Placement& placement, const View& view, const glm::vec3& point) {
    const glm::mat4x3& m = placement.toWorld;
    const glm::vec3 offset = m[3] - view.eye;
    const float x = m[0].x * point.x + m[1].x * point.y + m[2].x * point.z + offset.x;
    const float y = m[0].y * point.x + m[1].y * point.y + m[2].y * point.z + offset.y;
    const float z = m[0].z * point.x + m[1].z * point.y + m[2].z * point.z + offset.z;
    return x * x + y * y + z * z;
}

/// reach <= away, by squares. Squares out of float's normal range decide for the finer level, so that neither
/// overflow nor a GPU's flushing of subnormals can make the answer coarser.
bool reaches(float reach, float awaySquared) {
    const float reachSquared = reach * reach;
    return reachSquared <= awaySquared && reachSquared <= FLT_MAX && awaySquared >= FLT_MIN;
}

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

View makeView(const glm::vec3& eye, float fovY, float viewportHeight) {
    assert(fovY > 0 && fovY < 3.1415926f);
    assert(viewportHeight > 0);
    return {eye, viewportHeight / (2 * glm::tan(fovY / 2))};
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
        const Sphere sphere = sphereOf(asset.patches[patch]);
        const float away = distanceSquared(placement, view, sphere.center);
        size_t level = 0;
        for (; level < coarsest; ++level) {
            const float threshold = policy.thresholds[level];
            // The eye inside the sphere is at distance zero, which such a threshold does not exceed.
            if (threshold <= 0) continue;
            if (!reaches(placement.maxScale * (threshold * radius + sphere.radius), away)) break;
        }
        levels[patch] = uint8_t(level);
    }
}

void select(const AssetView& asset, const Placement& placement, const View& view, const ErrorPixels& policy,
            std::span<uint8_t> levels) {
    checkArguments(asset, placement, view, levels.size());
    assert(policy.pixels >= 0);
    const float pixels = policy.pixels;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        const Sphere sphere = sphereOf(asset.patches[patch]);
        const float away = pixels * pixels * distanceSquared(placement, view, sphere.center);
        uint32_t level = 0;
        for (; level + 1 < asset.levelCount(); ++level) {
            const float error = asset.error(patch, level + 1);
            if (error == 0) continue;
            const float reach = placement.maxScale * (error * view.pixelsPerUnit + pixels * sphere.radius);
            if (!reaches(reach, away)) break;
        }
        levels[patch] = uint8_t(level);
    }
}

float projectedError(const AssetView& asset, const Placement& placement, const View& view,
                     std::span<const uint8_t> levels) {
    checkArguments(asset, placement, view, levels.size());
    double largest = 0;
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        const double error = asset.error(patch, levels[patch]);
        if (error == 0) continue;
        const Sphere sphere = sphereOf(asset.patches[patch]);
        const glm::dvec3 center = glm::dmat4x3(placement.toWorld) * glm::dvec4(sphere.center, 1);
        const double scale = placement.maxScale;
        const double away = glm::length(center - glm::dvec3(view.eye)) - scale * double(sphere.radius);
        if (!(away > 0)) return std::numeric_limits<float>::infinity();
        largest = std::max(largest, error * scale * double(view.pixelsPerUnit) / away);
    }
    return float(largest);
}

} // namespace xgc
