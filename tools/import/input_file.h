#pragma once

#include <xgc/bake/status.h>

#include <cstddef>
#include <filesystem>
#include <vector>

namespace xgc::bake {

/// Reads a whole regular file. The message says what stands in the way: no such file, a directory, no permission,
/// empty, a device.
Status readInputFile(const std::filesystem::path& file, std::vector<std::byte>& out);

} // namespace xgc::bake
