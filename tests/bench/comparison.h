#pragma once

#include "attribute_deviation.h"
#include "builder.h"
#include "flags.h"

#include <map>

namespace xgc::bench {

/// Shares of a model's faces at which qualities are compared, percent.
inline constexpr std::array<double, 6> kTargets{50, 25, 12.5, 6, 3, 1.5};

/// A surface's deviation from the model it was made of; lengths in diagonals of the model.
struct Quality {
    uint32_t faces = 0;
    double rms = 0, max = 0;
    AttributeDeviation attributes; ///< where asked for
};

/// A uniform level beside what another program makes with the same number of faces. Levels come as they are, so the
/// level nearest to a target is taken (within a third of it, else none) and the others are asked for its count; a
/// program that stops short of it or past it, by more than 1 % and 2 faces, does not compare.
struct Comparison {
    std::string model;
    double target = 0;
    uint32_t level = 0;
    Quality ours;
    std::string program;
    Quality theirs;

    bool equalFaces() const;
};

/// Compares a model's levels with every program that there is.
std::vector<Comparison> compareLevels(const Flags& flags, const Subject& subject, const bake::HierarchyOptions& options,
                                      bool attributes);

/// A figure of both, ours over theirs, by program and target, over the comparisons of equal counts.
using Ratios = std::map<std::string, std::map<double, std::vector<double>, std::greater<>>>;
Ratios ratiosOf(const std::vector<Comparison>& all, double (*figure)(const Quality&));

/// A line a program: the median and, below it, the worst at each target.
void printRatios(const std::string& title, const Ratios& ratios);

} // namespace xgc::bench
