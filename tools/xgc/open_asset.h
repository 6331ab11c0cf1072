#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/status.h>

#include <vector>

namespace xgc::tool {

/// An `.xgc` file in memory, decoded where it was compressed, and its view.
struct OpenAsset {
    bake::AlignedBytes bytes;
    AssetView view;
    uint64_t fileBytes = 0;                    ///< of the file as it lies on disk
    std::vector<format::StreamRecord> streams; ///< as the file stores them, beside the view's
};

/// Reads and opens an asset; the message names the file, the element and the remedy.
bake::Status openAsset(const std::string& file, OpenAsset& out);

} // namespace xgc::tool
