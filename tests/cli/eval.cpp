#include "files.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

// `xgc eval psb` on a benchmark of one cube.

using namespace xgc::test;
using Json = nlohmann::json;

namespace {

constexpr const char* kBlock = R"(OFF
8 12 0
0 0 0
1 0 0
0 1 0
1 1 0
0 0 1
1 0 1
0 1 1
1 1 1
3 0 2 3
3 0 3 1
3 4 5 7
3 4 7 6
3 0 1 5
3 0 5 4
3 2 6 7
3 2 7 3
3 0 4 6
3 0 6 2
3 1 3 7
3 1 7 5
)";
constexpr const char* kBottom = "0\n0\n1\n1\n1\n1\n1\n1\n1\n1\n1\n1\n";
constexpr const char* kBottomAndTop = "0\n0\n1\n1\n2\n2\n2\n2\n2\n2\n2\n2\n";

void write(const Folder& folder, const std::string& name, std::string_view text) {
    std::filesystem::create_directories(std::filesystem::path(folder.file(name)).parent_path());
    writeText(folder.file(name), text);
}

/// Model 21 with two people's labels, and those of a method in "mine".
void makeBenchmark(const Folder& folder) {
    write(folder, "off/21.off", kBlock);
    write(folder, "seg/21/21_0.seg", kBottom);
    write(folder, "seg/21/21_1.seg", kBottomAndTop);
    write(folder, "mine/21.seg", kBottom);
}

RunResult runEval(const Folder& folder, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"eval", "psb", "--off", folder.file("off"), "--seg", folder.file("seg")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runXgc(arguments);
}

void checkRefusedEval(const RunResult& run, int exitCode, const std::string& named) {
    INFO(run.err);
    CHECK(run.exitCode == exitCode);
    CHECK(run.err.find(named) != std::string::npos);
    CHECK(run.out.empty());
}

} // namespace

TEST_CASE("eval prints a table, or JSON, or both with a file") {
    const Folder folder("eval");
    makeBenchmark(folder);
    const std::string mine = "mine=" + folder.file("mine"), file = folder.file("eval.json");
    const RunResult table = runEval(folder, {"--labels", mine, "--preset", "thesis"});
    INFO(table.err);
    CHECK(table.exitCode == 0);
    for (const char* word : {"mine", "thesis", "human", "Cup", "rank by ri"}) {
        INFO(word);
        CHECK(table.out.find(word) != std::string::npos);
    }

    const Json json = Json::parse(runEval(folder, {"--labels", folder.file("mine"), "--json"}).out);
    for (const char* key : {"total", "categories", "models", "human"}) CHECK_MESSAGE(json.contains(key), key);
    // One person has the same labels. For the other, pairs together: 1 + 45 and 1 + 1 + 28, in both 30: they disagree
    // on 16 of (12 - 1) / 2 * 12.
    CHECK(json["models"]["21"]["ri"].get<double>() == doctest::Approx(16.0 / 60 / 2));
    CHECK(json["human"]["ri"].get<double>() == doctest::Approx(16.0 / 60));

    const RunResult both = runEval(folder, {"--labels", folder.file("mine"), "--json", file});
    CHECK(both.out.find("human") != std::string::npos);
    CHECK(Json::parse(readText(file)) == json);
    CHECK(runEval(folder, {"--labels", mine, "--json", file, "--quiet"}).out.empty());
}

TEST_CASE("eval draws each model, and a sheet of the categories") {
    const Folder folder("evalpictures");
    makeBenchmark(folder);
    const std::string pictures = folder.file("pictures");
    const RunResult run = runEval(folder, {"--pictures", pictures, "--quiet", "--jobs", "1"});
    CHECK_MESSAGE(run.exitCode == 0, run.err);
    for (const char* name : {"/21.png", "/contact.png"}) CHECK(readText(pictures + name).starts_with("\x89PNG"));
    checkRefusedEval(runEval(folder, {"--pictures", folder.file("mine/21.seg") + "/x", "--quiet"}), 4, "mine/21.seg");
}

TEST_CASE("eval refuses what it cannot measure, by name") {
    const Folder folder("evalbad");
    makeBenchmark(folder);
    const std::string mine = folder.file("mine");
    checkRefusedEval(runEval(folder, {"--preset", "nonsense"}), 2, "--preset nonsense");
    checkRefusedEval(runEval(folder, {"--labels", mine, "--labels", mine}), 2, "two methods are called 'labels'");
    checkRefusedEval(runEval(folder, {"--labels", "=" + mine}), 2, "NAME=DIR");
    checkRefusedEval(runEval(folder, {"--parts-count", "0"}), 2, "--parts-count 0");
    checkRefusedEval(runEval(folder, {"--parts-count", "people"}), 2, "--parts-count people");
    checkRefusedEval(runEval(folder, {"--models", "Mug"}), 2, "'Mug'");
    checkRefusedEval(runEval(folder, {"--models", "1-20"}), 3, "no model of '1-20'");
    checkRefusedEval(runEval(folder, {"--labels", folder.file("nowhere")}), 3, "nowhere: no such folder");
    writeText(mine + "/21.seg", "0\n1\n");
    checkRefusedEval(runEval(folder, {"--labels", mine}), 3, "21.seg: 2 lines for a model of 12 faces");
    checkRefusedEval(runXgc({"eval", "psb", "--off", folder.file("off")}), 2, "--seg");
    checkRefusedEval(runXgc({"eval", "psb", "--off", folder.file("gone"), "--seg", folder.file("seg")}), 3,
                     "gone: no such folder");
}
