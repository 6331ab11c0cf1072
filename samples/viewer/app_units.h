#pragma once

#include <xgc/bake/status.h>
#include <xgc/status.h>

#include <fmt/format.h>

#include <chrono>

namespace xgc::viewer {

/// What the runtime or the device refused, as the program ends with it.
inline bake::Status fromRuntime(const Status& status) {
    if (status.ok()) return {};
    return bake::systemError(fmt::format("{} ({})", status.message, int64_t(status.element)));
}

inline float milliseconds(std::chrono::steady_clock::duration d) {
    return std::chrono::duration<float, std::milli>(d).count();
}

} // namespace xgc::viewer
