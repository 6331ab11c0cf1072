#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace xgc::bake {

/// One or two triangles over three or four corners.
struct CardShape {
    uint32_t cornerCount = 0, faceCount = 0;
    std::array<glm::dvec3, 4> corner{};
    std::array<glm::vec2, 4> uv{}; ///< all 0 where there is none
    std::array<std::array<uint8_t, 3>, 2> face{};
    std::array<glm::dvec3, 2> normal{}; ///< of the input's faces, unit: a face must never turn against its own

    double area() const;
    glm::dvec3 middle() const;
    double radius() const; ///< about its middle
};

/// A leaf, a blade, a feather, or what stands for many of them.
struct Card : CardShape {
    std::vector<glm::dvec3> points; ///< of the input that it stands for; many are thinned out
    double wantedArea = 0;          ///< of the input's faces that it stands for
};

/// How two cards become one: the survivor moves some of its corners, two at most, to corners of the other, whose own
/// triangles then have no area left.
///
///     a3 ___ a2       b3 ___ b2           a3 ___________ b2
///       |   |           |   |               |           |      targets: none, b1, b2, none
///       |___|           |___|               |___________|
///     a0     a1       b0     b1           a0             b1
struct CardFit {
    static constexpr uint8_t kStays = 255;
    bool secondSurvives = false;
    std::array<uint8_t, 4> target{kStays, kStays, kStays, kStays}; ///< per corner of the survivor: one of the other's
    double area = 0;
    double squaredError = 0; ///< between the two cards, with what they stand for, and the one
    double score = 0;        ///< less is better
};

struct CardFitLimits {
    double squaredError = 0;
    double area = 0;       ///< that the one should have
    double mostMiss = 0.3; ///< share of that by which it may miss it
};

/// The best way to make two cards one, if any keeps to the limits.
std::optional<CardFit> fitCards(const Card& first, const Card& second, const CardFitLimits& limits);

/// The survivor after the step, standing for both.
Card joined(const Card& first, const Card& second, const CardFit& fit);

} // namespace xgc::bake
