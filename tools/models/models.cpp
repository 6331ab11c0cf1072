#include <xgc/bake/models.h>

#include "models/makers.h"

#include <algorithm>

namespace xgc::bake {

Model makeModel(BundledModel which, uint32_t faces) {
    faces = std::clamp(faces, kLeastModelFaces, kMostModelFaces);
    switch (which) {
    case BundledModel::creature:
        return models::makeCreature(faces);
    }
    return {};
}

} // namespace xgc::bake
