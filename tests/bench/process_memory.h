#pragma once

#include <cstdint>

namespace xgc::bench {

/// Resident bytes of the process now, what the allocator holds back given back first; 0 where unknown.
uint64_t residentBytes();
/// Starts the high-water mark anew.
void resetPeak();
uint64_t peakBytes();

} // namespace xgc::bench
