#include <xgc/bake/models.h>

#include "models/makers.h"

#include <algorithm>

namespace xgc::bake {

Model makeModel(BundledModel which, uint32_t faces) {
    faces = std::clamp(faces, kLeastModelFaces, kMostModelFaces);
    switch (which) {
    case BundledModel::creature:
        return models::makeCreature(faces);
    case BundledModel::shaft:
        return models::makeShaft(faces);
    case BundledModel::terrain:
        return models::makeTerrain(faces);
    case BundledModel::temple:
        return models::makeTemple(faces);
    case BundledModel::tree:
        return models::makeTree(faces);
    }
    return {};
}

} // namespace xgc::bake
