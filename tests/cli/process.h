#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

/// Runs `xgc` as a process of its own.
namespace xgc::test {

struct RunOptions {
    /// Largest file that the process can write, as on a full disk (the write fails, no signal comes).
    std::optional<uint64_t> fileBytes = std::nullopt;
    /// Signal to send after a time, unless it has ended by then.
    int signal = 0;
    std::chrono::milliseconds after{0};
    /// Obey file permissions even when the tests run as root.
    bool withoutPrivileges = false;
};

struct RunResult {
    int exitCode = -1;   ///< -1 where a signal ended it
    int signal = 0;      ///< that ended it
    bool denied = false; ///< privileges could not be dropped: nothing was run
    std::string out;
    std::string err;
};

/// Arguments without the program's name. Waits for the end.
RunResult runXgc(const std::vector<std::string>& arguments, const RunOptions& options = {});

} // namespace xgc::test
