#include "models/implicit.h"

#include <cmath>
#include <limits>

namespace xgc::bake::models {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Covers the rounding of distances when blobs are left out.
constexpr float kSlack = 1e-5f;

/// Polynomial smooth minimum: exactly the minimum where the two differ by `width` or more.
float melt(float a, float b, float width) {
    const float h = glm::max(width - std::abs(a - b), 0.0f) / width;
    return glm::min(a, b) - h * h * width * 0.25f;
}

float sign(float x) {
    return x > 0 ? 1.0f : x < 0 ? -1.0f : 0.0f;
}

} // namespace

Blob ellipsoid(glm::vec3 center, glm::vec3 radii, const glm::mat3& axes, float blend, Skin skin) {
    Blob blob;
    blob.blend = blend;
    blob.skin = skin;
    blob.framed = true;
    blob.origin = center;
    const glm::mat3 shrink(1 / radii.x, 0, 0, 0, 1 / radii.y, 0, 0, 0, 1 / radii.z);
    blob.toFrame = shrink * glm::transpose(axes);
    blob.scale = glm::min(radii.x, glm::min(radii.y, radii.z));
    return blob;
}

Blob roundCone(glm::vec3 a, float radiusA, glm::vec3 b, float radiusB, float blend, Skin skin) {
    Blob blob;
    blob.a = a;
    blob.b = b;
    blob.radiusA = radiusA;
    blob.radiusB = radiusB;
    blob.blend = blend;
    blob.skin = skin;
    return blob;
}

void Body::add(const Blob& blob) {
    Cone cone{};
    cone.axis = blob.b - blob.a;
    cone.length2 = glm::dot(cone.axis, cone.axis);
    cone.difference = blob.radiusA - blob.radiusB;
    cone.slant2 = cone.length2 - cone.difference * cone.difference;
    cone.ball = cone.slant2 <= 0;
    cone.inverse = cone.ball ? 0 : 1 / cone.length2;
    blobs.push_back(blob);
    cones_.push_back(cone);
}

BlobList Body::all() const {
    BlobList list(blobs.size());
    for (size_t i = 0; i < list.size(); ++i) list[i] = uint16_t(i);
    return list;
}

/// After I. Quilez's exact distance to a rounded cone.
float Body::distance(uint32_t index, glm::vec3 p) const {
    const Blob& blob = blobs[index];
    const Cone& cone = cones_[index];
    if (blob.framed) p = blob.toFrame * (p - blob.origin);
    const glm::vec3 d = p - blob.a;
    if (cone.ball) return (std::sqrt(glm::dot(d, d)) - blob.radiusA) * blob.scale;
    const float y = glm::dot(d, cone.axis);
    const float z = y - cone.length2;
    const glm::vec3 across = d * cone.length2 - cone.axis * y;
    const float x2 = glm::dot(across, across);
    const float y2 = y * y * cone.length2;
    const float z2 = z * z * cone.length2;
    const float k = sign(cone.difference) * cone.difference * cone.difference * x2;
    float result = 0;
    if (sign(z) * cone.slant2 * z2 > k) {
        result = std::sqrt(x2 + z2) * cone.inverse - blob.radiusB;
    } else if (sign(y) * cone.slant2 * y2 < k) {
        result = std::sqrt(x2 + y2) * cone.inverse - blob.radiusA;
    } else {
        result = (std::sqrt(x2 * cone.slant2 * cone.inverse) + y * cone.difference) * cone.inverse - blob.radiusA;
    }
    return result * blob.scale;
}

float Body::field(glm::vec3 p, const BlobList& list) const {
    float f = kInfinity;
    for (const uint16_t i : list) {
        const float d = distance(i, p);
        f = blobs[i].carve ? -melt(-f, d, blobs[i].blend) : melt(f, d, blobs[i].blend);
    }
    return f;
}

glm::vec3 Body::normal(glm::vec3 p, float step, const BlobList& list) const {
    const glm::vec3 a(1, -1, -1), b(-1, -1, 1), c(-1, 1, -1), d(1, 1, 1);
    const glm::vec3 g = a * field(p + a * step, list) + b * field(p + b * step, list) + c * field(p + c * step, list) +
                        d * field(p + d * step, list);
    const float length = std::sqrt(glm::dot(g, g));
    return length > 0 ? g / length : glm::vec3(0, 1, 0);
}

Skin Body::skin(glm::vec3 p, const BlobList& list) const {
    float f = kInfinity;
    Skin result;
    for (const uint16_t i : list) {
        const Blob& blob = blobs[i];
        const float d = distance(i, p);
        const float before = f;
        f = blob.carve ? -melt(-f, d, blob.blend) : melt(f, d, blob.blend);
        const float lead = blob.carve ? -d - before : before - d;
        const float share = before == kInfinity ? 1 : glm::clamp(0.5f + 0.5f * lead / blob.blend, 0.0f, 1.0f);
        const bool same = result.material == blob.skin.material;
        // Colours melt within a material and meet sharply between two.
        const float weight = same ? share * share * (3 - 2 * share) : share > 0.5f ? 1.0f : 0.0f;
        result.color = result.color + (blob.skin.color - result.color) * weight;
        if (share > 0.5f) result.material = blob.skin.material;
    }
    return result;
}

glm::vec2 Body::bounds(glm::vec3 center, float radius, const BlobList& list, BlobList& kept) const {
    kept.clear();
    const float reach = radius + kSlack;
    float low = kInfinity, high = kInfinity;
    for (const uint16_t i : list) {
        const float width = blobs[i].blend;
        const float d = distance(i, center);
        const float near = d - reach, far = d + reach;
        if (blobs[i].carve) {
            if (near + low >= width) continue;
            low = -melt(-low, far, width);
            high = -melt(-high, near, width);
        } else if (near >= high + width) {
            continue;
        } else if (low >= far + width) {
            kept.clear();
            low = near;
            high = far;
        } else {
            low = melt(low, near, width);
            high = melt(high, far, width);
        }
        kept.push_back(i);
    }
    return {low, high};
}

} // namespace xgc::bake::models
