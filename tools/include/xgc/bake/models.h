#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake {

/// The bundled models, made by code, the same on any machine.
enum class BundledModel { creature, shaft, terrain, temple };

/// Makes a model of about `faces` triangles (within some 10 %).
Model makeModel(BundledModel which, uint32_t faces);

} // namespace xgc::bake
