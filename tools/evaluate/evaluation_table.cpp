#include "ranks.h"

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {

namespace {

std::string number(double value, bool known) {
    return known ? fmt::format("{:9.4f}", value) : fmt::format("{:>9}", "-");
}

size_t nameWidth(const Evaluation& evaluation) {
    size_t width = 10;
    for (const Evaluation::Row& row : evaluation.methods) width = std::max(width, row.name.size());
    return width + 1;
}

std::string summaryRow(const std::string& name, const EvalScore& score, size_t width, bool isMethod) {
    std::string line = fmt::format("{:<{}}", name, width);
    for (const EvalMetric& metric : evalMetrics()) line += number(score.*metric.value, metric.known(score));
    line += fmt::format("{:8.2f}{:8g}{:8}", score.parts, score.medianParts, score.models - score.cutModels);
    return line + (isMethod ? fmt::format("{:10.3f}\n", score.seconds) : fmt::format("{:>10}\n", "-"));
}

std::string summary(const Evaluation& evaluation) {
    const size_t width = nameWidth(evaluation);
    std::string text = fmt::format("{:<{}}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}{:>8}{:>10}\n", "", width, "RI", "CD",
                                   "HD", "GCE", "LCE", "parts", "median", "no cut", "seconds");
    for (const Evaluation::Row& row : evaluation.methods)
        text += summaryRow(row.name, meanScore(row.models), width, true);
    return text + summaryRow(evaluation.human.name, meanScore(evaluation.human.models), width, false);
}

/// All errors of a method by category, beside those of people.
std::string categoriesOf(const Evaluation& evaluation, const Evaluation::Row& row) {
    std::string text = fmt::format("{:<11}{:>9}{:>9}{:>9}{:>9}{:>8}   | human{:>7}{:>9}{:>9}{:>9}{:>8}\n", row.name,
                                   "RI", "CD", "HD", "GCE", "parts", "RI", "CD", "HD", "GCE", "parts");
    for (uint32_t c = 0; c < psbCategories().size(); ++c) {
        const EvalScore ours = categoryScore(evaluation, row, c);
        if (ours.models == 0) continue;
        const EvalScore human = categoryScore(evaluation, evaluation.human, c);
        text += fmt::format("{:<11}", psbCategories()[c]);
        for (const EvalMetric& m : evalMetrics().first(4)) text += number(ours.*m.value, m.known(ours));
        text += fmt::format("{:8.2f}   |    ", ours.parts);
        for (const EvalMetric& m : evalMetrics().first(4)) text += number(human.*m.value, m.known(human));
        text += fmt::format("{:8.2f}\n", human.parts);
    }
    return text;
}

std::string columnHeads(const Evaluation& evaluation, std::string_view corner) {
    std::string line = fmt::format("{:<11}", corner);
    for (const Evaluation::Row& row : evaluation.methods) line += fmt::format(" {:>10}", row.name);
    return line;
}

/// As the thesis's table 3.1.
std::string rankTable(const Evaluation& evaluation, const EvalMetric& metric) {
    std::string text = columnHeads(evaluation, fmt::format("rank by {}", metric.key)) + '\n';
    const auto add = [&](std::string_view name, uint32_t category) {
        const std::vector<uint32_t> ranks = rankMethods(evaluation, metric, category);
        if (ranks.empty()) return;
        text += fmt::format("{:<11}", name);
        for (size_t m = 0; m < ranks.size(); ++m)
            text += fmt::format(" {:>{}}", ranks[m], std::max(size_t(10), evaluation.methods[m].name.size()));
        text += '\n';
    };
    for (uint32_t c = 0; c < psbCategories().size(); ++c) add(psbCategories()[c], c);
    add("Average", kNone);
    return text;
}

} // namespace

std::string evaluationTable(const Evaluation& evaluation) {
    std::string text = summary(evaluation);
    for (const Evaluation::Row& row : evaluation.methods) text += '\n' + categoriesOf(evaluation, row);
    if (evaluation.methods.size() < 2) return text;
    for (const EvalMetric& metric : evalMetrics()) text += '\n' + rankTable(evaluation, metric);
    return text;
}

} // namespace xgc::bake
