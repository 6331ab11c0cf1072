#include "meshes/welded.h"

#include "meshes/builders.h"

#include <xgc/bake/picture.h>

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

using namespace xgc;
using namespace xgc::bake;

namespace {

using test::Welded;
using test::weldedWithTopology;

PictureOptions small() {
    PictureOptions options;
    options.width = 96;
    options.height = 64;
    return options;
}

Image draw(const Welded& w, const glm::vec3& color, const PictureOptions& options,
           std::span<const PictureLine> lines = {}) {
    return drawPicture(w.mesh, w.topology, std::vector<glm::vec3>(w.mesh.faces.size(), color), lines, options);
}

glm::u8vec4 at(const Image& image, uint32_t x, uint32_t y) {
    return image.pixels[size_t(y) * image.width + x];
}

/// First and last row and column that differ from the corner.
struct Extent {
    uint32_t left, right, top, bottom;
};

Extent drawnExtent(const Image& image) {
    Extent e{image.width, 0, image.height, 0};
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            if (at(image, x, y) == at(image, 0, 0)) continue;
            e = {std::min(e.left, x), std::max(e.right, x), std::min(e.top, y), std::max(e.bottom, y)};
        }
    }
    return e;
}

const glm::vec3 kRed(0.8f, 0.05f, 0.05f), kBlue(0.05f, 0.05f, 0.8f);

} // namespace

TEST_CASE("a picture fits its mesh, whatever its size and place") {
    for (const float scale : {1e-6f, 1.0f, 1e6f}) {
        Model model = test::sphere(10);
        for (glm::vec3& p : model.positions) p = (p + glm::vec3(5, -3, 2)) * scale;
        const Extent e = drawnExtent(draw(weldedWithTopology(model), kRed, small()));
        CHECK(e.top >= 1);
        CHECK(e.top <= 4);
        CHECK(e.bottom >= 59);
        CHECK(e.bottom <= 62);
        CHECK(std::abs(int(e.left + e.right) - 95) <= 2); // in the middle, and round
        CHECK(std::abs(int(e.right - e.left) - int(e.bottom - e.top)) <= 2);
    }
}

TEST_CASE("a wide mesh fits the width") {
    Model model = test::cube(1);
    for (glm::vec3& p : model.positions) p.x *= 20;
    PictureOptions options = small();
    options.viewFrom = {0, 0, 1};
    const Extent e = drawnExtent(draw(weldedWithTopology(model), kRed, options));
    CHECK(e.left >= 1);
    CHECK(e.left <= 5);
    CHECK(e.right >= 90);
    CHECK(e.right <= 94);
}

TEST_CASE("what is in front hides what is behind, from either side") {
    // Two squares one behind the other, the back one larger.
    Model model =
        test::modelOf({{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}},
                      {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}});
    const Welded w = weldedWithTopology(model);
    const std::vector<glm::vec3> colors = {kRed, kRed, kBlue, kBlue};
    PictureOptions options = small();
    options.viewFrom = {0, 0, 1};
    const auto middle = [&] { return at(drawPicture(w.mesh, w.topology, colors, {}, options), 48, 32); };
    const glm::u8vec4 front = middle();
    CHECK(front.r > front.b);
    options.viewFrom = {0, 0, -1};
    const glm::u8vec4 back = middle();
    CHECK(back.b > back.r);
    // A side seen from behind is lit as if it faced the eye.
    CHECK(int(back.b) + 4 > int(front.r));
}

