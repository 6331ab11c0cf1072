#pragma once

#include "asset.h"
#include "flags.h"

#include <xgc/select.h>

#include <glm/vec3.hpp>

#include <memory>

namespace xgc::bench {

/// Where a camera stands and looks.
struct Pose {
    glm::vec3 eye, target;
};

/// An asset, instances of it, and a flight through them.
struct ViewScene {
    std::string name;
    OpenAsset asset;
    AssetView grey; ///< the asset with all materials alike: pictures compare shapes, normals and vertex colours
    std::vector<format::MaterialRecord> greyMaterials;
    std::vector<Placement> instances;
    std::vector<Pose> flight;
    std::vector<bool> close; ///< a frame each: nearer than half the asset's radius to its bounds, or in them
    float nearest = 0;       ///< near plane
};

inline constexpr uint32_t kFlightFrames = 40;

/// Those that the flags want, and that this machine has: terrain, temple, creatures, dragon, helmet.
bake::Status viewScenes(const Flags& flags, std::vector<std::unique_ptr<ViewScene>>& out);

} // namespace xgc::bench
