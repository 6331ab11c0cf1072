#include "bake/octahedral.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstdlib>

namespace xgc::bake {
namespace {

double signOf(double value) {
    return value < 0 ? -1.0 : 1.0;
}

/// Folds the lower half of the octahedron out, or back in: the same map.
glm::dvec2 fold(const glm::dvec2& p) {
    return {(1 - std::abs(p.y)) * signOf(p.x), (1 - std::abs(p.x)) * signOf(p.y)};
}

} // namespace

int16_t widenSnorm(int32_t code, uint32_t bits) {
    if (bits == 16) return int16_t(code);
    const uint32_t b = bits - 1, magnitude = uint32_t(std::abs(code));
    const uint64_t repeat = (uint64_t(1) << (2 * b)) | (uint64_t(1) << b) | 1;
    const auto wide = int32_t((magnitude * repeat) >> (3 * b - 15));
    return int16_t(code < 0 ? -wide : wide);
}

glm::dvec3 octahedralDecode(const glm::i16vec2& e) {
    glm::dvec2 p(e.x / 32767.0, e.y / 32767.0);
    const double z = 1 - std::abs(p.x) - std::abs(p.y);
    if (z < 0) p = fold(p);
    const glm::dvec3 n(p.x, p.y, z);
    return n / std::sqrt(glm::dot(n, n));
}

glm::i16vec2 octahedralEncode(const glm::dvec3& n, uint32_t bits) {
    const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (!(sum > 0) || !std::isfinite(sum)) return {0, 0};
    glm::dvec2 p(n.x / sum, n.y / sum);
    if (n.z < 0) p = fold(p);
    const double most = double((1u << (bits - 1)) - 1);
    const glm::dvec2 low = glm::floor(p * most);
    glm::i16vec2 best(0);
    double bestDot = -2 * sum;
    for (int i = 0; i < 4; ++i) {
        const glm::dvec2 code = glm::clamp(low + glm::dvec2(i & 1, i >> 1), -most, most);
        const glm::i16vec2 candidate(widenSnorm(int32_t(code.x), bits), widenSnorm(int32_t(code.y), bits));
        const double dot = glm::dot(octahedralDecode(candidate), n);
        if (dot > bestDot) {
            bestDot = dot;
            best = candidate;
        }
    }
    return best;
}

} // namespace xgc::bake
