#pragma once

#include <xgc/bake/evaluate.h>

#include <array>

namespace xgc::bake {

/// An error by which methods are told apart.
struct EvalMetric {
    const char* key;
    double EvalScore::*value;
    bool (*known)(const EvalScore&);
};
std::span<const EvalMetric> evalMetrics();

/// Ranks of the methods in one category, or over all (kNone), as in the thesis's table 3.1: 1 has the least error.
/// Equal errors share a rank; unknown ones come last. Empty where the category has no models.
std::vector<uint32_t> rankMethods(const Evaluation& evaluation, const EvalMetric& metric, uint32_t category);

/// A row's means over a category, or over all (kNone).
EvalScore scoreOf(const Evaluation& evaluation, const Evaluation::Row& row, uint32_t category);

} // namespace xgc::bake
