#include <xgc/bake/evaluate.h>
#include <xgc/bake/segmentation_metrics.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

namespace xgc::bake {

namespace {

/// A mean of errors that are added one by one; what has no cut discrepancy is left out of that mean.
class MeanErrors {
public:
    void add(const SegmentationErrors& e) {
        ri_ += e.randIndex;
        hd_ += e.hamming;
        gce_ += e.globalConsistency;
        lce_ += e.localConsistency;
        ++count_;
        if (!e.cutDiscrepancy) return;
        cd_ += *e.cutDiscrepancy;
        ++cutCount_;
    }

    /// As the score of one model.
    EvalScore score() const {
        EvalScore s;
        if (count_ == 0) return s;
        s.models = 1;
        s.ri = ri_ / count_;
        s.hd = hd_ / count_;
        s.gce = gce_ / count_;
        s.lce = lce_ / count_;
        s.cutModels = cutCount_ > 0 ? 1 : 0;
        if (cutCount_ > 0) s.cd = cd_ / cutCount_;
        return s;
    }

private:
    double ri_ = 0, cd_ = 0, hd_ = 0, gce_ = 0, lce_ = 0;
    uint32_t count_ = 0, cutCount_ = 0;
};

EvalScore scoreAgainst(const MetricSurface& surface, const MetricLabels& labels, std::span<const MetricLabels> people) {
    MeanErrors mean;
    for (const MetricLabels& person : people) mean.add(compareLabels(surface, labels, person));
    EvalScore score = mean.score();
    score.parts = score.medianParts = labels.segmentCount();
    return score;
}

EvalScore scoreAmong(const MetricSurface& surface, std::span<const MetricLabels> people) {
    MeanErrors mean;
    double parts = 0;
    for (size_t i = 0; i < people.size(); ++i) {
        for (size_t j = 0; j < i; ++j) mean.add(compareLabels(surface, people[i], people[j]));
        parts += people[i].segmentCount();
    }
    EvalScore score = mean.score();
    score.parts = score.medianParts = parts / double(people.size());
    return score;
}

uint32_t partsWanted(const EvalOptions& options, const PsbModel& model) {
    switch (options.partsCount) {
    case PartsCount::people:
        return mostFrequentPartCount(model);
    case PartsCount::fixed:
        return options.fixedPartsCount;
    default:
        return 0;
    }
}

/// Everything about the model at `slot`, into the slots of `out`.
Status evaluateModel(const EvalOptions& options, size_t slot, Evaluation& out) {
    PsbModel model;
    if (Status s = readPsbModel(options.folders, options.numbers[slot], model); !s.ok()) return s;
    const MetricSurface surface = prepareSurface(model.mesh, model.topology);
    std::vector<MetricLabels> people;
    for (const std::vector<uint32_t>& labels : model.people) people.push_back(prepareLabels(surface, labels));
    out.human.models[slot] = scoreAmong(surface, people);

    std::vector<std::vector<uint32_t>> labels(options.methods.size());
    for (size_t m = 0; m < options.methods.size(); ++m) {
        double seconds = 0;
        if (Status s = options.methods[m].find(model, partsWanted(options, model), labels[m], seconds); !s.ok())
            return s;
        EvalScore& score = out.methods[m].models[slot];
        score = scoreAgainst(surface, prepareLabels(surface, labels[m]), people);
        score.seconds = seconds;
    }
    return options.visit ? options.visit(model, labels) : Status{};
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

} // namespace

EvalScore meanScore(std::span<const EvalScore> scores) {
    EvalScore mean;
    std::vector<double> parts;
    for (const EvalScore& s : scores) {
        if (s.models == 0) continue;
        mean.models += s.models;
        mean.ri += s.ri * s.models;
        mean.hd += s.hd * s.models;
        mean.gce += s.gce * s.models;
        mean.lce += s.lce * s.models;
        mean.cutModels += s.cutModels;
        mean.cd += s.cd * s.cutModels;
        mean.parts += s.parts * s.models;
        mean.seconds += s.seconds;
        parts.push_back(s.medianParts);
    }
    if (mean.models == 0) return {};
    for (double* sum : {&mean.ri, &mean.hd, &mean.gce, &mean.lce, &mean.parts}) *sum /= mean.models;
    if (mean.cutModels > 0) mean.cd /= mean.cutModels;
    mean.medianParts = median(std::move(parts));
    return mean;
}

EvalScore categoryScore(const Evaluation& evaluation, const Evaluation::Row& row, uint32_t category) {
    std::vector<EvalScore> scores;
    for (size_t i = 0; i < evaluation.numbers.size(); ++i) {
        if (psbCategoryOf(evaluation.numbers[i]) == category) scores.push_back(row.models[i]);
    }
    return meanScore(scores);
}

Status evaluate(const EvalOptions& options, Evaluation& out) {
    const size_t count = options.numbers.size();
    Evaluation result;
    result.numbers = options.numbers;
    for (const EvalMethod& method : options.methods)
        result.methods.push_back({method.name, std::vector<EvalScore>(count)});
    result.human = {"human", std::vector<EvalScore>(count)};

    std::vector<Status> outcomes(count);
    std::mutex progressMutex;
    size_t finished = 0;
    tbb::parallel_for(size_t(0), count, [&](size_t slot) {
        outcomes[slot] = evaluateModel(options, slot, result);
        if (!options.progress) return;
        const std::scoped_lock lock(progressMutex);
        options.progress(double(++finished) / double(count));
    });
    for (Status& outcome : outcomes) {
        if (!outcome.ok()) return std::move(outcome);
    }
    out = std::move(result);
    return {};
}

} // namespace xgc::bake
