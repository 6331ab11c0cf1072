#include "commands.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

namespace {

/// Usage errors, and files that CLI11 itself finds missing, exit with 2; help with 0.
int parseExit(const CLI::App& app, const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : int(xgc::bake::Outcome::usage);
}

bool isSubcommand(const CLI::App& app, const std::string& word) {
    for (const CLI::App* sub : app.get_subcommands({})) {
        if (sub->get_name() == word) return true;
    }
    return false;
}

xgc::bake::Status guarded(const xgc::tool::Run& run) {
    try {
        return run();
    } catch (const std::bad_alloc&) {
        return xgc::bake::systemError("out of memory: close other programs, or take a smaller model");
    } catch (const std::exception& error) {
        return xgc::bake::systemError(error.what());
    }
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"xgc: level of detail for the parts inside a mesh"};
    app.require_subcommand(1);
    xgc::tool::Run run;
    xgc::tool::addModel(app, run);
    xgc::tool::addSegment(app, run);
    xgc::tool::addBake(app, run);
    xgc::tool::addEval(app, run);
    xgc::tool::addInspect(app, run);
    xgc::tool::addVerify(app, run);
    xgc::tool::addExtract(app, run);
    xgc::tool::addReplay(app, run);
#ifdef XGC_HAS_VULKAN
    xgc::tool::addRender(app, run);
#endif
    if (argc > 1 && argv[1][0] != '-' && !isSubcommand(app, argv[1])) {
        fmt::print(stderr, "xgc: no subcommand '{}': run xgc --help for the list\n", argv[1]);
        return int(xgc::bake::Outcome::usage);
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return parseExit(app, error);
    }
    const xgc::bake::Status status = guarded(run);
    if (!status.ok()) fmt::print(stderr, "xgc: {}\n", status.message);
    return int(status.outcome);
}
