#include "meshes/builders.h"

#include <xgc/asset.h>
#include <xgc/bake/bake.h>
#include <xgc/bake/import.h>
#include <xgc/bake/snap.h>
#include <xgc/bake/verify.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include <fstream>
#include <unistd.h>

using namespace xgc;
using namespace xgc::bake;
namespace fs = std::filesystem;

namespace {

/// A folder of its own that goes with the test.
struct Folder {
    fs::path path = fs::temp_directory_path() / ("xgc_test_bake_" + std::to_string(getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

void writeOff(const Model& model, const fs::path& file) {
    std::ofstream out(file);
    out << "OFF\n" << model.positions.size() << ' ' << model.triangles.size() << " 0\n";
    out.precision(9);
    for (const glm::vec3& p : model.positions) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec3& t : model.triangles) out << "3 " << t.x << ' ' << t.y << ' ' << t.z << '\n';
}

/// Two spheres that touch nowhere.
Model twoSpheres() {
    Model model = test::sphere(8);
    const Model other = test::sphere(6);
    const auto offset = uint32_t(model.positions.size());
    for (const glm::vec3& p : other.positions) model.positions.push_back(p + glm::vec3(3, 0, 0));
    std::vector<glm::uvec3> triangles = model.triangles;
    for (const glm::uvec3& t : other.triangles) triangles.push_back(t + offset);
    return test::modelOf(model.positions, triangles);
}

std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

BakeOptions optionsFor(const Folder& folder, const char* output) {
    BakeOptions options;
    options.input = folder.path / "in.off";
    options.output = folder.path / output;
    return options;
}

} // namespace

TEST_CASE("a bake of a closed mesh keeps every promise, whatever gives the parts") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    const uint32_t faces = uint32_t(twoSpheres().triangles.size());
    {
        std::ofstream labels(folder.path / "in.seg");
        for (uint32_t f = 0; f < faces; ++f) labels << f % 3 << '\n';
    }
    for (const PartSource source : {PartSource::perceptual, PartSource::thesis, PartSource::none, PartSource::material,
                                    PartSource::component, PartSource::labels}) {
        BakeOptions options = optionsFor(folder, "out.xgc");
        options.parts = source;
        options.labels = folder.path / "in.seg";
        BakeReport report;
        const bake::Status status = bake::bake(options, report);
        REQUIRE_MESSAGE(status.ok(), status.message);
        CHECK(report.faces == faces);
        if (source == PartSource::component) CHECK(report.parts == 2);
        if (source == PartSource::labels) CHECK(report.parts == 3);
        if (source == PartSource::none || source == PartSource::material) CHECK(report.parts == 1);
        AlignedBytes bytes;
        REQUIRE(readFile(options.output, bytes).ok());
        AssetView asset;
        REQUIRE(openAll(bytes.span(), asset).ok());
        Model model;
        REQUIRE(importModel(options.input, model).ok());
        const auto provenance = nlohmann::json::parse(asset.provenance);
        CHECK(provenance["input"] == "in.off");
        CHECK(asset.partShapes.size() == asset.parts.size());
        CHECK(asset.contours.size() == asset.partNeighbours.size());
        // Labels by turns make many neighbours, which all join; two spheres stay apart.
        if (source == PartSource::labels) CHECK(asset.merges.size() == 2);
        if (source == PartSource::component) CHECK(asset.merges.empty());
        CHECK(provenance["inputHash"].get<std::string>().size() == 16);
        VerifyReport verified;
        verifySource(asset, test::welded(model), verified);
        VerifyOptions verifyOptions;
        verifyOptions.states = 20;
        verifyOptions.errorStates = 8;
        verifyOptions.errorSamples = 2000;
        verifyAsset(asset, verifyOptions, verified);
        CHECK(verified.sourceMismatches == 0);
        CHECK(verified.ok());
    }
}

TEST_CASE("snapped positions lie on a grid of a power of two, at most so far from the input as E of level 0 says") {
    Model model = test::sphere(20);
    const float step = snapStep(model, 10);
    CHECK(step == 1.0f / 256); // 2 / 1023, rounded up to a power of two
    CHECK(snapStep(model, 11) == 1.0f / 512);
    const std::vector<glm::vec3> before = model.positions;
    const float distance = snapPositions(model, step);
    for (size_t i = 0; i < before.size(); ++i) {
        CHECK(glm::distance(glm::dvec3(before[i]), glm::dvec3(model.positions[i])) <= distance);
        for (int k = 0; k < 3; ++k) CHECK(model.positions[i][k] * 256 == std::floor(model.positions[i][k] * 256));
    }
    CHECK(distance <= 0.8661 * step + 1e-6);
    const std::vector<glm::vec3> once = model.positions;
    CHECK(snapPositions(model, step) < 1e-30f);
    CHECK(model.positions == once);
}

TEST_CASE("a compressed bake of snapped positions keeps every promise and the same bytes at any number of threads") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    BakeOptions options = optionsFor(folder, "a.xgc");
    options.parts = PartSource::none;
    options.compress = true;
    options.positionBits = 12;
    options.rounding.normalBits = 10;
    BakeReport report;
    const bake::Status status = bake::bake(options, report);
    REQUIRE_MESSAGE(status.ok(), status.message);
    CHECK(report.fileBytes < report.imageBytes);
    AlignedBytes image;
    REQUIRE(readImage(options.output, image).ok());
    CHECK(image.size == report.imageBytes);
    AssetView asset;
    REQUIRE(openAll(image.span(), asset).ok());
    CHECK(asset.record->positionStep == report.positionStep);
    for (uint32_t p = 0; p < asset.patchCount(); ++p) CHECK(asset.error(p, 0) >= report.snapDistance);
    Model model;
    REQUIRE(importModel(options.input, model).ok());
    snapPositions(model, report.positionStep);
    VerifyReport verified;
    VerifyOptions verifyOptions;
    verifyOptions.states = 20;
    verifyOptions.errorStates = 8;
    verifyOptions.errorSamples = 2000;
    verifySource(asset, test::welded(model), verified);
    verifyAsset(asset, verifyOptions, verified);
    CHECK(verified.sourceMismatches == 0);
    CHECK(verified.ok());
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    options.output = folder.path / "b.xgc";
    REQUIRE(bake::bake(options, report).ok());
    CHECK(contents(folder.path / "a.xgc") == contents(folder.path / "b.xgc"));
}

