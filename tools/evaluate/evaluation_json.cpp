#include "ranks.h"

#include <nlohmann/json.hpp>

namespace xgc::bake {

namespace {

using Json = nlohmann::ordered_json;

Json errorsJson(const EvalScore& score) {
    Json json = Json::object();
    for (const EvalMetric& metric : evalMetrics()) {
        json[metric.key] = metric.known(score) ? Json(score.*metric.value) : Json(nullptr);
    }
    json["parts"] = score.parts;
    return json;
}

Json modelJson(const EvalScore& score, bool isMethod) {
    Json json = errorsJson(score);
    if (isMethod) json["seconds"] = score.seconds;
    return json;
}

Json meanJson(const EvalScore& score, bool isMethod) {
    Json json = errorsJson(score);
    json["medianParts"] = score.medianParts;
    if (isMethod) json["seconds"] = score.seconds;
    json["modelCount"] = score.models;
    json["noCut"] = score.models - score.cutModels;
    return json;
}

/// Appends "categories" and "models".
void addDetails(const Evaluation& evaluation, const Evaluation::Row& row, bool isMethod, Json& json) {
    Json& categories = json["categories"] = Json::object();
    for (uint32_t c = 0; c < psbCategories().size(); ++c) {
        const EvalScore score = categoryScore(evaluation, row, c);
        if (score.models > 0) categories[std::string(psbCategories()[c])] = meanJson(score, isMethod);
    }
    Json& models = json["models"] = Json::object();
    for (size_t i = 0; i < evaluation.numbers.size(); ++i) {
        if (row.models[i].models == 0) continue;
        models[std::to_string(evaluation.numbers[i])] = modelJson(row.models[i], isMethod);
    }
}

Json methodJson(const Evaluation& evaluation, const Evaluation::Row& row) {
    Json json;
    json["total"] = meanJson(meanScore(row.models), true);
    addDetails(evaluation, row, true, json);
    return json;
}

/// The means at the top, so that the row reads as a method's total does.
Json humanJson(const Evaluation& evaluation) {
    Json json = meanJson(meanScore(evaluation.human.models), false);
    addDetails(evaluation, evaluation.human, false, json);
    return json;
}

Json ranksJson(const Evaluation& evaluation) {
    Json json;
    for (const EvalMetric& metric : evalMetrics()) {
        Json& ranks = json[metric.key] = Json::object();
        const auto add = [&](const std::string& name, uint32_t category) {
            const std::vector<uint32_t> row = rankMethods(evaluation, metric, category);
            for (size_t m = 0; m < row.size(); ++m) ranks[name][evaluation.methods[m].name] = row[m];
        };
        for (uint32_t c = 0; c < psbCategories().size(); ++c) add(std::string(psbCategories()[c]), c);
        add("Average", kNone);
    }
    return json;
}

} // namespace

std::string evaluationJson(const Evaluation& evaluation) {
    Json json;
    if (evaluation.methods.size() == 1) {
        json = methodJson(evaluation, evaluation.methods.front());
    } else {
        Json& methods = json["methods"] = Json::object();
        for (const Evaluation::Row& row : evaluation.methods) methods[row.name] = methodJson(evaluation, row);
        json["ranks"] = ranksJson(evaluation);
    }
    json["human"] = humanJson(evaluation);
    return json.dump(2) + "\n";
}

} // namespace xgc::bake
