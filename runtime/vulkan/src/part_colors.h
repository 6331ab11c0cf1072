#pragma once

#include <xgc/asset.h>

#include <vector>

namespace xgc::vulkan {

/// A colour for each part, below `colorCount`, unlike those of its neighbours wherever the neighbours leave one free.
/// Deterministic; in order of parts, each takes the least used colour that is free.
std::vector<uint8_t> colorParts(const AssetView& asset, uint32_t colorCount);

} // namespace xgc::vulkan
