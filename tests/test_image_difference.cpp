#include "bench/image_difference.h"

#include <doctest/doctest.h>

namespace {

using namespace xgc;

bake::Image grey(uint8_t value) {
    return {32, 24, std::vector<glm::u8vec4>(32 * 24, glm::u8vec4(value, value, value, 255))};
}

} // namespace

TEST_CASE("equal pictures have no difference") {
    bake::Image image = grey(90);
    image.pixels[100] = {255, 0, 0, 255};
    const bench::ImageDifference d = bench::imageDifference(image, image);
    CHECK(d.psnr == 99);
    CHECK(d.ssim == doctest::Approx(1));
}

TEST_CASE("the ratio is that of the mean square of luma to 255") {
    // Every pixel off by 10: 20 log10(255 / 10).
    CHECK(bench::imageDifference(grey(90), grey(100)).psnr == doctest::Approx(28.1308));
    // One of 768 off by 255 in green alone, which counts .587.
    bake::Image image = grey(0);
    image.pixels[5] = {0, 255, 0, 255};
    CHECK(bench::imageDifference(grey(0), image).psnr == doctest::Approx(33.4809));
}

TEST_CASE("similarity of flat pictures is that of their means, and noise has little") {
    const double c1 = 6.5025;
    CHECK(bench::imageDifference(grey(90), grey(120)).ssim ==
          doctest::Approx((2 * 90.0 * 120 + c1) / (90.0 * 90 + 120 * 120 + c1)));
    bake::Image noise = grey(90), inverse = noise;
    for (size_t i = 0; i < noise.pixels.size(); ++i) {
        const auto value = uint8_t(i * 7919 % 181);
        noise.pixels[i] = glm::u8vec4(value, value, value, 255);
        inverse.pixels[i] = glm::u8vec4(180 - value, 180 - value, 180 - value, 255);
    }
    CHECK(bench::imageDifference(noise, inverse).ssim < -0.8);
}
