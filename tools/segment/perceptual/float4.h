#pragma once

#include <cstdint>
#include <cstring>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace xgc::bake {

/// Four numbers side by side: each is computed as it would be alone, on any machine.
using Float4 = float __attribute__((vector_size(16)));
using Mask4 = int32_t __attribute__((vector_size(16))); ///< of a comparison: 0 or -1

inline Float4 fill4(float x) {
    return Float4{x, x, x, x};
}
inline Float4 min4(Float4 a, Float4 b) {
    return a < b ? a : b;
}
inline Float4 max4(Float4 a, Float4 b) {
    return a > b ? a : b;
}

/// Bit i: lane i holds.
inline uint32_t bitsOf(Mask4 mask) {
#ifdef __SSE__
    __m128 lanes;
    static_assert(sizeof(lanes) == sizeof(mask));
    std::memcpy(&lanes, &mask, sizeof(mask));
    return uint32_t(_mm_movemask_ps(lanes));
#else
    return uint32_t((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}

} // namespace xgc::bake
