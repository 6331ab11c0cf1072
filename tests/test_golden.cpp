#include "../runtime/src/xxh64.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/bake/models.h>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <unistd.h>

using namespace xgc;
using namespace xgc::bake;
namespace fs = std::filesystem;

namespace {

constexpr uint32_t kFaces = 6000;
#if defined(__has_feature)
constexpr bool kIsSanitized = __has_feature(address_sanitizer);
#else
constexpr bool kIsSanitized = false;
#endif
const std::map<std::string, BundledModel> kModels = {{"creature", BundledModel::creature},
                                                     {"shaft", BundledModel::shaft},
                                                     {"terrain", BundledModel::terrain},
                                                     {"temple", BundledModel::temple},
                                                     {"tree", BundledModel::tree}};

struct Variant {
    const char* name;
    void (*apply)(BakeOptions&);
};
const Variant kVariants[] = {
    {"default", [](BakeOptions&) {}},
    {"optimal", [](BakeOptions& o) { o.hierarchy.placement = Placement::optimal; }},
    {"compressed",
     [](BakeOptions& o) {
         o.positionBits = 14;
         o.rounding.normalBits = 10;
         o.compress = true;
     }},
    {"thesis",
     [](BakeOptions& o) {
         o.preset = Preset::thesis;
         o.parts = PartSource::thesis;
     }},
};

/// A folder of its own that goes with the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("xgc_test_golden_" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

uint64_t hashOfBaked(const fs::path& input, const Variant& variant, size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    BakeOptions options;
    options.input = input;
    options.output = input.parent_path() / "out.xgc";
    variant.apply(options);
    BakeReport report;
    const bake::Status status = bake::bake(options, report);
    REQUIRE_MESSAGE(status.ok(), status.message);
    AlignedBytes bytes;
    REQUIRE(readFile(options.output, bytes).ok());
    return xxh64(bytes.span());
}

} // namespace

// The release build (g++, -O3) and the sanitized one (clang, -O1) run this; `tools/dev sweep compilers` the rest. A
// change that is meant to alter baked files writes the values anew: XGC_PRINT_GOLDEN=1 prints the file.
TEST_CASE("baked models are the same bytes on any compiler, for any number of threads") {
    const Folder folder;
    const bool print = std::getenv("XGC_PRINT_GOLDEN") != nullptr;
    std::map<std::string, uint64_t> golden;
    std::ifstream file(fs::path(XGC_SOURCE_DIR) / "tests/golden/baked_models.txt");
    std::string name;
    for (uint64_t hash = 0; file >> name >> std::hex >> hash;) golden[name] = hash;
    CHECK(golden.size() == kModels.size() * std::size(kVariants));
    for (const auto& [model, which] : kModels) {
        const fs::path input = folder.path / (model + ".glb");
        REQUIRE(exportModel(makeModel(which, kFaces), input).ok());
        for (const Variant& variant : kVariants) {
            const std::string key = fmt::format("{}-{}", model, variant.name);
            const uint64_t hash = hashOfBaked(input, variant, 2);
            if (print) fmt::print("{} {:016x}\n", key, hash);
            CHECK_MESSAGE(hash == golden[key], fmt::format("{} is now {:016x}", key, hash));
            if (kIsSanitized) continue; // slow: the other build compares the numbers of threads
            CHECK_MESSAGE(hashOfBaked(input, variant, 1) == hash, fmt::format("{} differs with one thread", key));
        }
    }
}
