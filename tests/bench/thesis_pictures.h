#pragma once

#include <xgc/bake/thesis_hierarchy.h>

#include <filesystem>

namespace xgc::test {

/// Draws the thesis's figures 4.5, 4.6 and 4.9 to 4.11 from the meshes in `data` as PNG into `folder`: parts in
/// colours, edges as lines.
bake::Status drawThesisPictures(const std::filesystem::path& data, const std::filesystem::path& folder);

} // namespace xgc::test
