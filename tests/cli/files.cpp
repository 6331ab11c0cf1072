#include "files.h"

#include "meshes/builders.h"

#include <doctest/doctest.h>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace xgc::test {
namespace {

const std::vector<Call> kModelCalls = {
    {{"bake", "{in}", "-o", "{out}"}, ".xgc"},
    {{"bake", "{in}", "-o", "{out}", "--parts", "none"}, ".xgc"},
    {{"segment", "{in}", "-o", "{out}"}, ".seg"},
    {{"verify", "{asset}", "--source", "{in}", "--states", "1"}, ""},
};

const std::vector<Call> kAssetCalls = {
    {{"inspect", "{in}"}, ""},
    {{"inspect", "{in}", "--json"}, ""},
    {{"verify", "{in}", "--states", "1"}, ""},
    {{"verify", "{in}", "--states", "1", "--json"}, ""},
    {{"extract", "{in}", "-o", "{out}"}, ".obj"},
#ifdef XGC_HAS_VULKAN
    {{"render", "{in}", "-o", "{out}", "--size", "16x16"}, ".png"},
#endif
};

const std::vector<Call> kLabelCalls = {
    {{"bake", "{model}", "-o", "{out}", "--parts", "{in}"}, ".xgc"},
};

constexpr std::string_view kOldContent = "what was there before";

constexpr const char* kGoodModel = "good-model.obj";
constexpr const char* kGoodAsset = "good-asset.xgc";

void makeGoodFiles(const Call& call, const Folder& folder) {
    for (const std::string& a : call.arguments) {
        if (a == "{model}") writeText(folder.file(kGoodModel), cubeObj(4));
        if (a == "{asset}") writeText(folder.file(kGoodAsset), bakedCube());
    }
}

std::string join(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& w : words) line += w + ' ';
    return line;
}

} // namespace

Folder::Folder(const std::string& name)
    : path_(std::filesystem::path(XGC_WORK) / (name + '-' + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
}

Folder::~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> Folder::names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

std::string readText(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    REQUIRE_MESSAGE(in.good(), file);
    return {std::istreambuf_iterator<char>(in), {}};
}

void writeText(const std::string& file, std::string_view text) {
    std::ofstream out(file, std::ios::binary);
    out.write(text.data(), std::streamsize(text.size()));
    REQUIRE_MESSAGE(out.good(), file);
}

std::string cubeObj(uint32_t n) {
    const bake::Model model = cube(n);
    std::ostringstream text;
    for (const glm::vec3& p : model.positions) text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec3& t : model.triangles) text << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
    return text.str();
}

const std::string& bakedCube() {
    static const std::string bytes = [] {
        const Folder folder("baked-cube");
        writeText(folder.file("cube.obj"), cubeObj(6));
        const RunResult run =
            runXgc({"bake", folder.file("cube.obj"), "-o", folder.file("cube.xgc"), "--parts", "none", "--quiet"});
        REQUIRE_MESSAGE(run.exitCode == 0, run.err);
        return readText(folder.file("cube.xgc"));
    }();
    return bytes;
}

std::span<const Call> modelCalls() {
    return kModelCalls;
}
std::span<const Call> assetCalls() {
    return kAssetCalls;
}
std::span<const Call> labelCalls() {
    return kLabelCalls;
}

RunResult runCall(const Call& call, const Folder& folder, const std::string& in, const std::string& out,
                  const RunOptions& options) {
    std::vector<std::string> arguments = call.arguments;
    for (std::string& a : arguments) {
        if (a == "{in}") a = in;
        if (a == "{out}") a = out;
        if (a == "{model}") a = folder.file(kGoodModel);
        if (a == "{asset}") a = folder.file(kGoodAsset);
    }
    makeGoodFiles(call, folder);
    return runXgc(arguments, options);
}

void checkRefused(const Call& call, const std::string& in, const Folder& folder, int exitCode) {
    const std::string out = folder.file("out" + call.outputExtension);
    writeText(out, kOldContent);
    makeGoodFiles(call, folder);
    const std::vector<std::string> before = folder.names();
    const RunResult run = runCall(call, folder, in, out);
    INFO(join(call.arguments), " on ", in);
    INFO("stderr: ", run.err);
    CHECK(run.signal == 0);
    CHECK(run.exitCode == exitCode);
    CHECK(run.err.find(std::filesystem::path(in).filename().string()) != std::string::npos);
    CHECK(run.out.empty());
    CHECK(readText(out) == kOldContent);
    CHECK(folder.names() == before);
}

} // namespace xgc::test
