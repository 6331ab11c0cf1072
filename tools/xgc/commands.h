#pragma once

#include <xgc/bake/status.h>

#include <CLI/CLI.hpp>

#include <functional>

/// The subcommands of `xgc`, one file each. A file adds its options to the app and, when it is the one that was
/// called, leaves what to do in `run`. Messages for people go to stderr, results to stdout.
namespace xgc::tool {

using Run = std::function<bake::Status()>;

void addEval(CLI::App& app, Run& run);
void addExtract(CLI::App& app, Run& run);
void addModel(CLI::App& app, Run& run);
void addBake(CLI::App& app, Run& run);
void addInspect(CLI::App& app, Run& run);
void addVerify(CLI::App& app, Run& run);
void addReplay(CLI::App& app, Run& run);
void addSegment(CLI::App& app, Run& run);
#ifdef XGC_HAS_VULKAN
void addRender(CLI::App& app, Run& run);
#endif

} // namespace xgc::tool
