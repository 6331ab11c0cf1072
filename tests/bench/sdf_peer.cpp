#include "sdf_peer.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include <unistd.h>

namespace xgc::bench {

double SdfPeer::seconds(const std::filesystem::path& off) const {
    namespace fs = std::filesystem;
    const fs::path work = fs::temp_directory_path() / fmt::format("xgc-bench-sdf-{}", getpid());
    fs::create_directories(work / "off"); // the program takes folders
    fs::create_symlink(fs::absolute(off), work / "off" / off.filename());
    const fs::path out = work / "out";
    const std::string command =
        fmt::format("'{}' '{}' '{}' >/dev/null", program_.string(), (work / "off").string(), out.string());
    double number = 0, seconds = 0;
    const bool isDone =
        std::system(command.c_str()) == 0 && std::ifstream(out / "seconds.txt") >> number >> seconds && seconds > 0;
    std::error_code ignored;
    fs::remove_all(work, ignored);
    return isDone ? seconds : -1;
}

} // namespace xgc::bench
