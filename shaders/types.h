// What lets one header serve C++ and GLSL. Structs are laid out as std430 with 16-byte vectors only, so that both sides
// agree without padding rules; addresses are 64 bits, a pair of words in GLSL.
#ifndef XGC_SHADERS_TYPES_H
#define XGC_SHADERS_TYPES_H

#ifdef __cplusplus
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstdint>

namespace xgc::shader {

using uint = uint32_t;
using vec4 = glm::vec4;
using mat4 = glm::mat4;
using Address = uint64_t;
#define XGC_CONST inline constexpr

} // namespace xgc::shader
#else
#define Address uvec2
#define XGC_CONST const
#endif

#endif
