#include "window_run.h"

#include <doctest/doctest.h>
#include <stb/stb_image.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sys/wait.h>

namespace xgc::test {
namespace {

bake::Image readPng(const std::string& file) {
    bake::Image out;
    int width = 0, height = 0, channels = 0;
    unsigned char* pixels = stbi_load(file.c_str(), &width, &height, &channels, 4);
    if (!pixels) return out;
    out.width = uint32_t(width);
    out.height = uint32_t(height);
    const auto* first = reinterpret_cast<const glm::u8vec4*>(pixels);
    out.pixels.assign(first, first + size_t(width) * size_t(height));
    stbi_image_free(pixels);
    return out;
}

std::string quoted(const std::string& word) {
    return "'" + word + "'";
}

} // namespace

int runShell(const std::string& command, std::string& output) {
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    REQUIRE(pipe);
    char buffer[4096];
    while (const size_t count = std::fread(buffer, 1, sizeof(buffer), pipe)) output.append(buffer, count);
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string workFile(const std::string& name) {
    std::filesystem::create_directories(XGC_WORK);
    return std::string(XGC_WORK) + "/" + name;
}

bool hasDisplay() {
    std::string ignored;
    if (runShell("command -v xvfb-run && command -v xdotool", ignored) == 0) return true;
    if (std::getenv("XGC_REQUIRE_DEVICE")) FAIL("no xvfb-run or xdotool, and XGC_REQUIRE_DEVICE is set");
    MESSAGE("SKIPPED: there is no xvfb-run or no xdotool to run the viewer with");
    return false;
}

ViewerRun runViewer(const std::string& arguments, const ViewerInput& input) {
    const std::string picture = workFile("picture.png"), report = workFile("report.json");
    const std::string status = workFile("status.txt");
    for (const std::string& file : {picture, report, status}) std::filesystem::remove(file);
    std::string viewer =
        quoted(XGC_VIEWER) + " " + arguments + " --screenshot " + quoted(picture) + " --report " + quoted(report);
    if (!input.script.empty()) {
        std::ofstream(workFile("script.txt")) << input.script;
        viewer += " --script " + quoted(workFile("script.txt"));
    }
    std::string command = "env -u DISPLAY -u WAYLAND_DISPLAY " + viewer;
    if (input.display) {
        std::ofstream shell(workFile("run.sh"));
        shell << (input.xdotool.empty() ? viewer + "\n"
                                        : viewer + " &\nviewer=$!\n" + input.xdotool + "\nwait $viewer\n");
        // xvfb-run has exit codes of its own, such as where it cannot tidy up at once.
        shell << "echo $? >" << quoted(status) << "\n";
        shell.close();
        // Xvfb's own remarks go to xvfb-run's log.
        command = "timeout 120 xvfb-run -a -s '-screen 0 1024x768x24' sh " + quoted(workFile("run.sh"));
    }
    ViewerRun run;
    run.exitCode = runShell(command, run.output);
    if (std::ifstream own(status); own) own >> run.exitCode;
    INFO(run.output);
    for (const char* sign : {"VUID-", "SYNC-HAZARD", "UNASSIGNED-", "Validation Error", "Validation Warning"})
        CHECK(run.output.find(sign) == std::string::npos);
    run.picture = readPng(picture);
    std::ifstream in(report);
    if (in) run.report = nlohmann::json::parse(in);
    return run;
}

} // namespace xgc::test
