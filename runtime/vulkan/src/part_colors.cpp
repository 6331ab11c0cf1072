#include "part_colors.h"

namespace xgc::vulkan {

std::vector<uint8_t> colorParts(const AssetView& asset, uint32_t colorCount) {
    constexpr uint8_t kUncolored = 255;
    std::vector<uint8_t> colors(asset.parts.size(), kUncolored);
    std::vector<uint32_t> uses(colorCount, 0);
    std::vector<uint32_t> takenBy(colorCount, format::kNone); ///< last part that found the colour beside it
    for (uint32_t part = 0; part < asset.parts.size(); ++part) {
        const format::PartRecord& record = asset.parts[part];
        for (const uint32_t other : asset.partNeighbours.subspan(record.firstNeighbour, record.neighbourCount)) {
            if (colors[other] != kUncolored) takenBy[colors[other]] = part;
        }
        uint32_t best = colorCount;
        for (uint32_t c = 0; c < colorCount; ++c) {
            if (takenBy[c] != part && (best == colorCount || uses[c] < uses[best])) best = c;
        }
        if (best == colorCount) best = part % colorCount;
        colors[part] = uint8_t(best);
        ++uses[best];
    }
    return colors;
}

} // namespace xgc::vulkan
