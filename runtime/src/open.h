#pragma once

#include <xgc/asset.h>

// The steps of `openTables` and `openAll`. Each reads what the steps before it have proved, fills its part of the
// view or checks it, and names the first element that breaks a rule of FORMAT.md.

namespace xgc {

inline Status corrupt(const char* message, uint64_t element = 0) {
    return {StatusCode::corrupt, message, element};
}

inline Status unsupported(const char* message, uint64_t element = 0) {
    return {StatusCode::unsupported, message, element};
}

inline constexpr uint64_t alignUp(uint64_t offset) {
    return (offset + format::kAlignment - 1) / format::kAlignment * format::kAlignment;
}

/// Header and sections: where each lies, and that it is unaltered; their codecs are not looked at (open.cpp).
Status checkContainer(std::span<const std::byte> bytes);

/// Of bytes that passed `checkContainer`.
std::span<const format::SectionRecord> sectionsOf(std::span<const std::byte> bytes);

/// Relations within and between the tables (check_tables.cpp).
Status checkTables(const AssetView& view);

/// What is told of pages in a file of several tiers, and where each lies (check_pages.cpp).
Status checkPageTables(const AssetView& view);

/// A stream's place, size and format, and that it follows `before`, which ends at `end` (open_page.cpp).
Status checkStreamRecord(const format::StreamRecord& stream, const format::StreamRecord* before, uint64_t end,
                         uint64_t pageBytes, uint64_t index);
/// Joints and blend shapes: of the tables, and of rows in `streams` (check_pose.cpp).
Status checkSkins(const AssetView& view);
Status checkMorphTargets(const AssetView& view);
Status checkSkinRows(const AssetView& tables, std::span<const VertexStream> streams, uint32_t rowCount);

/// Installs the streams of the one page of version 2 (open_page.cpp).
Status installPage(AssetView& view);

/// What the streams hold, row by row, slot by slot, face by face (check_page.cpp).
Status checkPage(const AssetView& view);

} // namespace xgc
