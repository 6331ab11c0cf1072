#pragma once

#include <xgc/bake/status.h>
#include <xgc/vulkan/renderer.h>

#include <filesystem>
#include <string>
#include <vector>

namespace xgc::viewer {

/// The command line.
struct Options {
    std::vector<std::filesystem::path> files;
    uint32_t width = 1440, height = 900;
    vulkan::ShadingMode mode = vulkan::ShadingMode::shaded;
    float pixels = 1;
    uint32_t budget = 0; ///< triangles; 0: as many as it takes
    bool split = false;
    bool morph = false;
    bool panel = true;
    std::filesystem::path screenshot;
    uint32_t frames = 0; ///< that are drawn with a fixed clock and without the devices' input; 0: until it is closed
    std::filesystem::path script;
    std::filesystem::path report;
};

/// False where the program is done: `status` is ok after --help, else a usage error that CLI11 has printed.
bool parseOptions(int argc, char** argv, Options& out, int& exitCode);

} // namespace xgc::viewer
