#include <xgc/bake/bake.h>

#include <cstdio>
#include <filesystem>

// Links the bake pipeline as a tool does: bakes the model that is named.
int main(int argc, char** argv) {
    xgc::bake::BakeOptions options;
    options.input = argc > 1 ? argv[1] : "no such file.obj";
    options.output = argc > 2 ? argv[2] : "out.xgc";
    xgc::bake::BakeReport report;
    const xgc::bake::Status status = xgc::bake::bake(options, report);
    std::printf("%s\n", status.ok() ? "baked" : status.message.c_str());
    return int(status.outcome);
}
