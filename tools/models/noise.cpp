#include "models/noise.h"

namespace xgc::bake::models {
namespace {

float fade(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/// Slopes are drawn from a cube, not a sphere: no root, and no visible difference.
float slopeAt(glm::ivec3 cell, glm::vec3 offset, uint32_t seed) {
    const uint32_t h = hash(cell.x, cell.y, cell.z, seed);
    const glm::vec3 slope(signedUnit(h), signedUnit(hash(h + 1)), signedUnit(hash(h + 2)));
    return glm::dot(slope, offset);
}

float slopeAt(glm::ivec2 cell, glm::vec2 offset, uint32_t seed) {
    const uint32_t h = hash(cell.x, cell.y, 0, seed);
    return signedUnit(h) * offset.x + signedUnit(hash(h + 1)) * offset.y;
}

} // namespace

float gradientNoise(glm::vec3 p, uint32_t seed) {
    const glm::vec3 base(std::floor(p.x), std::floor(p.y), std::floor(p.z));
    const glm::ivec3 cell(base);
    const glm::vec3 f = p - base;
    const glm::vec3 w(fade(f.x), fade(f.y), fade(f.z));
    float sum = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, (i >> 1) & 1, i >> 2);
        const float weight = (corner.x ? w.x : 1 - w.x) * (corner.y ? w.y : 1 - w.y) * (corner.z ? w.z : 1 - w.z);
        sum += weight * slopeAt(cell + corner, f - glm::vec3(corner), seed);
    }
    return sum * 1.2f;
}

float gradientNoise(glm::vec2 p, uint32_t seed) {
    const glm::vec2 base(std::floor(p.x), std::floor(p.y));
    const glm::ivec2 cell(base);
    const glm::vec2 f = p - base;
    const glm::vec2 w(fade(f.x), fade(f.y));
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
        const glm::ivec2 corner(i & 1, i >> 1);
        const float weight = (corner.x ? w.x : 1 - w.x) * (corner.y ? w.y : 1 - w.y);
        sum += weight * slopeAt(cell + corner, f - glm::vec2(corner), seed);
    }
    return sum * 1.5f;
}

glm::vec2 cellNoise(glm::vec3 p, uint32_t seed) {
    const glm::ivec3 cell(int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z)));
    float nearest = 9, second = 9;
    for (int i = 0; i < 27; ++i) {
        const glm::ivec3 c = cell + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const uint32_t h = hash(c.x, c.y, c.z, seed);
        const glm::vec3 jitter(signedUnit(h), signedUnit(hash(h + 1)), signedUnit(hash(h + 2)));
        const glm::vec3 d = glm::vec3(c) + 0.5f + 0.4f * jitter - p;
        const float square = glm::dot(d, d);
        second = square < nearest ? nearest : glm::min(second, square);
        nearest = glm::min(nearest, square);
    }
    return {std::sqrt(nearest), std::sqrt(second)};
}

} // namespace xgc::bake::models
