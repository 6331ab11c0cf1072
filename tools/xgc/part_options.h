#pragma once

#include <xgc/bake/bake.h>

#include <CLI/CLI.hpp>

namespace xgc::tool {

/// `--parts`, `--parts-count`, `--detail`: where the parts come from, alike for every subcommand that finds some.
struct PartOptions {
    std::string parts = "perceptual";
    uint32_t count = 0;
    float detail = 1;
    bake::PartSource source = bake::PartSource::perceptual; ///< after parse
};

void addPartOptions(CLI::App& command, PartOptions& options);
/// Refuses what does not exist, and options that the source has no use for.
bake::Status parse(PartOptions& options);

} // namespace xgc::tool
