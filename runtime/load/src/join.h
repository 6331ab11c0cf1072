#pragma once

#include <xgc/load.h>

// Files that are cut into pages: joined to the image of one page that they were cut from (join.cpp).

namespace xgc::load {

/// True for a file whose container is sound and that has several pages.
bool isCut(std::span<const std::byte> file);

Status joinedSize(std::span<const std::byte> file, DecodedSize& out);
Status join(std::span<const std::byte> file, std::span<std::byte> scratch, std::span<std::byte> image);

} // namespace xgc::load
