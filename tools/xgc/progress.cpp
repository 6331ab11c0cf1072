#include "progress.h"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace xgc::tool {
namespace {

constexpr int kWidth = 32;

}

Progress::Progress(bool quiet) : active_(!quiet && isatty(STDERR_FILENO)) {}

Progress::~Progress() {
    clear();
}

void Progress::show(const char* stage, double fraction) {
    if (!active_) return;
    const int filled = int(fraction * kWidth);
    std::string line =
        fmt::format("{:<10} [{:#<{}}{:.<{}}] {:3.0f} %", stage, "", filled, "", kWidth - filled, 100 * fraction);
    if (line == last_) return;
    fmt::print(stderr, "\r{}", line);
    std::fflush(stderr);
    last_ = std::move(line);
}

void Progress::clear() {
    if (last_.empty()) return;
    fmt::print(stderr, "\r{:{}}\r", "", last_.size());
    std::fflush(stderr);
    last_.clear();
}

} // namespace xgc::tool
