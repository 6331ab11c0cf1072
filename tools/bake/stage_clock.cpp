#include "stage_clock.h"

#include <fstream>
#include <string>

namespace xgc::bake {
namespace {

/// Makes the system's high-water mark start anew.
void resetPeak() {
    std::ofstream clear("/proc/self/clear_refs");
    clear << "5";
}

uint64_t peakBytes() {
    std::ifstream status("/proc/self/status");
    std::string word;
    while (status >> word) {
        uint64_t kilobytes = 0;
        if (word == "VmHWM:" && status >> kilobytes) return kilobytes * 1024;
    }
    return 0;
}

} // namespace

StageClock::StageClock(const char* name) : name_(name), start_(std::chrono::steady_clock::now()) {
    resetPeak();
}

StageReport StageClock::stop() const {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
    return {name_, elapsed.count(), peakBytes()};
}

} // namespace xgc::bake
