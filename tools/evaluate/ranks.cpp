#include "ranks.h"

#include <limits>

namespace xgc::bake {

namespace {

bool hasModels(const EvalScore& score) {
    return score.models > 0;
}
bool hasCut(const EvalScore& score) {
    return score.cutModels > 0;
}

constexpr std::array<EvalMetric, 5> kMetrics = {{{"ri", &EvalScore::ri, hasModels},
                                                 {"cd", &EvalScore::cd, hasCut},
                                                 {"hd", &EvalScore::hd, hasModels},
                                                 {"gce", &EvalScore::gce, hasModels},
                                                 {"lce", &EvalScore::lce, hasModels}}};

} // namespace

std::span<const EvalMetric> evalMetrics() {
    return kMetrics;
}

EvalScore scoreOf(const Evaluation& evaluation, const Evaluation::Row& row, uint32_t category) {
    return category == kNone ? meanScore(row.models) : categoryScore(evaluation, row, category);
}

std::vector<uint32_t> rankMethods(const Evaluation& evaluation, const EvalMetric& metric, uint32_t category) {
    std::vector<double> errors;
    for (const Evaluation::Row& row : evaluation.methods) {
        const EvalScore score = scoreOf(evaluation, row, category);
        if (!hasModels(score)) return {};
        errors.push_back(metric.known(score) ? score.*metric.value : std::numeric_limits<double>::infinity());
    }
    std::vector<uint32_t> ranks;
    for (const double error : errors) {
        uint32_t better = 0;
        for (const double other : errors) better += other < error;
        ranks.push_back(better + 1);
    }
    return ranks;
}

} // namespace xgc::bake
