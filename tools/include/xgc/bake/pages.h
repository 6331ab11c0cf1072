#pragma once

#include <xgc/bake/mesh.h>

#include <cstddef>
#include <span>
#include <vector>

namespace xgc::bake {

/// How an asset is cut for streaming (xgc/residency.h).
struct PageOptions {
    /// Most tiers of levels, the finest with about a quarter of the vertices of the next; 1: no pages, one file to be
    /// opened as a whole. At most format::kMaxTiers.
    uint32_t tiers = 1;
    uint32_t pageBytes = 64 * 1024; ///< about so large, uncompressed; a patch is never cut
    bool compress = false;          ///< streams of pages as zstd frames, where that makes them smaller
    int zstdLevel = 12;
};

/// Cuts an image that layOutAsset made for several tiers into pages: the same asset in a file that is opened by its
/// tables and read page by page. xgc::decode joins the pages to the image again, bit for bit. Where the image has one
/// tier alone the bytes stay as they are.
Status cutIntoPages(std::span<const std::byte> image, const PageOptions& options, std::vector<std::byte>& out);

} // namespace xgc::bake
