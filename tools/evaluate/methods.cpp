#include <xgc/bake/evaluate.h>
#include <xgc/bake/perceptual.h>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <array>
#include <charconv>
#include <chrono>
#include <fstream>
#include <map>

namespace xgc::bake {

namespace {

Segmentation perceptual(const Mesh& mesh, const Topology& topology, uint32_t partsCount) {
    return segmentPerceptual(mesh, topology, {.partsCount = partsCount});
}

Segmentation thesis(const Mesh& mesh, const Topology& topology, uint32_t partsCount) {
    ThesisSegmentOptions options;
    options.partsCount = partsCount;
    return segmentThesis(mesh, topology, options);
}

/// All there are, the default first: a new one is a row.
constexpr std::array kPresets = {
    SegmentPreset{"perceptual", perceptual},
    SegmentPreset{"thesis", thesis},
};

using SecondsByModel = std::map<uint32_t, double>;

Status readSeconds(const std::filesystem::path& file, SecondsByModel& out) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return {};
    std::ifstream in(file);
    if (!in) return badInput(fmt::format("{}: cannot be opened; check its permissions", file.string()));
    std::string line;
    for (uint32_t row = 1; std::getline(in, line); ++row) {
        uint32_t number = 0;
        double seconds = 0;
        const char *const begin = line.data(), *const end = begin + line.size();
        const auto first = std::from_chars(begin, end, number);
        const bool blank = first.ec == std::errc{} && first.ptr != end && *first.ptr == ' ';
        if (!blank || std::from_chars(first.ptr + 1, end, seconds).ec != std::errc{} || !(seconds >= 0)) {
            return badInput(fmt::format("{}: line {}: expected a model's number and its seconds, as '21 0.034'",
                                        file.string(), row));
        }
        out[number] = seconds;
    }
    return {};
}

} // namespace

std::span<const SegmentPreset> segmentPresets() {
    return kPresets;
}

EvalMethod presetMethod(const SegmentPreset& preset) {
    const auto find = [segment = preset.segment](const PsbModel& model, uint32_t partsCount,
                                                 std::vector<uint32_t>& labels, double& seconds) -> Status {
        Segmentation parts;
        // While it waits for its own tasks it must not take up another model: that would count as its time.
        tbb::this_task_arena::isolate([&] {
            const auto start = std::chrono::steady_clock::now();
            parts = segment(model.mesh, model.topology, partsCount);
            seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        });
        labels = inputLabels(model.mesh, parts);
        return {};
    };
    return {std::string(preset.name), find};
}

Status labelsMethod(const std::string& name, const std::filesystem::path& folder, EvalMethod& out) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
        return badInput(fmt::format("{}: no such folder; expected one of 1.seg, 2.seg, ...", folder.string()));
    }
    SecondsByModel secondsOf;
    if (Status s = readSeconds(folder / "seconds.txt", secondsOf); !s.ok()) return s;
    out.name = name;
    out.find = [folder, secondsOf = std::move(secondsOf)](const PsbModel& model, uint32_t,
                                                          std::vector<uint32_t>& labels, double& seconds) -> Status {
        const auto known = secondsOf.find(model.number);
        seconds = known != secondsOf.end() ? known->second : 0;
        return readSegFile(folder / fmt::format("{}.seg", model.number), model.mesh.inputFaceCount, labels);
    };
    return {};
}

} // namespace xgc::bake
