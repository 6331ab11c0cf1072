#pragma once

#include <xgc/bake/mesh.h>

#include <cstddef>
#include <span>
#include <vector>

namespace xgc::bake {

/// How an asset is cut for streaming (xgc/residency.h).
struct PageOptions {
    /// Most tiers of levels, each with about half of the vertices of the next finer one; 1: no pages, one file to be
    /// opened as a whole. The coarsest is always in memory: a share of 2^-(tiers - 1), where levels reach so far. At
    /// most format::kMaxTiers.
    uint32_t tiers = 1;
    /// As many neighbouring patches a page as fit, uncompressed; one patch at least, which is never cut.
    uint32_t pageBytes = 64 * 1024;
    bool compress = false; ///< streams of pages as zstd frames, where that makes them smaller
    int zstdLevel = 12;
};

/// Cuts an image that layOutAsset made for several tiers into pages: the same asset in a file that is opened by its
/// tables and read page by page. xgc::decode joins the pages to the image again, bit for bit. Where the image has one
/// tier alone the bytes stay as they are.
Status cutIntoPages(std::span<const std::byte> image, const PageOptions& options, std::vector<std::byte>& out);

} // namespace xgc::bake
