#pragma once

#include <xgc/bake/bake.h>

#include <chrono>

namespace xgc::bake {

/// Measures one stage: time, and the peak of resident memory where the system tells (Linux).
class StageClock {
public:
    explicit StageClock(const char* name);
    StageReport stop() const;

private:
    const char* name_;
    std::chrono::steady_clock::time_point start_;
};

} // namespace xgc::bake
