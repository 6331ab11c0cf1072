#include "files.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

// Exit codes, help and the keys of the JSON that scripts rely on.

using namespace xgc::test;
using Json = nlohmann::json;

namespace {

const std::vector<std::string> kSubcommands = {
    "bake",   "segment", "eval", "inspect", "verify", "model", "extract",
#ifdef XGC_HAS_VULKAN
    "render",
#endif
};

void checkUsage(const std::vector<std::string>& arguments) {
    const RunResult run = runXgc(arguments);
    const std::string first = arguments.empty() ? "(no argument)" : arguments.front();
    INFO(first, ": ", run.err);
    CHECK(run.exitCode == 2);
    CHECK_FALSE(run.err.empty());
    CHECK(run.out.empty());
}

void checkKeys(const Json& json, std::initializer_list<const char*> keys) {
    for (const char* key : keys) CHECK_MESSAGE(json.contains(key), key);
}

} // namespace

TEST_CASE("misuse exits with 2 and says how") {
    checkUsage({});
    checkUsage({"frobnicate"});
    for (const std::string& sub : kSubcommands) {
        checkUsage({sub});
        checkUsage({sub, "--no-such-option"});
    }
}

TEST_CASE("a word that is no subcommand or model is named") {
    CHECK(runXgc({"frobnicate"}).err.find("'frobnicate'") != std::string::npos);
    CHECK(runXgc({"model", "cow", "-o", "cow.glb"}).err.find("cow not in {creature,shaft,terrain,temple,tree}") !=
          std::string::npos);
}

TEST_CASE("every subcommand has help with an example") {
    CHECK(runXgc({"--help"}).exitCode == 0);
    for (const std::string& sub : kSubcommands) {
        const RunResult run = runXgc({sub, "--help"});
        INFO(sub);
        CHECK(run.exitCode == 0);
        CHECK(run.out.find("Example: xgc " + sub) != std::string::npos);
    }
}

TEST_CASE("presets and parts that do not exist are refused by name") {
    const Folder folder("presets");
    const std::string in = folder.file("cube.obj"), out = folder.file("cube.xgc");
    writeText(in, cubeObj(2));
    for (const auto& [option, value] : {std::pair{"--preset", "nonsense"}, std::pair{"--parts", "nonsense"}}) {
        const RunResult run = runXgc({"bake", in, "-o", out, option, value});
        CHECK(run.exitCode == 2);
        CHECK(run.err.find(value) != std::string::npos);
    }
    CHECK(folder.names() == std::vector<std::string>{"cube.obj"});
}

TEST_CASE("numbers of parts are refused where the parts are given") {
    const Folder folder("counts");
    const std::string in = folder.file("cube.obj"), out = folder.file("cube.xgc"), seg = folder.file("cube.seg");
    writeText(in, cubeObj(2));
    const std::vector<std::vector<std::string>> kWrong = {{"--parts", "none", "--parts-count", "3"},
                                                          {"--parts", "thesis", "--detail", "2"},
                                                          {"--detail", "2", "--parts-count", "3"},
                                                          {"--detail", "0"},
                                                          {"--detail", "nan"}};
    for (const std::vector<std::string>& wrong : kWrong) {
        for (const std::vector<std::string>& command :
             {std::vector<std::string>{"bake", in, "-o", out}, std::vector<std::string>{"segment", in, "-o", seg}}) {
            std::vector<std::string> arguments = command;
            arguments.insert(arguments.end(), wrong.begin(), wrong.end());
            const RunResult run = runXgc(arguments);
            INFO(arguments.front() << " " << wrong.front() << " " << wrong[1]);
            CHECK(run.exitCode == 2);
            CHECK(run.err.find(wrong[wrong.size() - 2]) != std::string::npos);
        }
    }
    CHECK(folder.names() == std::vector<std::string>{"cube.obj"});
}

TEST_CASE("JSON has the documented keys, and work without a terminal draws no progress") {
    const Folder folder("json");
    const std::string in = folder.file("cube.obj"), out = folder.file("cube.xgc"), report = folder.file("cube.json");
    writeText(in, cubeObj(6));
    const RunResult baked = runXgc({"bake", in, "-o", out, "--report", report});
    REQUIRE_MESSAGE(baked.exitCode == 0, baked.err);
    CHECK(baked.err.find('\r') == std::string::npos);
    CHECK(baked.out.empty());

    const Json bake = Json::parse(readText(report));
    checkKeys(bake, {"input", "stages", "faces", "parts", "patches", "sections", "streams", "levels", "verdicts"});
    checkKeys(bake["floor"], {"faces", "components", "held", "parts"});
    checkKeys(bake["streams"][0], {"name", "set", "rawBytes", "storedBytes"});
    REQUIRE_FALSE(bake["stages"].empty());
    checkKeys(bake["stages"][0], {"name", "seconds", "peakBytes"});
    for (const Json& verdict : bake["verdicts"]) checkKeys(verdict, {"severity", "what", "where", "remedy"});

    const Json inspect = Json::parse(runXgc({"inspect", out, "--json"}).out);
    checkKeys(inspect, {"faces", "vertices", "positions", "parts", "patches", "levels", "bytes"});
    CHECK(inspect["faces"] == 432);
    checkKeys(inspect["levels"][0], {"faces", "error"});
    checkKeys(inspect["bytes"], {"file", "memory", "base"});
    REQUIRE(inspect["partList"].size() == inspect["parts"]);
    for (const Json& part : inspect["partList"]) {
        checkKeys(part, {"id", "name", "stableId", "faces", "area", "centroid", "neighbours", "box", "salience"});
        checkKeys(part["box"], {"center", "axes", "halfSizes"});
        CHECK(part["box"]["axes"].size() == 3);
        CHECK(part["box"]["axes"][2].size() == 3);
    }
    CHECK(inspect["merges"].is_array());
    const RunResult listed = runXgc({"inspect", out, "--parts"});
    CHECK(listed.exitCode == 0);
    for (const char* word : {"area", "centroid", "box at", "salience", "part-0"})
        CHECK(listed.out.find(word) != std::string::npos);

    const Json verify = Json::parse(runXgc({"verify", out, "--source", in, "--states", "10", "--json"}).out);
    checkKeys(verify,
              {"ok", "states", "faces", "flips", "oddEdges", "fourUseEdges", "errorSamples", "errorViolations"});
    CHECK(verify["ok"] == true);
}

