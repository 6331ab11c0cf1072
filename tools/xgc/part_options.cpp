#include "part_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace xgc::tool {

namespace {

using bake::PartSource;

constexpr float kLeastDetail = 0.01f, kMostDetail = 100;

constexpr std::array<std::pair<std::string_view, PartSource>, 5> kSources = {{{"perceptual", PartSource::perceptual},
                                                                              {"thesis", PartSource::thesis},
                                                                              {"none", PartSource::none},
                                                                              {"material", PartSource::material},
                                                                              {"component", PartSource::component}}};

} // namespace

void addPartOptions(CLI::App& command, PartOptions& options) {
    command.add_option("--parts", options.parts, "Parts: perceptual, thesis, none, material, component or a FILE.seg")
        ->capture_default_str();
    CLI::Option* count =
        command
            .add_option("--parts-count", options.count, "Parts wanted of perceptual and thesis; 0: as the shape asks")
            ->capture_default_str();
    command
        .add_option("--detail", options.detail,
                    "So many times as many perceptual parts; below 1 unions of them, above 1 inside them")
        ->excludes(count)
        ->capture_default_str();
}

bake::Status parse(PartOptions& options) {
    const auto named = std::find_if(kSources.begin(), kSources.end(),
                                    [&](const auto& source) { return source.first == options.parts; });
    if (named != kSources.end()) {
        options.source = named->second;
    } else if (std::filesystem::path(options.parts).extension() == ".seg") {
        options.source = PartSource::labels;
    } else {
        return bake::usageError(fmt::format(
            "--parts {}: expected perceptual, thesis, none, material, component or a .seg file", options.parts));
    }
    const bool isFound = options.source == PartSource::perceptual || options.source == PartSource::thesis;
    if (options.count > 0 && !isFound) {
        return bake::usageError(
            fmt::format("--parts-count {}: --parts {} has the parts that it has; leave it out, or use "
                        "perceptual or thesis",
                        options.count, options.parts));
    }
    if (!(options.detail >= kLeastDetail && options.detail <= kMostDetail)) { // nor a NaN
        return bake::usageError(
            fmt::format("--detail {}: expected a number from {} to {}", options.detail, kLeastDetail, kMostDetail));
    }
    if (options.detail != 1 && options.source != PartSource::perceptual) {
        return bake::usageError(fmt::format("--detail {}: only --parts perceptual has it; leave it out of --parts {}",
                                            options.detail, options.parts));
    }
    return {};
}

} // namespace xgc::tool
