#pragma once

#include <glm/mat3x3.hpp>

namespace xgc {

/// Largest singular value, never too small (select.cpp).
float largestScale(const glm::mat3& linear);

} // namespace xgc
