#include "picking.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace xgc::viewer {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// Where a ray with a unit direction enters a sphere; 0 inside of it, kNone where it misses.
float entry(const Ray& ray, const glm::vec3& center, float radius) {
    const glm::vec3 toCenter = center - ray.origin;
    const float along = glm::dot(toCenter, ray.direction);
    const float off2 = glm::dot(toCenter, toCenter) - along * along;
    const float reach2 = radius * radius - off2;
    if (reach2 < 0) return kNone;
    const float reach = std::sqrt(reach2);
    return along + reach < 0 ? kNone : std::max(along - reach, 0.0f);
}

/// Möller and Trumbore 1997, both sides.
float meet(const Ray& ray, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a;
    const glm::vec3 p = glm::cross(ray.direction, ac);
    const float det = glm::dot(ab, p);
    if (det == 0) return kNone;
    const glm::vec3 t = ray.origin - a;
    const float u = glm::dot(t, p) / det;
    const glm::vec3 q = glm::cross(t, ab);
    const float v = glm::dot(ray.direction, q) / det;
    if (u < 0 || v < 0 || u + v > 1) return kNone;
    const float along = glm::dot(ac, q) / det;
    return along >= 0 ? along : kNone;
}

Ray toMesh(const Ray& ray, const glm::mat4x3& toWorld) {
    const glm::mat4 toMesh = glm::inverse(glm::mat4(glm::vec4(toWorld[0], 0), glm::vec4(toWorld[1], 0),
                                                    glm::vec4(toWorld[2], 0), glm::vec4(toWorld[3], 1)));
    return {glm::vec3(toMesh * glm::vec4(ray.origin, 1)),
            glm::normalize(glm::vec3(toMesh * glm::vec4(ray.direction, 0)))};
}

struct Candidate {
    float entry;
    uint32_t patch;
};

/// Patches in sight whose spheres the ray enters, the nearest first.
std::vector<Candidate> candidates(const DrawnAsset& drawn, const Ray& ray) {
    std::vector<Candidate> out;
    for (uint32_t patch = 0; patch < drawn.asset->patchCount(); ++patch) {
        if (!drawn.visible[patch]) continue;
        const format::PatchRecord& record = drawn.asset->patches[patch];
        const float* c = record.sphereCenter;
        const float at = entry(ray, {c[0], c[1], c[2]}, record.sphereRadius);
        if (at < kNone) out.push_back({at, patch});
    }
    std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) { return a.entry < b.entry; });
    return out;
}

/// Of an asset in mesh space; `along` in mesh units.
std::optional<Hit> pickAsset(const DrawnAsset& drawn, const Ray& ray) {
    const AssetView& asset = *drawn.asset;
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
    std::optional<Hit> best;
    float nearest = kNone;
    for (const Candidate& candidate : candidates(drawn, ray)) {
        if (candidate.entry > nearest) break;
        indices.resize(indexCapacity(asset, candidate.patch, drawn.levels));
        const uint32_t count = buildIndices(asset, candidate.patch, drawn.levels, scratch, indices);
        for (uint32_t i = 0; i + 2 < count; i += 3) {
            const float along = meet(ray, asset.positions[indices[i]], asset.positions[indices[i + 1]],
                                     asset.positions[indices[i + 2]]);
            if (!(along < nearest)) continue;
            nearest = along;
            best = Hit{0, candidate.patch, asset.patches[candidate.patch].part, along, {}};
        }
    }
    return best;
}

} // namespace

Ray rayThrough(const vulkan::Camera& camera, const glm::vec2& place) {
    const vulkan::Camera::Basis basis = camera.basis();
    const float half = std::tan(camera.fovY / 2);
    const float x = (2 * place.x - 1) * half * camera.aspect, y = (1 - 2 * place.y) * half;
    return {camera.eye, glm::normalize(basis.forward + x * basis.right + y * basis.up)};
}

std::optional<Hit> pick(std::span<const DrawnAsset> assets, const Ray& ray) {
    std::optional<Hit> best;
    for (uint32_t i = 0; i < assets.size(); ++i) {
        const Ray local = toMesh(ray, assets[i].toWorld);
        std::optional<Hit> hit = pickAsset(assets[i], local);
        if (!hit) continue;
        hit->asset = i;
        hit->position = assets[i].toWorld * glm::vec4(local.origin + hit->along * local.direction, 1);
        hit->along = glm::dot(hit->position - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction);
        if (!best || hit->along < best->along) best = hit;
    }
    return best;
}

} // namespace xgc::viewer
