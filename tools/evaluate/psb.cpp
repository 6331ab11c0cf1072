#include <xgc/bake/evaluate.h>
#include <xgc/bake/import.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace xgc::bake {

namespace {

constexpr uint32_t kModelsOfCategory = 20;
/// Models 261 to 280 were left out of the benchmark.
constexpr uint32_t kGap = 13;

constexpr std::array<std::string_view, 19> kCategories = {
    "Human", "Cup",  "Glasses", "Airplane",  "Ant",  "Chair", "Octopus", "Table", "Teddy",  "Hand",
    "Plier", "Fish", "Bird",    "Armadillo", "Bust", "Mech",  "Bearing", "Vase",  "FourLeg"};

std::optional<uint32_t> parseNumber(std::string_view text) {
    uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

/// Numbers k of the files `prefix`k`extension` of a folder, rising. Other files are passed over.
Status numbersOf(const std::filesystem::path& folder, const std::string& prefix, std::string_view extension,
                 std::vector<uint32_t>& numbers) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) {
        return badInput(fmt::format("{}: no such folder", folder.string()));
    }
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::filesystem::path file = at->path().filename();
        const std::string stem = file.stem().string();
        if (file.extension() != extension || !stem.starts_with(prefix)) continue;
        if (const auto number = parseNumber(std::string_view(stem).substr(prefix.size()))) numbers.push_back(*number);
    }
    if (error) return badInput(fmt::format("{}: cannot be listed: {}", folder.string(), error.message()));
    std::sort(numbers.begin(), numbers.end());
    return {};
}

/// What one entry of a list asks for.
struct Wanted {
    uint32_t first = 0, last = 0;
};

std::optional<Wanted> parseWanted(std::string_view entry) {
    if (const auto number = parseNumber(entry)) return Wanted{*number, *number};
    const auto name = std::find(kCategories.begin(), kCategories.end(), entry);
    if (name != kCategories.end()) {
        auto block = uint32_t(name - kCategories.begin());
        if (block >= kGap) ++block;
        return Wanted{block * kModelsOfCategory + 1, (block + 1) * kModelsOfCategory};
    }
    const size_t dash = entry.find('-');
    if (dash == std::string_view::npos) return std::nullopt;
    const auto first = parseNumber(entry.substr(0, dash)), last = parseNumber(entry.substr(dash + 1));
    if (!first || !last || *first > *last) return std::nullopt;
    return Wanted{*first, *last};
}

/// Appends what an entry asks for of the numbers that are there.
Status pick(std::string_view entry, const std::filesystem::path& off, std::span<const uint32_t> there,
            std::vector<uint32_t>& picked) {
    const std::optional<Wanted> wanted = parseWanted(entry);
    if (!wanted) {
        return usageError(fmt::format("models '{}': expected a number, a range as 1-20, or a category ({})", entry,
                                      fmt::join(kCategories, ", ")));
    }
    const auto first = std::lower_bound(there.begin(), there.end(), wanted->first);
    const auto last = std::upper_bound(there.begin(), there.end(), wanted->last);
    if (first == last) return badInput(fmt::format("{}: no model of '{}' in this folder", off.string(), entry));
    picked.insert(picked.end(), first, last);
    return {};
}

} // namespace

std::span<const std::string_view> psbCategories() {
    return kCategories;
}

uint32_t psbCategoryOf(uint32_t number) {
    if (number == 0) return kNone;
    const uint32_t block = (number - 1) / kModelsOfCategory;
    if (block == kGap || block > kCategories.size()) return kNone;
    return block < kGap ? block : block - 1;
}

Status listPsbModels(const std::filesystem::path& off, std::string_view list, std::vector<uint32_t>& numbers) {
    std::vector<uint32_t> there;
    if (Status s = numbersOf(off, "", ".off", there); !s.ok()) return s;
    if (there.empty()) return badInput(fmt::format("{}: holds no model; expected 1.off, 2.off, ...", off.string()));
    if (list.empty()) {
        numbers = std::move(there);
        return {};
    }
    std::vector<uint32_t> picked;
    for (size_t begin = 0; begin <= list.size();) {
        const size_t comma = std::min(list.find(',', begin), list.size());
        if (Status s = pick(list.substr(begin, comma - begin), off, there, picked); !s.ok()) return s;
        begin = comma + 1;
    }
    std::sort(picked.begin(), picked.end());
    picked.erase(std::unique(picked.begin(), picked.end()), picked.end());
    numbers = std::move(picked);
    return {};
}

Status readPsbModel(const PsbFolders& folders, uint32_t number, PsbModel& out) {
    const std::filesystem::path file = folders.off / fmt::format("{}.off", number);
    PsbModel psb;
    psb.number = number;
    Model model;
    if (Status s = importModel(file, model); !s.ok()) return s;
    WeldReport report;
    if (Status s = weld(model, {}, psb.mesh, report); !s.ok()) return s;
    psb.topology = buildTopology(psb.mesh);

    const std::filesystem::path folder = folders.seg / std::to_string(number);
    const std::string prefix = fmt::format("{}_", number);
    std::vector<uint32_t> people;
    if (Status s = numbersOf(folder, prefix, ".seg", people); !s.ok()) return s;
    if (people.empty()) {
        return badInput(fmt::format("{}: holds no person's labels of model {}; expected {}0.seg, {}1.seg, ...",
                                    folder.string(), number, prefix, prefix));
    }
    for (const uint32_t person : people) {
        const std::filesystem::path seg = folder / fmt::format("{}{}.seg", prefix, person);
        if (Status s = readSegFile(seg, psb.mesh.inputFaceCount, psb.people.emplace_back()); !s.ok()) return s;
    }
    out = std::move(psb);
    return {};
}

uint32_t mostFrequentPartCount(const PsbModel& model) {
    std::vector<size_t> counts;
    for (std::vector<uint32_t> labels : model.people) {
        std::sort(labels.begin(), labels.end());
        counts.push_back(size_t(std::unique(labels.begin(), labels.end()) - labels.begin()));
    }
    std::sort(counts.begin(), counts.end());
    size_t best = 0, most = 0;
    for (size_t i = 0, j = 0; i < counts.size(); i = j) {
        while (j < counts.size() && counts[j] == counts[i]) ++j;
        if (j - i <= most) continue;
        most = j - i;
        best = counts[i];
    }
    return uint32_t(best);
}

} // namespace xgc::bake
