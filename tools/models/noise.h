#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstdint>

/// Lattice noise from an integer hash: the same on any machine.
namespace xgc::bake::models {

inline uint32_t hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

inline uint32_t hash(int32_t x, int32_t y, int32_t z, uint32_t seed) {
    return hash(uint32_t(x) + hash(uint32_t(y) + hash(uint32_t(z) + hash(seed))));
}

/// In [-1, 1).
inline float signedUnit(uint32_t h) {
    return float(h >> 8) * (2.0f / 16777216.0f) - 1.0f;
}

/// Gradient noise of the plane in about [-1, 1] with a period of one unit, twice differentiable.
float gradientNoise(glm::vec2 p, uint32_t seed);

} // namespace xgc::bake::models