TEST_CASE("lines show on the surface and hide behind it") {
    const Welded w = weldedWithTopology(test::cube(2));
    PictureOptions options = small();
    options.viewFrom = {0, 0, 1};
    options.lineWidth = 3;
    const glm::vec3 grey(0.6f);
    const PictureLine front{{-0.5f, 0, 0.5f}, {0.5f, 0, 0.5f}, kRed}, behind{{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, kRed};
    const glm::u8vec4 shown = at(draw(w, grey, options, std::span(&front, 1)), 48, 32);
    CHECK(shown.r > 2 * shown.g);
    const Image hidden = draw(w, grey, options, std::span(&behind, 1));
    CHECK(hidden.pixels == draw(w, grey, options).pixels);
}

TEST_CASE("the background is as asked, and edges are softened") {
    PictureOptions options = small();
    options.background = glm::vec3(1);
    const Image image = draw(weldedWithTopology(test::sphere(12)), glm::vec3(0.02f), options);
    CHECK(at(image, 0, 0) == glm::u8vec4(255));
    size_t between = 0;
    for (const glm::u8vec4& p : image.pixels) between += p.g > 130 && p.g < 240;
    CHECK(between > 40);
    CHECK(between < 400);
}

TEST_CASE("a smooth body is shaded without its facets, a cube with its edges") {
    PictureOptions options = small();
    options.viewFrom = {1, 1, 1};
    const Image cube = draw(weldedWithTopology(test::cube(4)), glm::vec3(0.6f), options);
    std::map<uint8_t, size_t> count; // three sides: few values apart from softened edges
    for (const glm::u8vec4& p : cube.pixels) ++count[p.g];
    size_t large = 0;
    for (const auto& [value, n] : count) large += n > 200;
    CHECK(large == 4); // and the background
    const Image sphere = draw(weldedWithTopology(test::sphere(8)), glm::vec3(0.6f), options);
    int steepest = 0; // along the middle row, well inside
    for (uint32_t x = 36; x < 60; ++x) {
        steepest = std::max(steepest, std::abs(int(at(sphere, x, 32).g) - int(at(sphere, x + 1, 32).g)));
    }
    CHECK(steepest <= 6);
}

TEST_CASE("nothing to draw is an empty picture, a speck is no failure") {
    const Mesh empty;
    Topology none;
    none.edgeFaceOffsets = none.vertexFaceOffsets = {0};
    const Image image = drawPicture(empty, none, {}, {}, small());
    CHECK(image.pixels == std::vector<glm::u8vec4>(size_t(96) * 64, at(image, 0, 0)));
    const Welded line = weldedWithTopology(test::modelOf({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, {{0, 1, 2}}));
    PictureOptions along = small();
    along.viewFrom = along.up = {0, 0, 1};
    CHECK(draw(line, kRed, along).pixels.size() == size_t(96) * 64);
}

TEST_CASE("the first part colours differ well from each other") {
    for (uint32_t a = 0; a < 24; ++a) {
        for (uint32_t b = 0; b < a; ++b) {
            const glm::vec3 difference = (encodeSrgb(partColor(a)) - encodeSrgb(partColor(b))) * 255.0f;
            CAPTURE(a);
            CAPTURE(b);
            CHECK(glm::length(difference) > (a - b == 1 ? 80.0f : 30.0f));
        }
    }
    CHECK(partColor(24) != partColor(0));
    CHECK(partColor(48) != partColor(0));
    CHECK(partColor(0xffffffffu) == partColor(0xffffffffu));
}

TEST_CASE("parts at a common edge differ in colour, even where the palette comes round between them") {
    constexpr uint32_t kCount = 289;
    std::vector<glm::vec3> positions = {{0, 0, 0}};
    for (uint32_t i = 0; i <= kCount; ++i) positions.emplace_back(1, float(i), 0);
    std::vector<glm::uvec3> fan;
    for (uint32_t i = 1; i <= kCount; ++i) fan.emplace_back(0, i, i + 1);
    const Mesh mesh = test::welded(test::modelOf(positions, fan));
    Segmentation parts;
    parts.partNames.resize(kCount);
    uint32_t clashes = 0;
    for (uint32_t f = 0; f < kCount; ++f) parts.facePart.push_back(f * kPartColorCount % kCount);
    const std::vector<glm::vec3> colors = partColors(buildTopology(mesh), parts);
    REQUIRE(colors.size() == kCount);
    for (uint32_t f = 1; f < kCount; ++f) {
        clashes += partColor(parts.facePart[f]) == partColor(parts.facePart[f - 1]);
        CHECK(colors[f] != colors[f - 1]);
    }
    CHECK(clashes > 100);
    CHECK(partColor(kPartColorCount) == partColor(0));
}

TEST_CASE("sRGB encoding is its standard's to a step of 8 bits, and decoding its inverse") {
    for (int i = 0; i <= 255; ++i) {
        const float linear = float(i) / 255;
        const double exact = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(double(linear), 1 / 2.4) - 0.055;
        CHECK(std::abs(double(encodeSrgb(glm::vec3(linear)).x) - exact) * 255 < 1);
        CHECK(std::abs(encodeSrgb(decodeSrgb(glm::vec3(linear))).x - linear) * 255 < 1);
    }
}

TEST_CASE("a PNG file has the picture's size and a signature; a folder that is not there is refused") {
    const std::filesystem::path dir = std::filesystem::path(XGC_BINARY_DIR) / "test_picture";
    std::filesystem::create_directories(dir);
    const Image image = draw(weldedWithTopology(test::sphere(6)), kBlue, small());
    REQUIRE(writePng(image, dir / "sphere.png").ok());
    std::ifstream file(dir / "sphere.png", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    REQUIRE(bytes.size() > 100);
    CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    CHECK(bytes[19] == 96);
    CHECK(bytes[23] == 64);
    CHECK_FALSE(writePng(image, dir / "no/such/folder/sphere.png").ok());
}
