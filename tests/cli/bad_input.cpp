#include "files.h"

#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>

// Whatever is wrong with a file that xgc is to read: exit code 3, a message that names the file, no crash, and the
// output that was there before untouched.

using namespace xgc::test;

namespace {

template <typename Check>
void forEachCall(Check check) {
    for (const Call& call : modelCalls()) check(call, ".obj");
    for (const Call& call : assetCalls()) check(call, ".xgc");
    for (const Call& call : labelCalls()) check(call, ".seg");
}

void checkAssetRefused(const Folder& folder, const std::string& bytes) {
    const std::string file = folder.file("bad.xgc");
    writeText(file, bytes);
    for (const Call& call : assetCalls()) checkRefused(call, file, folder);
}

} // namespace

TEST_CASE("a file that is not there is refused") {
    const Folder folder("missing");
    forEachCall([&](const Call& call, const char* ext) {
        checkRefused(call, folder.file(std::string("nowhere") + ext), folder);
    });
}

TEST_CASE("a folder in place of a file is refused") {
    const Folder folder("directory");
    forEachCall([&](const Call& call, const char* ext) {
        const std::string in = folder.file(std::string("folder") + ext);
        std::filesystem::create_directory(in);
        checkRefused(call, in, folder);
    });
}

TEST_CASE("an empty file is refused") {
    const Folder folder("empty");
    forEachCall([&](const Call& call, const char* ext) {
        const std::string in = folder.file(std::string("empty") + ext);
        writeText(in, "");
        checkRefused(call, in, folder);
    });
}

TEST_CASE("a file of another kind is refused") {
    const Folder folder("kind");
    forEachCall([&](const Call& call, const char* ext) {
        const std::string in = folder.file(std::string("prose") + ext);
        writeText(in, "The quick brown fox jumps over the lazy dog.\n");
        checkRefused(call, in, folder);
    });
}

TEST_CASE("a wrong extension is refused") {
    const Folder folder("extension");
    const std::string unknown = folder.file("model.unknown");
    writeText(unknown, cubeObj(2));
    const std::string none = folder.file("model");
    writeText(none, cubeObj(2));
    const std::string asset = folder.file("asset.obj");
    writeText(asset, bakedCube());
    const std::string glb = folder.file("text.glb");
    writeText(glb, cubeObj(2));
    for (const Call& call : modelCalls()) {
        for (const std::string& in : {unknown, none, asset, glb}) checkRefused(call, in, folder);
    }
    const std::string model = folder.file("model.xgc");
    writeText(model, cubeObj(2));
    for (const Call& call : assetCalls()) checkRefused(call, model, folder);
}

TEST_CASE("a file that may not be read is refused") {
    const Folder folder("unreadable");
    forEachCall([&](const Call& call, const char* ext) {
        const std::string in = folder.file(std::string("secret") + ext);
        writeText(in, std::string_view(ext) == ".xgc" ? bakedCube() : cubeObj(2));
        std::filesystem::permissions(in, std::filesystem::perms::none);
        const std::string out = folder.file("out" + call.outputExtension);
        const RunResult run = runCall(call, folder, in, out, {.withoutPrivileges = true});
        if (run.denied) {
            MESSAGE("SKIPPED: root, and its privileges cannot be dropped here");
        } else {
            INFO(call.arguments.front(), ": ", run.err);
            CHECK(run.exitCode == 3);
            CHECK(run.err.find(in) != std::string::npos);
            CHECK_FALSE(std::filesystem::exists(folder.file("out" + call.outputExtension)));
        }
        std::filesystem::remove(in);
    });
}

TEST_CASE("a truncated asset is refused") {
    const Folder folder("truncated");
    const std::string& whole = bakedCube();
    for (const size_t size : {size_t(1), size_t(8), size_t(63), size_t(64), size_t(65), whole.size() / 2,
                              whole.size() - 64, whole.size() - 1}) {
        checkAssetRefused(folder, whole.substr(0, size));
    }
}

TEST_CASE("an asset of another magic or version is refused") {
    const Folder folder("magic");
    std::string bytes = bakedCube();
    bytes[0] = 'Y';
    checkAssetRefused(folder, bytes);

    bytes = bakedCube();
    ++bytes[8];
    const std::string file = folder.file("later.xgc");
    writeText(file, bytes);
    for (const Call& call : assetCalls()) {
        checkRefused(call, file, folder);
        CHECK(runCall(call, folder, file, folder.file("out" + call.outputExtension)).err.find("version") !=
              std::string::npos);
    }
}

TEST_CASE("an asset with a flipped bit is refused") {
    const Folder folder("flipped");
    // Padding between sections and pages need not be covered: one bit in each of 24 places of the tables' start, and
    // in the last page.
    for (size_t at = 16; at < 400; at += 16) {
        std::string bytes = bakedCube();
        bytes[at] = char(bytes[at] ^ 4);
        checkAssetRefused(folder, bytes);
    }
}

TEST_CASE("a truncated model is refused or baked, never half of it") {
    const Folder folder("truncated-model");
    const std::string whole = cubeObj(6);
    for (const size_t size : {size_t(1), whole.size() / 3, whole.size() / 2}) {
        const std::string in = folder.file("cut.obj");
        writeText(in, whole.substr(0, size));
        for (const Call& call : modelCalls()) {
            const RunResult run = runCall(call, folder, in, folder.file("out" + call.outputExtension));
            INFO(call.arguments.front(), ": ", run.err);
            CHECK(run.signal == 0);
            CHECK(run.exitCode != 0);
            CHECK(run.err.find("cut.obj") != std::string::npos);
        }
    }
}

TEST_CASE("positions that are no numbers are refused") {
    const Folder folder("nan");
    const std::string in = folder.file("nan.off");
    for (const char* value : {"nan", "inf", "1e999"}) {
        writeText(in, std::string("OFF\n3 1 0\n0 0 0\n1 0 ") + value + "\n0 1 0\n3 0 1 2\n");
        for (const Call& call : modelCalls()) checkRefused(call, in, folder);
    }
}

TEST_CASE("labels that do not fit the model are refused") {
    const Folder folder("labels");
    for (const char* text : {"0\n1\n", "zero\n", "-1\n", "99999999999999999999\n"}) {
        const std::string in = folder.file("bad.seg");
        writeText(in, text);
        for (const Call& call : labelCalls()) checkRefused(call, in, folder);
    }
}
