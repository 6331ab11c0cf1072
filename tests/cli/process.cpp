#include "process.h"

#include <doctest/doctest.h>

#include <fcntl.h>
#include <linux/capability.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace xgc::test {
namespace {

constexpr int kCannotStart = 126;
constexpr int kCannotDrop = 125;

/// Root without the right to pass over permissions: what is not in the bounding set is lost at exec.
bool dropPrivileges() {
    if (geteuid() != 0) return true;
    return prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) == 0 &&
           prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH, 0, 0, 0) == 0;
}

[[noreturn]] void becomeXgc(std::vector<char*>& arguments, const RunOptions& options, int out, int err) {
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    if (options.fileBytes) {
        const rlimit limit{*options.fileBytes, *options.fileBytes};
        std::signal(SIGXFSZ, SIG_IGN);
        if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(kCannotDrop);
    }
    if (options.withoutPrivileges && !dropPrivileges()) _exit(kCannotDrop);
    // Drivers leak, and are unloaded before anyone could tell whose the leaks are; what else `render` does, others do.
    if (arguments[1] && arguments[1] == std::string_view("render")) setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
    execv(XGC_TOOL, arguments.data());
    _exit(kCannotStart);
}

/// Reads both pipes to their ends; sends the signal when its time comes.
void collect(pid_t child, std::array<pollfd, 2> pipes, std::array<std::string*, 2> texts, const RunOptions& options) {
    const auto due = std::chrono::steady_clock::now() + options.after;
    bool pending = options.signal != 0;
    for (int open = 2; open > 0;) {
        int wait = -1;
        if (pending) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(due - std::chrono::steady_clock::now());
            wait = int(std::max<long>(0, left.count()));
        }
        if (poll(pipes.data(), pipes.size(), wait) == 0 && pending) {
            kill(child, options.signal);
            pending = false;
        }
        for (size_t i = 0; i < pipes.size(); ++i) {
            if (pipes[i].fd < 0 || pipes[i].revents == 0) continue;
            std::array<char, 4096> buffer;
            const ssize_t n = read(pipes[i].fd, buffer.data(), buffer.size());
            if (n > 0) {
                texts[i]->append(buffer.data(), size_t(n));
                continue;
            }
            close(pipes[i].fd);
            pipes[i].fd = -1;
            --open;
        }
    }
}

} // namespace

RunResult runXgc(const std::vector<std::string>& arguments, const RunOptions& options) {
    std::vector<std::string> owned = arguments;
    owned.insert(owned.begin(), "xgc");
    std::vector<char*> pointers;
    for (std::string& a : owned) pointers.push_back(a.data());
    pointers.push_back(nullptr);

    int out[2], err[2];
    REQUIRE(pipe2(out, O_CLOEXEC) == 0);
    REQUIRE(pipe2(err, O_CLOEXEC) == 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) becomeXgc(pointers, options, out[1], err[1]);
    close(out[1]);
    close(err[1]);

    RunResult result;
    collect(child, {pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}}, {&result.out, &result.err}, options);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (WIFEXITED(status)) result.exitCode = WEXITSTATUS(status);
    result.denied = result.exitCode == kCannotDrop || (options.withoutPrivileges && result.exitCode == kCannotStart);
    if (!result.denied) REQUIRE_MESSAGE(result.exitCode != kCannotStart, "cannot start " XGC_TOOL);
    return result;
}

} // namespace xgc::test
