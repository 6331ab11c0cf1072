#pragma once

#include <xgc/bake/model.h>

namespace xgc::bake::models {

Model makeCreature(uint32_t faces);
Model makeShaft(uint32_t faces);
Model makeTerrain(uint32_t faces);
Model makeTemple(uint32_t faces);
Model makeTree(uint32_t faces);

} // namespace xgc::bake::models
