#pragma once

#include <xgc/bake/status.h>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include <filesystem>
#include <vector>

namespace xgc::bake {

/// sRGB pixels, rows from the top.
struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<glm::u8vec4> pixels;
};

/// Writes a PNG beside the target and renames.
Status writePng(const Image& image, const std::filesystem::path& file);

} // namespace xgc::bake