TEST_CASE("the same input gives the same bytes at any number of threads") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    BakeReport report;
    REQUIRE(bake::bake(optionsFor(folder, "a.xgc"), report).ok());
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        REQUIRE(bake::bake(optionsFor(folder, "b.xgc"), report).ok());
    }
    CHECK(!contents(folder.path / "a.xgc").empty());
    CHECK(contents(folder.path / "a.xgc") == contents(folder.path / "b.xgc"));
}

TEST_CASE("a bake that is cancelled or fails leaves the target as it was") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    std::ofstream(folder.path / "out.xgc") << "before";
    std::atomic<bool> cancelled = true;
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.cancelled = &cancelled;
    BakeReport report;
    const bake::Status stopped = bake::bake(options, report);
    CHECK(stopped.outcome == Outcome::system);
    CHECK(stopped.message.find("untouched") != std::string::npos);
    CHECK(contents(folder.path / "out.xgc") == "before");

    options = optionsFor(folder, "out.xgc");
    options.parts = PartSource::labels;
    options.labels = folder.path / "missing.seg";
    const bake::Status refused = bake::bake(options, report);
    CHECK(refused.outcome == Outcome::badInput);
    CHECK(refused.message.find("missing.seg") != std::string::npos);
    CHECK(contents(folder.path / "out.xgc") == "before");
    CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator{}) == 2);
}

TEST_CASE("a strict bake with warnings fails, grades, and leaves the target as it was") {
    const Folder folder;
    Model model = twoSpheres();
    writeOff(model, folder.path / "in.off");
    std::ofstream(folder.path / "out.xgc") << "before";
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.parts = PartSource::none;
    options.strict = true;
    BakeReport report;
    const bake::Status clean = bake::bake(options, report);
    REQUIRE_MESSAGE(clean.ok(), clean.message);
    CHECK(report.warningCount() == 0);
    CHECK(contents(options.output) != "before");

    std::ofstream(folder.path / "out.xgc") << "before";
    std::swap(model.triangles[0].x, model.triangles[0].y); // winds against its neighbours
    writeOff(model, folder.path / "in.off");
    const bake::Status refused = bake::bake(options, report);
    CHECK(refused.outcome == Outcome::promiseBroken);
    CHECK(refused.message.find("out.xgc is untouched") != std::string::npos);
    CHECK(report.warningCount() > 0);
    CHECK(!report.levels.empty());
    CHECK(contents(options.output) == "before");

    options.strict = false;
    CHECK(bake::bake(options, report).ok());
    CHECK(contents(options.output) != "before");
}

TEST_CASE("the sizes of sections and streams add up to the file, compressed or not") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    BakeOptions options = optionsFor(folder, "out.xgc");
    for (const bool compress : {false, true}) {
        options.compress = compress;
        BakeReport report;
        REQUIRE(bake::bake(options, report).ok());
        const auto stored = [](const std::vector<SizeReport>& sizes) {
            uint64_t sum = 0;
            for (const SizeReport& s : sizes) sum += s.storedBytes;
            return sum;
        };
        const uint64_t sum = stored(report.sizes.sections) + stored(report.sizes.streams);
        CHECK(sum <= report.fileBytes);
        const size_t pieces = report.sizes.sections.size() + report.sizes.streams.size() + 2;
        CHECK(report.fileBytes <= sum + 64 * pieces + 48 * report.sizes.sections.size()); // headers, alignment
        CHECK(report.sizes.streams.front().name == std::string("position"));
        CHECK(report.sizes.streams.front().rawBytes == 12 * report.vertices);
        const bool smaller = report.sizes.streams.front().storedBytes < report.sizes.streams.front().rawBytes;
        CHECK(smaller == compress);
    }
}

