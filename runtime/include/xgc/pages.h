#pragma once

#include <xgc/asset.h>

namespace xgc {

// What each page of an asset of several tiers holds. The tables tell it, by running sums: the rows of a domain lie in
// the page that the domain's first patch has in the domain's tier, those of an interior in the patch's page of the last
// tier; parents and corners of a patch lie in its own page of each tier, patch by patch.

/// Elements of the streams of one page.
struct PageContents {
    uint32_t rows = 0;
    uint64_t narrowSlots = 0, wideSlots = 0; ///< parents
    uint64_t narrowFaces = 0, wideFaces = 0; ///< corners: three a face
};

/// What one tier adds to a patch, and where that begins in the streams of the page.
struct PatchTier {
    uint32_t page = 0;
    uint32_t firstSlot = 0, slotCount = 0; ///< of the patch
    uint32_t firstParent = 0;              ///< in the page's stream of the patch's width
    uint32_t firstList = 0, listCount = 0; ///< of the patch
    uint32_t firstFace = 0;                ///< of its lists before it, in the page's stream
    uint32_t faceCount = 0;
};

/// Filled by mapPages; the memory is the caller's.
struct PageMap {
    std::span<PageContents> pages;   ///< AssetView::pages
    std::span<uint32_t> rangePages;  ///< AssetView::vertexRanges: page of the rows
    std::span<uint32_t> rangeRows;   ///< AssetView::vertexRanges: first of its rows among those of the page
    std::span<PatchTier> patchTiers; ///< AssetView::patchPages
};

/// Of an asset of several tiers whose tables are open.
void mapPages(const AssetView& tables, const PageMap& map);

/// Refuses pages whose streams have other counts than the tables say, or lack one that is needed.
Status checkPageContents(const AssetView& tables, const PageMap& map);

} // namespace xgc
