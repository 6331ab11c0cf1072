#include <xgc/bake/picture.h>

#include <array>

namespace xgc::bake {

namespace {

/// sRGB, ordered so that neighbours in the list, which often touch on a mesh, differ in hue and lightness.
constexpr std::array<uint32_t, 24> kPalette = {0x4c8bbf, 0xf2a541, 0x5fb06a, 0xd9564e, 0x9a7bc2, 0xf4d35e,
                                               0x4fb8b4, 0xe58fb5, 0xa9744f, 0x9cc953, 0x5567b8, 0xf08a6b,
                                               0x86c5e8, 0xb5485f, 0xc7b38b, 0x2f8f7c, 0xc49bdb, 0xd8843b,
                                               0x7f9c4a, 0x3e6e93, 0xe9b7a0, 0x8f5e93, 0xb7d6a1, 0xb08b2e};

float encode(float x) {
    x = glm::clamp(x, 0.0f, 1.0f);
    if (x <= 0.0031308f) return 12.92f * x;
    const float s1 = glm::sqrt(x), s2 = glm::sqrt(s1), s3 = glm::sqrt(s2);
    return glm::clamp(0.662002687f * s1 + 0.684122060f * s2 - 0.323583601f * s3 - 0.0225411470f * x, 0.0f, 1.0f);
}

float decode(float x) {
    x = glm::clamp(x, 0.0f, 1.0f);
    if (x <= 0.04045f) return x / 12.92f;
    const float t = (x + 0.055f) / 1.055f, t2 = t * t;
    float root = 1; // the fifth root of t^2, by Newton's steps from above
    for (int i = 0; i < 12; ++i) root -= (root - t2 / (root * root * root * root)) * 0.2f;
    return t2 * root;
}

} // namespace

glm::vec3 encodeSrgb(glm::vec3 linear) {
    return {encode(linear.x), encode(linear.y), encode(linear.z)};
}

glm::vec3 decodeSrgb(glm::vec3 srgb) {
    return {decode(srgb.x), decode(srgb.y), decode(srgb.z)};
}

glm::vec3 partColor(uint32_t part) {
    const auto count = uint32_t(kPalette.size());
    const uint32_t rgb = kPalette[part % count];
    const glm::vec3 color = glm::vec3(float(rgb >> 16), float(rgb >> 8 & 255), float(rgb & 255)) / 255.0f;
    switch (part / count % 3) {
    case 1:
        return decodeSrgb(glm::mix(color, glm::vec3(1), 0.4f));
    case 2:
        return decodeSrgb(color * 0.65f);
    default:
        return decodeSrgb(color);
    }
}

} // namespace xgc::bake
