#include "options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>

namespace xgc::viewer {
namespace {

constexpr uint32_t kLeastSide = 200, kMostSide = 8192;

void parseSize(const std::string& text, Options& out) {
    char rest = 0;
    const bool read = std::sscanf(text.c_str(), "%ux%u%c", &out.width, &out.height, &rest) == 2;
    const auto fits = [](uint32_t side) { return side >= kLeastSide && side <= kMostSide; };
    if (!read || !fits(out.width) || !fits(out.height)) {
        throw CLI::ValidationError(
            "--size", fmt::format("expected a width and a height of {} to {} as in 1440x900", kLeastSide, kMostSide));
    }
}

void addOptions(CLI::App& cli, Options& options) {
    cli.footer("Example: xgc-viewer creature.xgc temple.glb --mode levels\n"
               "Without a file, drop one into the window. samples/viewer/README.md lists the keys.");
    cli.add_option("files", options.files,
                   "Baked assets (.xgc) and models (glTF, GLB, OBJ, PLY, OFF, STL, ...), which are baked as they come; "
                   "also creature, shaft, terrain, temple or tree, the bundled models");
    cli.add_option_function<std::string>(
           "--size", [&options](const std::string& text) { parseSize(text, options); }, "Width and height in pixels")
        ->default_str("1440x900");
    cli.add_option_function<std::string>(
           "--mode", [&options](const std::string& text) { options.mode = *vulkan::modeNamed(text); },
           "How it is coloured: shaded, parts, levels, wire or error")
        ->check(CLI::IsMember({"shaded", "parts", "levels", "wire", "error"}))
        ->default_str("shaded");
    cli.add_option("--pixels", options.pixels, "Coarsest levels whose error stays below so many pixels")
        ->check(CLI::Range(0.0f, 1000.0f))
        ->capture_default_str();
    CLI::Option* budget = cli.add_option("--budget", options.budget, "At most so many triangles a frame")
                              ->check(CLI::Range(1u, 1u << 30));
    cli.add_flag("--morph", options.morph, "Levels change continuously")->excludes(budget);
    cli.add_flag("--split", options.split, "Beside it, one error for the whole mesh at as many triangles");
    cli.add_flag("!--no-panel", options.panel, "Start with the panel closed");
    cli.add_option("--screenshot", options.screenshot, "Write the last frame to a FILE.png")
        ->check([](const std::string& file) {
            return std::filesystem::path(file).extension() == ".png" ? "" : "the picture must end in .png";
        });
    cli.add_option("--frames", options.frames, "Draw so many frames with a fixed clock, taking no input, and exit")
        ->check(CLI::Range(1, 1000000));
    cli.add_option("--script", options.script, "Input from a file in place of mouse and keys (README.md)")
        ->check(CLI::ExistingFile);
    cli.add_option("--report", options.report, "Write the state at the end as JSON");
}

} // namespace

bool parseOptions(int argc, char** argv, Options& out, int& exitCode) {
    CLI::App cli{"xgc-viewer: look at level of detail inside a mesh"};
    addOptions(cli, out);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        exitCode = cli.exit(error) == 0 ? 0 : int(bake::Outcome::usage);
        return false;
    }
    return true;
}

} // namespace xgc::viewer
