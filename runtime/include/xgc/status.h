#pragma once

#include <cstdint>

namespace xgc {

/// Outcome of a runtime call that depends on data or on a capacity given by the caller.
enum class StatusCode : uint32_t {
    ok = 0,
    badArgument,   ///< a span is too small or misaligned
    notAnAsset,    ///< the magic is missing
    badVersion,    ///< written by another version of the format
    unsupported,   ///< valid, but uses a feature that this build does not read (a codec, several tiers)
    truncated,     ///< the bytes end before the asset does
    badChecksum,   ///< a section or page was altered
    corrupt,       ///< an offset, count, order or index breaks a rule of FORMAT.md
    outOfCapacity, ///< a fixed capacity is exhausted; the message names the setting to raise
    deviceRefused, ///< a graphics backend only: the device lacks something or failed; `element` is its own code
};

/// A code, a static English sentence that names the element and the remedy, and the index of the
/// element it speaks of (a section, patch, vertex row; what it counts is in the message). Never
/// owns memory; the library never prints it.
struct [[nodiscard]] Status {
    StatusCode code = StatusCode::ok;
    const char* message = "ok";
    uint64_t element = 0;

    constexpr bool ok() const { return code == StatusCode::ok; }
};

} // namespace xgc
