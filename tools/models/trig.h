#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstdint>

/// Elementary functions that give the same bits on any machine: the C library's differ in their last bits. Built on
/// +, -, x, /, sqrt and floor, which IEEE 754 fixes.
namespace xgc::bake::models {

struct SinCos {
    double sine;
    double cosine;
};

/// Sine and cosine of an angle in turns (1 is a full circle): Taylor series over an eighth of a circle.
inline SinCos sinCosTurns(double turns) {
    const double eighths = std::floor(turns * 4 + 0.5);
    const double x = (turns - eighths * 0.25) * 6.283185307179586476925;
    const double y = x * x;
    const double s = x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 + y * (1.0 / 362880 - y / 39916800)))));
    const double c =
        1 + y * (-0.5 + y * (1.0 / 24 + y * (-1.0 / 720 + y * (1.0 / 40320 + y * (-1.0 / 3628800 + y / 479001600)))));
    switch (int64_t(eighths) & 3) {
    case 0:
        return {s, c};
    case 1:
        return {c, -s};
    case 2:
        return {-s, -c};
    default:
        return {-c, s};
    }
}

/// A point of the unit circle, for polar coordinates in any plane.
inline glm::vec2 circlePoint(double turns) {
    const SinCos a = sinCosTurns(turns);
    return {float(a.cosine), float(a.sine)};
}

/// Rotations about the axes by turns, right-handed.
inline glm::mat3 rotationX(double turns) {
    const glm::vec2 c = circlePoint(turns);
    return {glm::vec3(1, 0, 0), glm::vec3(0, c.x, c.y), glm::vec3(0, -c.y, c.x)};
}
inline glm::mat3 rotationY(double turns) {
    const glm::vec2 c = circlePoint(turns);
    return {glm::vec3(c.x, 0, -c.y), glm::vec3(0, 1, 0), glm::vec3(c.y, 0, c.x)};
}
inline glm::mat3 rotationZ(double turns) {
    const glm::vec2 c = circlePoint(turns);
    return {glm::vec3(c.x, c.y, 0), glm::vec3(-c.y, c.x, 0), glm::vec3(0, 0, 1)};
}

inline float smoothStep(float low, float high, float x) {
    const float t = glm::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

} // namespace xgc::bake::models
