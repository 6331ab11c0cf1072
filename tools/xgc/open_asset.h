#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/status.h>

namespace xgc::tool {

/// An `.xgc` file in memory and its view.
struct OpenAsset {
    bake::AlignedBytes bytes;
    AssetView view;
};

/// Reads and opens an asset; the message names the file, the element and the remedy.
bake::Status openAsset(const std::string& file, OpenAsset& out);

} // namespace xgc::tool
