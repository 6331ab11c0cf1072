#include "process_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace xgc::bench {
namespace {

uint64_t statusBytes(const std::string& key) {
    std::ifstream status("/proc/self/status");
    std::string word;
    while (status >> word) {
        uint64_t kilobytes = 0;
        if (word == key && status >> kilobytes) return kilobytes * 1024;
    }
    return 0;
}

} // namespace

uint64_t residentBytes() {
    malloc_trim(0);
    return statusBytes("VmRSS:");
}

void resetPeak() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

uint64_t peakBytes() {
    return statusBytes("VmHWM:");
}

} // namespace xgc::bench