TEST_CASE("the report holds every stage, level and verdict") {
    const Folder folder;
    Model open = test::grid(8);
    open.triangles.push_back(open.triangles[0]); // a duplicate
    writeOff(open, folder.path / "in.off");
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.parts = PartSource::none;
    BakeReport report;
    REQUIRE(bake::bake(options, report).ok());
    CHECK(report.weld.duplicateFaces == 1);
    const auto json = nlohmann::json::parse(reportJson(options, report));
    for (const char* key :
         {"input", "stages", "faces", "parts", "patches", "sections", "streams", "levels", "verdicts"})
        CHECK(json.contains(key));
    CHECK(json["stages"].size() == 7);
    CHECK(json["faces"] == 128);
    CHECK(json["levels"].size() == report.levels.size());
    CHECK(json["levels"][0]["error"] == 0.0);
    bool named = false;
    for (const auto& verdict : json["verdicts"]) named |= verdict["what"].get<std::string>().starts_with("1 duplicate");
    CHECK(named);
}

TEST_CASE("flat normals hold a mesh up, say so, and give way to smooth ones") {
    const Folder folder;
    std::ofstream out(folder.path / "flat.obj"); // a sphere with a normal for each face
    const Model sphere = test::sphere(8);
    for (const glm::vec3& p : sphere.positions) out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const glm::uvec3& t : sphere.triangles) {
        const glm::vec3 n = sphere.positions[t.x] + sphere.positions[t.y] + sphere.positions[t.z];
        out << "vn " << n.x << ' ' << n.y << ' ' << n.z << '\n';
    }
    for (size_t f = 0; f < sphere.triangles.size(); ++f) {
        const glm::uvec3 t = sphere.triangles[f] + 1u;
        out << "f " << t.x << "//" << f + 1 << ' ' << t.y << "//" << f + 1 << ' ' << t.z << "//" << f + 1 << '\n';
    }
    out.close();
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.input = folder.path / "flat.obj";
    options.parts = PartSource::none;
    BakeReport kept, smoothed;
    REQUIRE(bake::bake(options, kept).ok());
    options.normals = NormalSource::smooth;
    REQUIRE(bake::bake(options, smoothed).ok());
    CHECK(kept.levels.size() == 1);
    CHECK(std::any_of(kept.verdicts.begin(), kept.verdicts.end(),
                      [](const Verdict& v) { return v.remedy.find("--normals smooth") != std::string::npos; }));
    CHECK(smoothed.vertices == smoothed.positions);
    CHECK(smoothed.levels.back().faces * 2 < smoothed.faces);
}

TEST_CASE("what holds an asset up is named: where, why, and what to do") {
    const Folder folder;
    writeOff(test::sphere(24), folder.path / "in.off");
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.parts = PartSource::none;
    BakeReport report;
    REQUIRE(bake::bake(options, report).ok());
    CHECK(report.floor.faces == report.levels.back().faces);
    CHECK(report.floor.faces <= 64);
    CHECK(report.floor.components == 1);
    CHECK(report.verdicts.empty()); // all is well

    const Model sheet = test::grid(24);
    std::vector<glm::vec3> points = sheet.positions;
    std::vector<glm::uvec3> faces = sheet.triangles;
    for (size_t f = 0; f < sheet.triangles.size(); f += 2) { // fins: edges of three faces
        const glm::uvec3 t = sheet.triangles[f];
        points.push_back(points[t.x] + glm::vec3(0, 0, glm::distance(points[t.x], points[t.y])));
        faces.emplace_back(t.x, t.y, uint32_t(points.size() - 1));
    }
    writeOff(test::modelOf(points, faces), folder.path / "in.off");
    REQUIRE(bake::bake(options, report).ok());
    uint32_t held = 0, kept = 0;
    for (const uint32_t h : report.floor.held) held += h;
    for (const PartFloor& p : report.floor.parts) kept += p.faces;
    CHECK(held == report.floor.faces);
    CHECK(kept == report.floor.faces);
    CHECK(report.warningCount() > 0);
}

TEST_CASE("a locked part is held by its lock, and that is no warning") {
    const Folder folder;
    writeOff(twoSpheres(), folder.path / "in.off");
    BakeOptions options = optionsFor(folder, "out.xgc");
    options.parts = PartSource::component;
    options.importance = {{"component-0", std::numeric_limits<float>::infinity()}};
    BakeReport report;
    REQUIRE(bake::bake(options, report).ok());
    REQUIRE(!report.floor.parts.empty());
    const PartFloor& locked = report.floor.parts.front();
    CHECK(report.partNames[locked.part] == "component-0");
    CHECK(locked.faces == locked.baseFaces);
    CHECK(locked.hold == Hold::locked);
    CHECK(locked.heldBy(Hold::locked) == locked.faces);
    CHECK(report.warningCount() == 0);
    const auto json = nlohmann::json::parse(reportJson(options, report));
    CHECK(json["floor"]["parts"][0]["name"] == "component-0");
    CHECK(json["floor"]["held"]["locked"] == locked.faces);
}
