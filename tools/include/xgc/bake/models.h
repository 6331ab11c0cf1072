#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake {

/// The bundled models, made by code: the same bits on any machine and compiler.
enum class BundledModel {
    creature, ///< a small dragon, blended implicit surfaces: closed manifold, smooth, vertex colours
    shaft,    ///< a turned machine part with grooves, keyway, hexagon and splines: closed, hard creases
    terrain,  ///< an open height field with mountains and a river: uvs, vertex colours
    temple,   ///< many pieces by name, five materials, uv seams; closed stones, open roof and ground
    tree,     ///< closed bark and thousands of leaf cards, open pieces of two triangles each
};

/// Faces that can be asked for.
inline constexpr uint32_t kLeastModelFaces = 200;
inline constexpr uint32_t kMostModelFaces = 8'000'000;

/// Makes a model of about `faces` triangles (within 10 %), clamped to the limits.
Model makeModel(BundledModel which, uint32_t faces);

} // namespace xgc::bake
