#pragma once

#include "asset_grid.h"

#include <string>

namespace xgc::headless {

/// What a frame did, as a line of JSON:
///
///     {"frame":3,"triangles":81234,"patchesChanged":5,"patchesRebuilt":17,"uploadBytes":40800,"deferred":0,
///      "levels":[[12,4,0],[0,2,14]]}
///
/// `levels`: for each instance, how many patches are drawn at each level; empty before it is first drawn.
std::string frameLine(uint32_t frame, const vulkan::Renderer& renderer, const std::vector<SceneInstance>& instances);

} // namespace xgc::headless
