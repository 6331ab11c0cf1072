#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>

// Octahedral unit vectors by +, -, *, / and sqrt alone, so that they are the same on any machine.

namespace xgc::bake {

glm::dvec3 octahedralDecode(const glm::i16vec2& code);

/// The nearest of the four codes around the exact point. Codes have `bits` bits, 8..16, widened to 16. Zero and what is
/// not finite become +z.
glm::i16vec2 octahedralEncode(const glm::dvec3& normal, uint32_t bits = 16);

/// A code of `bits` bits with its sign, -(2^(bits-1) - 1)..2^(bits-1) - 1, widened to 16 by repeating the bits of the
/// magnitude: the largest becomes 32,767.
int16_t widenSnorm(int32_t code, uint32_t bits);

} // namespace xgc::bake
