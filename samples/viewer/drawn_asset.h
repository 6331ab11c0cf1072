#pragma once

#include <xgc/asset.h>
#include <xgc/indices.h>
#include <xgc/select.h>

#include <glm/mat4x3.hpp>

namespace xgc::viewer {

/// An asset as it is drawn at a moment: what is picked from and compared.
struct DrawnAsset {
    const AssetView* asset = nullptr;
    glm::mat4x3 toWorld{1};
    Levels levels;
    std::span<const uint8_t> visible; ///< a patch each; 0: not drawn
};

/// The largest error of what is visible as a view sees it, in pixels.
float worstErrorPixels(std::span<const DrawnAsset> assets, const View& view);

} // namespace xgc::viewer
