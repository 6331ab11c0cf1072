#pragma once

#include <xgc/bake/image.h>

#include <string>

namespace xgc::bake {

/// Pixels that a line of text takes.
uint32_t textWidth(const std::string& text, uint32_t scale);
uint32_t textHeight(uint32_t scale);

/// Writes a line of text, its upper left corner at (x, y): ASCII, a "?" for all else; what falls outside is left out. A
/// pixel of the font is `scale` of the image.
void drawText(Image& image, uint32_t x, uint32_t y, const std::string& text, glm::u8vec4 color, uint32_t scale);

} // namespace xgc::bake
