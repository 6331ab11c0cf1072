// A window onto baked assets: orbit, steer parts, compare. README.md has the keys.
#include "app.h"

#include <fmt/format.h>

#include <cstdio>

int main(int argc, char** argv) {
    using namespace xgc;
    viewer::Options options;
    int exitCode = 0;
    if (!viewer::parseOptions(argc, argv, options, exitCode)) return exitCode;
    bake::Status status;
    try {
        viewer::App app(options);
        status = app.run();
    } catch (const std::exception& error) { // the system's: no memory, no thread
        status = bake::systemError(error.what());
    }
    if (!status.ok()) fmt::print(stderr, "xgc-viewer: {}\n", status.message);
    return int(status.outcome);
}