TEST_CASE("a strict bake with warnings exits with 1, writes its report and no asset") {
    const Folder folder("strict");
    const std::string in = folder.file("cube.obj"), out = folder.file("cube.xgc"), report = folder.file("cube.json");
    const std::string cube = cubeObj(12);
    writeText(in, cube);
    CHECK(runXgc({"bake", in, "-o", out, "--strict"}).exitCode == 0);
    CHECK(folder.names() == std::vector<std::string>{"cube.obj", "cube.xgc"});
    std::filesystem::remove(out);

    writeText(in, cube + "v 9 9 9\nf 1 2 -1\n"); // a third face at an edge
    const RunResult strict = runXgc({"bake", in, "-o", out, "--strict", "--report", report});
    CHECK(strict.exitCode == 1);
    CHECK(strict.err.find("warning: ") != std::string::npos);
    CHECK(strict.err.find("cube.xgc is untouched") != std::string::npos);
    CHECK(folder.names() == std::vector<std::string>{"cube.json", "cube.obj"});
    CHECK(Json::parse(readText(report))["verdicts"][0]["severity"] == "warning");
    CHECK(runXgc({"bake", in, "-o", out}).exitCode == 0);
}

TEST_CASE("bake --verbose prints stages, levels and sizes, and cannot be quiet") {
    const Folder folder("verbose");
    const std::string in = folder.file("cube.obj"), out = folder.file("cube.xgc");
    writeText(in, cubeObj(6));
    const RunResult run = runXgc({"bake", in, "-o", out, "--verbose"});
    CHECK(run.exitCode == 0);
    for (const char* word : {"measure", "level", "position", "tables"}) {
        INFO(word);
        CHECK(run.err.find(word) != std::string::npos);
    }
    CHECK(runXgc({"bake", in, "-o", out}).err.find("tables") == std::string::npos);
    CHECK(runXgc({"bake", in, "-o", out, "--verbose", "--quiet"}).exitCode == 2);
}

TEST_CASE("bake --plot draws an SVG of both curves; another extension is refused") {
    const Folder folder("plot");
    const std::string in = folder.file("creature.ply"), out = folder.file("cube.xgc"), plot = folder.file("cube.svg");
    REQUIRE(runXgc({"model", "creature", "-o", in, "--faces", "1000", "--quiet"}).exitCode == 0);
    const std::string report = folder.file("cube.json");
    REQUIRE(runXgc({"bake", in, "-o", out, "--plot", plot, "--report", report}).exitCode == 0);
    const std::string svg = readText(plot);
    CHECK(svg.starts_with("<svg "));
    CHECK(svg.ends_with("</svg>\n"));
    for (const char* word : {"creature.ply", "RMS", "bound E", "polyline"}) {
        INFO(word);
        CHECK(svg.find(word) != std::string::npos);
    }
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
    const Json json = Json::parse(readText(report));
    CHECK(json["stages"].size() == 8);
    for (const Json& level : json["levels"]) CHECK(level["rms"] <= level["error"].get<double>() + 1e-6);

    const RunResult wrong = runXgc({"bake", in, "-o", out, "--plot", folder.file("cube.png")});
    CHECK(wrong.exitCode == 2);
    CHECK(wrong.err.find("cube.png") != std::string::npos);
}

TEST_CASE("a baked asset does not depend on the number of threads") {
    const Folder folder("threads");
    const std::string in = folder.file("cube.obj");
    writeText(in, cubeObj(10));
    std::string first;
    for (const char* jobs : {"1", "2", "5"}) {
        const std::string out = folder.file("cube.xgc");
        const RunResult run = runXgc({"bake", in, "-o", out, "--jobs", jobs, "--quiet"});
        REQUIRE_MESSAGE(run.exitCode == 0, run.err);
        if (first.empty()) first = readText(out);
        CHECK(readText(out) == first);
    }
}
