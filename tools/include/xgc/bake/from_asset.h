#pragma once

#include <xgc/asset.h>
#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <span>

namespace xgc::bake {

/// The surface of an asset in a state as a model: the triangles that xgc::buildIndices draws, patch after patch, over
/// the rows that they use, rising, with decoded attributes. Every part is a node by its name; the nodes of the source
/// scene follow. `levels` has an entry below levelCount for each patch; anything else is a usage error that names the
/// limits. On failure `out` is untouched.
Status modelFromAsset(const AssetView& asset, std::span<const uint8_t> levels, Model& out);

} // namespace xgc::bake
