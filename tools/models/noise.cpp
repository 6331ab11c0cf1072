#include "models/noise.h"

namespace xgc::bake::models {
namespace {

float fade(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/// Slopes are drawn from a square, not a circle: no root, and no visible difference.
float slopeAt(glm::ivec2 cell, glm::vec2 offset, uint32_t seed) {
    const uint32_t h = hash(cell.x, cell.y, 0, seed);
    return signedUnit(h) * offset.x + signedUnit(hash(h + 1)) * offset.y;
}

} // namespace

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

} // namespace xgc::bake::models
