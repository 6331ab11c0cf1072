#include "commands.h"

#include <fmt/format.h>

#include <cstdio>

namespace {

/// Usage errors, and files that CLI11 itself finds missing, exit with 2; help with 0.
int parseExit(const CLI::App& app, const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : int(xgc::bake::Outcome::usage);
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"xgc: level of detail for the parts inside a mesh"};
    app.require_subcommand(1);
    xgc::tool::Run run;
    xgc::tool::addExtract(app, run);
    xgc::tool::addModel(app, run);
    xgc::tool::addBake(app, run);
    xgc::tool::addInspect(app, run);
    xgc::tool::addVerify(app, run);
    xgc::tool::addSegment(app, run);
#ifdef XGC_HAS_VULKAN
    xgc::tool::addRender(app, run);
#endif
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return parseExit(app, error);
    }
    const xgc::bake::Status status = run();
    if (!status.ok()) fmt::print(stderr, "xgc: {}\n", status.message);
    return int(status.outcome);
}
