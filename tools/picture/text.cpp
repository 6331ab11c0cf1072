#include "text.h"

#include <algorithm>
#include <array>
#include <cstring>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

namespace xgc::bake {

namespace {

constexpr uint32_t kLineHeight = 10;

/// A corner as stb_easy_font writes it: four of them, clockwise from the upper left, are an upright rectangle.
struct FontVertex {
    float x, y, z;
    std::array<unsigned char, 4> color;
};
static_assert(sizeof(FontVertex) == 16);

/// What the font has a glyph for: it does not check.
std::string printable(std::string text) {
    for (char& c : text) c = c >= ' ' && c <= '~' ? c : '?';
    return text;
}

void fill(Image& image, const FontVertex& low, const FontVertex& high, glm::uvec2 origin, uint32_t scale,
          glm::u8vec4 color) {
    const auto at = [scale](uint32_t start, float font, uint32_t size) {
        return std::min(start + uint32_t(std::max(0.0f, font)) * scale, size);
    };
    const uint32_t endX = at(origin.x, high.x, image.width), endY = at(origin.y, high.y, image.height);
    for (uint32_t y = at(origin.y, low.y, image.height); y < endY; ++y) {
        for (uint32_t x = at(origin.x, low.x, image.width); x < endX; ++x)
            image.pixels[size_t(y) * image.width + x] = color;
    }
}

} // namespace

uint32_t textWidth(const std::string& text, uint32_t scale) {
    std::string copy = printable(text);
    return uint32_t(stb_easy_font_width(copy.data())) * scale;
}

uint32_t textHeight(uint32_t scale) {
    return kLineHeight * scale;
}

void drawText(Image& image, uint32_t x, uint32_t y, const std::string& text, glm::u8vec4 color, uint32_t scale) {
    constexpr size_t kVerticesOfGlyph = 4 * 17; // stb_easy_font: some 270 bytes a glyph on average
    std::vector<FontVertex> vertices(std::max<size_t>(1, text.size()) * kVerticesOfGlyph);
    std::string copy = printable(text);
    const int quads =
        stb_easy_font_print(0, 0, copy.data(), nullptr, vertices.data(), int(vertices.size() * sizeof(FontVertex)));
    for (int q = 0; q < quads; ++q) fill(image, vertices[q * 4], vertices[q * 4 + 2], {x, y}, scale, color);
}

} // namespace xgc::bake
