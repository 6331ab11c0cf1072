#include "models/makers.h"

#include "models/noise.h"
#include "models/trig.h"

#include <algorithm>
#include <cmath>

// A square of 8 x 8 units with y up: ridged mountains on both sides of a valley, in which a river winds down from the
// far end (-z) to the near one.

namespace xgc::bake::models {
namespace {

constexpr float kHalf = 4;
constexpr uint32_t kSeed = 71;

/// Sharp crests where the noise changes sign; octaves count only on the crests of those before.
float ridges(glm::vec2 p) {
    float sum = 0, weight = 1, amplitude = 0.5f;
    for (uint32_t octave = 0; octave < 9; ++octave) {
        const float crest = 1 - std::abs(gradientNoise(p, kSeed + octave));
        const float sharp = crest * crest;
        sum += sharp * weight * amplitude;
        weight = glm::clamp(sharp * 1.6f, 0.0f, 1.0f);
        amplitude *= 0.44f;
        p = glm::vec2(1.6f * p.x + 1.2f * p.y, 1.6f * p.y - 1.2f * p.x);
    }
    return sum;
}

float hills(glm::vec2 p) {
    float sum = 0, amplitude = 0.5f;
    for (uint32_t octave = 0; octave < 5; ++octave) {
        sum += amplitude * gradientNoise(p, kSeed + 40 + octave);
        amplitude *= 0.48f;
        p = glm::vec2(1.6f * p.x + 1.2f * p.y, 1.6f * p.y - 1.2f * p.x);
    }
    return sum;
}

/// Distance from the river's middle; its bends grow toward the plain.
float riverDistance(glm::vec2 p) {
    const double t = double(p.y) / (2 * kHalf) + 0.5;
    const double wide = 0.35 + 0.65 * t, turnsA = 1.7 * t + 0.1, turnsB = 4.3 * t + 0.37;
    const SinCos a = sinCosTurns(turnsA), b = sinCosTurns(turnsB);
    const double middle = wide * (0.95 * a.sine + 0.28 * b.sine);
    const double slope = wide * 6.2832 / (2 * kHalf) * (0.95 * 1.7 * a.cosine + 0.28 * 4.3 * b.cosine);
    return std::abs(p.x - float(middle)) / std::sqrt(1 + float(slope * slope));
}

struct Ground {
    float height;
    float river; ///< distance from the river's middle
};

Ground groundAt(glm::vec2 p) {
    const glm::vec2 warp(gradientNoise(p * 0.7f, 5), gradientNoise(p * 0.7f, 6));
    const float river = riverDistance(p + 0.12f * warp);
    const float valley = smoothStep(0.15f, 2.1f, river + 0.25f * warp.y);
    const float mountains = 1.75f * (ridges(p * 0.42f + 0.3f * warp) - 0.22f);
    const float meadows = 0.10f * hills(p * 1.4f);
    float height = 0.05f + valley * valley * std::max(mountains, 0.0f) + meadows * smoothStep(0.1f, 0.5f, river);
    // Banks, then the bed.
    const float bank = smoothStep(0.03f, 0.26f, river);
    height = glm::mix(-0.06f, height, bank);
    height -= 0.055f * (1 - smoothStep(0.0f, 0.11f, river));
    return {height - 0.035f * p.y, river};
}

glm::vec3 blendColor(glm::vec3 a, glm::vec3 b, float share) {
    return a + (b - a) * share;
}

glm::vec3 colorAt(glm::vec2 p, const Ground& ground, glm::vec3 normal) {
    const float height = ground.height + 0.035f * p.y;
    const float patch = 0.5f + 0.5f * gradientNoise(p * 3.0f, 9);
    const float speckle = gradientNoise(p * 14.0f, 10);
    glm::vec3 color = blendColor({0.16f, 0.27f, 0.07f}, {0.30f, 0.34f, 0.10f}, patch);
    color = blendColor(color, {0.07f, 0.16f, 0.05f},
                       smoothStep(0.15f, 0.35f, height) * (1 - smoothStep(0.45f, 0.7f, height)) * 0.8f);
    const glm::vec3 rock = blendColor({0.25f, 0.22f, 0.19f}, {0.38f, 0.35f, 0.31f}, 0.5f + 0.5f * speckle);
    color = blendColor(color, rock, smoothStep(0.22f, 0.42f, 1 - normal.y + 0.10f * (height - 0.8f)));
    const float snow = smoothStep(0.80f, 1.0f, height + 0.15f * speckle) * smoothStep(0.45f, 0.72f, normal.y);
    color = blendColor(color, {0.90f, 0.92f, 0.95f}, snow);
    color = blendColor({0.58f, 0.51f, 0.36f}, color, smoothStep(0.12f, 0.20f, ground.river + 0.03f * speckle));
    color = blendColor({0.05f, 0.19f, 0.27f}, color, smoothStep(0.085f, 0.105f, ground.river));
    return color;
}

} // namespace

Model makeTerrain(uint32_t faces) {
    const auto columns = uint32_t(std::sqrt(double(faces) / 2) + 0.5);
    const auto rows = uint32_t(double(faces) / 2 / columns + 0.5);
    const glm::vec2 step(2 * kHalf / float(columns), 2 * kHalf / float(rows));
    const auto place = [&](int64_t i, int64_t j) {
        return glm::vec2(float(i) * step.x - kHalf, float(j) * step.y - kHalf);
    };
    // One row and column more on each side, for slopes.
    const size_t stride = columns + 3;
    std::vector<Ground> ground(stride * (rows + 3));
    for (int64_t j = -1; j <= int64_t(rows) + 1; ++j) {
        for (int64_t i = -1; i <= int64_t(columns) + 1; ++i) {
            ground[size_t(j + 1) * stride + size_t(i + 1)] = groundAt(place(i, j));
        }
    }

    Model model;
    model.file = "terrain";
    model.materials.resize(1);
    model.materials[0].name = "ground";
    model.materials[0].roughness = 0.95f;
    model.nodes.push_back({"terrain", kNone, glm::mat4(1)});
    for (uint32_t j = 0; j <= rows; ++j) {
        for (uint32_t i = 0; i <= columns; ++i) {
            const size_t at = size_t(j + 1) * stride + i + 1;
            const glm::vec2 p = place(i, j);
            const glm::vec2 slope((ground[at + 1].height - ground[at - 1].height) / (2 * step.x),
                                  (ground[at + stride].height - ground[at - stride].height) / (2 * step.y));
            const glm::vec3 normal = glm::normalize(glm::vec3(-slope.x, 1, -slope.y));
            model.positions.emplace_back(p.x, ground[at].height, p.y);
            model.attributes.normals.push_back(normal);
            model.attributes.uvs[0].emplace_back(float(i) / float(columns), float(j) / float(rows));
            model.attributes.colors[0].emplace_back(colorAt(p, ground[at], normal), 1.0f);
        }
    }
    for (uint32_t j = 0; j < rows; ++j) {
        for (uint32_t i = 0; i < columns; ++i) {
            const uint32_t a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
            // The diagonal with the smaller rise follows ridges and banks.
            const std::vector<glm::vec3>& p = model.positions;
            if (std::abs(p[a].y - p[d].y) < std::abs(p[b].y - p[c].y)) {
                model.triangles.emplace_back(a, d, b);
                model.triangles.emplace_back(a, c, d);
            } else {
                model.triangles.emplace_back(a, c, b);
                model.triangles.emplace_back(b, c, d);
            }
        }
    }
    model.inputFaceCount = uint32_t(model.triangles.size());
    model.triangleMaterial.assign(model.inputFaceCount, 0);
    model.triangleNode.assign(model.inputFaceCount, 0);
    for (uint32_t f = 0; f < model.inputFaceCount; ++f) model.triangleFace.push_back(f);
    return model;
}

} // namespace xgc::bake::models
