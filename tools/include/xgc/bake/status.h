#pragma once

#include <string>
#include <utility>

namespace xgc::bake {

/// Outcome of a step of the pipeline; the values are the exit codes of the command line.
enum class Outcome : int {
    ok = 0,
    promiseBroken = 1, ///< `verify` found a state that breaks a promise, or a strict bake has warnings
    usage = 2,
    badInput = 3, ///< the message names file, element and remedy
    system = 4,   ///< the device or the system refused
};

struct [[nodiscard]] Status {
    Outcome outcome = Outcome::ok;
    std::string message;

    bool ok() const { return outcome == Outcome::ok; }
};

inline Status badInput(std::string message) {
    return {Outcome::badInput, std::move(message)};
}
inline Status systemError(std::string message) {
    return {Outcome::system, std::move(message)};
}
inline Status usageError(std::string message) {
    return {Outcome::usage, std::move(message)};
}

} // namespace xgc::bake
