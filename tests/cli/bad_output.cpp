#include "files.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

// Whatever happens while xgc writes: the target is the old file or the whole new one.

using namespace xgc::test;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view kOld = "what was there before";

/// Every call that writes, with a good input.
template <typename Check>
void forEachWriter(const Folder& folder, Check check) {
    const std::string model = folder.file("input.obj"), asset = folder.file("input.xgc");
    writeText(model, cubeObj(12));
    writeText(asset, bakedCube());
    for (const Call& call : modelCalls()) {
        if (!call.outputExtension.empty()) check(call, model);
    }
    for (const Call& call : assetCalls()) {
        if (!call.outputExtension.empty()) check(call, asset);
    }
    check(Call{{"model", "creature", "-o", "{out}", "--faces", "2000"}, ".glb"}, model);
}

void checkFailed(const RunResult& run, const Call& call, std::initializer_list<int> codes) {
    INFO(call.arguments.front(), ": ", run.err);
    CHECK(run.signal == 0);
    CHECK(std::find(codes.begin(), codes.end(), run.exitCode) != codes.end());
    CHECK(run.err.find("out" + call.outputExtension) != std::string::npos);
}

bool hasOnlyInputsAnd(const Folder& folder, const std::string& out) {
    for (const std::string& name : folder.names()) {
        if (!name.starts_with("input.") && !name.starts_with("good-") && name != out) return false;
    }
    return true;
}

} // namespace

TEST_CASE("a full disk leaves the old file and nothing else") {
    const Folder folder("full");
    forEachWriter(folder, [&](const Call& call, const std::string& in) {
        const std::string name = "out" + call.outputExtension;
        for (const uint64_t bytes : {0, 24}) {
            writeText(folder.file(name), kOld);
            checkFailed(runCall(call, folder, in, folder.file(name), {.fileBytes = bytes}), call, {4});
            CHECK(readText(folder.file(name)) == kOld);
            CHECK(hasOnlyInputsAnd(folder, name));
        }
        std::filesystem::remove(folder.file(name));
    });
}

TEST_CASE("a folder that is not there, or an output that is a folder, is refused") {
    const Folder folder("nofolder");
    forEachWriter(folder, [&](const Call& call, const std::string& in) {
        const std::string name = "out" + call.outputExtension;
        const RunResult nowhere = runCall(call, folder, in, folder.file("nowhere/" + name));
        INFO(nowhere.err);
        CHECK(nowhere.signal == 0);
        CHECK((nowhere.exitCode == 3 || nowhere.exitCode == 4));
        CHECK(nowhere.err.find("nowhere") != std::string::npos);

        std::filesystem::create_directory(folder.file(name));
        checkFailed(runCall(call, folder, in, folder.file(name)), call, {2, 3, 4});
        CHECK(hasOnlyInputsAnd(folder, name));
        std::filesystem::remove(folder.file(name));
    });
}

TEST_CASE("a folder that may not be written is refused") {
    const Folder folder("readonly");
    forEachWriter(folder, [&](const Call& call, const std::string& in) {
        const std::filesystem::path closed = folder.file("input.closed");
        std::filesystem::create_directory(closed);
        std::filesystem::permissions(closed, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
        const std::string out = closed / ("out" + call.outputExtension);
        const RunResult run = runCall(call, folder, in, out, {.withoutPrivileges = true});
        if (run.denied) {
            MESSAGE("SKIPPED: root, and its privileges cannot be dropped here");
        } else {
            checkFailed(run, call, {3, 4});
            CHECK(std::filesystem::is_empty(closed));
        }
        std::filesystem::permissions(closed, std::filesystem::perms::owner_all);
        std::filesystem::remove_all(closed);
    });
}

TEST_CASE("an output of a wrong extension is refused") {
    const Folder folder("outextension");
    forEachWriter(folder, [&](const Call& call, const std::string& in) {
        const std::string out = folder.file("out.unknown");
        const RunResult run = runCall(call, folder, in, out);
        INFO(call.arguments.front(), ": ", run.err);
        CHECK((run.exitCode == 2 || run.exitCode == 3));
        CHECK(run.err.find("out.unknown") != std::string::npos);
        CHECK_FALSE(std::filesystem::exists(out));
    });
}

TEST_CASE("an interrupted bake leaves the old file") {
    const Folder folder("interrupted");
    const std::string in = folder.file("input.obj"), out = folder.file("out.xgc");
    writeText(in, cubeObj(60));
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        int interrupted = 0;
        for (const auto after : {15ms, 40ms, 80ms, 160ms, 320ms}) {
            writeText(out, kOld);
            const RunResult run = runXgc({"bake", in, "-o", out, "--quiet"}, {.signal = signal, .after = after});
            if (run.exitCode == 0) break;
            INFO(run.err);
            ++interrupted;
            CHECK(readText(out) == kOld);
            if (signal != SIGKILL && run.exitCode > 0) CHECK(hasOnlyInputsAnd(folder, "out.xgc"));
        }
        CHECK(interrupted > 0);
    }
    // What a killed one may have left does not disturb the next.
    const RunResult run = runXgc({"bake", in, "-o", out, "--quiet"});
    CHECK_MESSAGE(run.exitCode == 0, run.err);
    CHECK(runXgc({"verify", out, "--states", "1", "--quiet"}).exitCode == 0);
}
