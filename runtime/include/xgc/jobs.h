#pragma once

#include <cstdint>

namespace xgc {

/// The host's scheduler. The library starts no threads: it hands work to `run`, or does it inline where there is none.
struct JobSystem {
    /// Calls job(data, index) once for each index below `count`, on any threads in any order, and returns when all have
    /// returned.
    void (*run)(void* user, uint32_t count, void (*job)(void* data, uint32_t index), void* data) = nullptr;
    void* user = nullptr;
};

} // namespace xgc
