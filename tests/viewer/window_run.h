#pragma once

#include <xgc/bake/image.h>

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

/// Runs the viewer on a virtual display.
namespace xgc::test {

/// False, said aloud, where xvfb-run is not there; a failure where XGC_REQUIRE_DEVICE is set.
bool hasDisplay();

struct ViewerRun {
    int exitCode = -1;
    std::string output;    ///< stdout and stderr, the validation layer's messages among them
    nlohmann::json report; ///< null where none was written
    bake::Image picture;   ///< empty where none was written
};

struct ViewerInput {
    std::string script = {};  ///< lines of --script; empty: none
    std::string xdotool = {}; ///< shell lines run beside the viewer, on its display; empty: none
    bool display = true;      ///< false: there is none
};

/// Arguments beside --screenshot, --report and --script. Any validation message is a failure of the test.
ViewerRun runViewer(const std::string& arguments, const ViewerInput& input = {});

/// A file in the tests' own folder.
std::string workFile(const std::string& name);

/// Runs a shell command: its exit code and output.
int runShell(const std::string& command, std::string& output);

} // namespace xgc::test
