#pragma once

#include <xgc/bake/mesh.h>
#include <xgc/bake/segment.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Measures ways of finding parts against people's, on the Princeton segmentation benchmark (Chen, Golovinskiy,
/// Funkhouser 2009). The metrics themselves are in segmentation_metrics.h.
namespace xgc::bake {

/// The benchmark's folders: `off` holds N.off for model N; `seg` holds N/N_0.seg, N/N_1.seg, ..., each one person's
/// labels of the faces of N.off.
struct PsbFolders {
    std::filesystem::path off, seg;
};

struct PsbModel {
    uint32_t number = 0;
    Mesh mesh;
    Topology topology;
    std::vector<std::vector<uint32_t>> people; ///< labels of the input's faces, by number of the file; not empty
};

/// The 19 categories in the benchmark's order, 20 models each: "Human" 1 to 20, ... "FourLeg" 381 to 400. Numbers 261
/// to 280 are no category's.
std::span<const std::string_view> psbCategories();
/// Index of a model's category; kNone where it has none.
uint32_t psbCategoryOf(uint32_t number);

/// Numbers of the models in a folder of N.off, rising. `list` picks some of them, separated by commas: numbers, ranges
/// ("1-20"), categories ("Cup"); empty: all. A number by itself must be there; ranges and categories take what is.
Status listPsbModels(const std::filesystem::path& off, std::string_view list, std::vector<uint32_t>& numbers);
/// On failure `out` is untouched.
Status readPsbModel(const PsbFolders& folders, uint32_t number, PsbModel& out);
/// How many parts people most often made of the model; of equally frequent counts the smallest.
uint32_t mostFrequentPartCount(const PsbModel& model);

/// An automatic segmentation, by name. `partsCount` 0: as many parts as it finds.
struct SegmentPreset {
    std::string_view name;
    Segmentation (*segment)(const Mesh& mesh, const Topology& topology, uint32_t partsCount);
};
/// The default first.
std::span<const SegmentPreset> segmentPresets();

/// A way to get labels for the faces of a model's input; called from several threads. `seconds`: what finding them
/// took, without input and output.
struct EvalMethod {
    std::string name;
    std::function<Status(const PsbModel& model, uint32_t partsCount, std::vector<uint32_t>& labels, double& seconds)>
        find;
};
EvalMethod presetMethod(const SegmentPreset& preset);
/// Labels made elsewhere: N.seg for model N in `folder`. Seconds come from its `seconds.txt`, lines of "N seconds",
/// where that is there.
Status labelsMethod(const std::string& name, const std::filesystem::path& folder, EvalMethod& out);

/// Errors (see SegmentationErrors) of one model, means over people; or means of those over several models.
struct EvalScore {
    double ri = 0, cd = 0, hd = 0, gce = 0, lce = 0;
    double parts = 0;       ///< mean
    double medianParts = 0; ///< over models
    double seconds = 0;     ///< summed up
    uint32_t models = 0;    ///< that it speaks of; 0: there is nothing to tell
    uint32_t cutModels = 0; ///< of these, those that `cd` speaks of: the others have no cut to measure
};
EvalScore meanScore(std::span<const EvalScore> scores);

enum class PartsCount : uint8_t {
    automatic, ///< as the method finds
    people,    ///< mostFrequentPartCount of each model
    fixed,
};

struct EvalOptions {
    PsbFolders folders;
    std::vector<uint32_t> numbers; ///< models
    std::vector<EvalMethod> methods;
    PartsCount partsCount = PartsCount::automatic;
    uint32_t fixedPartsCount = 0; ///< of PartsCount::fixed
    /// Sees each model and the labels that each method gave it. Called from several threads.
    std::function<Status(const PsbModel& model, std::span<const std::vector<uint32_t>> labels)> visit;
    /// Told the finished fraction, one call at a time.
    std::function<void(double)> progress;
};

struct Evaluation {
    struct Row {
        std::string name;
        std::vector<EvalScore> models; ///< one a number
    };
    std::vector<uint32_t> numbers;
    std::vector<Row> methods;
    Row human; ///< people against each other, means over unordered pairs; nothing for a model of one person
};

/// Models in parallel (TBB), each segmented by one thread unless a method has threads of its own; the same scores, but
/// for seconds, for any number of threads. On failure `out` is untouched, and the message is that of the first model
/// that failed.
Status evaluate(const EvalOptions& options, Evaluation& out);

/// Means of a row over a category (an index of psbCategories) or over all.
EvalScore categoryScore(const Evaluation& evaluation, const Evaluation::Row& row, uint32_t category);

/// One method: {"total", "categories", "models", "human"}; several: {"methods": {name: {...}}, "ranks", "human"}; keys
/// in tools/README.md.
std::string evaluationJson(const Evaluation& evaluation);
/// For people: a row a method and one of people, Rand index errors by category, ranks where there are several.
std::string evaluationTable(const Evaluation& evaluation);

} // namespace xgc::bake
