#include "meshes/builders.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/bake/from_asset.h>
#include <xgc/bake/import.h>
#include <xgc/bake/models.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>

using namespace xgc::bake;

namespace {

std::filesystem::path scratch(const std::string& name) {
    const std::filesystem::path dir = std::filesystem::path(XGC_BINARY_DIR) / "test_export";
    std::filesystem::create_directories(dir);
    return dir / name;
}

Model roundTrip(const Model& model, const std::string& name) {
    const std::filesystem::path file = scratch(name);
    const Status written = exportModel(model, file);
    CAPTURE(written.message);
    REQUIRE(written.ok());
    Model back;
    const Status read = importModel(file, back);
    CAPTURE(read.message);
    REQUIRE(read.ok());
    return back;
}

/// Two nodes, two materials, every attribute.
Model rich() {
    Model model = xgc::test::cube(3);
    model.materials.resize(2);
    model.materials[0] = {"red \"clay\"", {0.8f, 0.1f, 0.05f, 1}, 0, 0.75f, {0, 0, 0}, false, false, false};
    model.materials[1] = {"glass", {0.1f, 0.9f, 0.3f, 0.25f}, 0.5f, 0.125f, {0.5f, 0.25f, 0}, true, false, true};
    model.nodes = {{"root", kNone, glm::mat4(1)}, {"left half", 0, glm::mat4(1)}, {"right half", 0, glm::mat4(1)}};
    for (size_t t = 0; t < model.triangles.size(); ++t) {
        model.triangleMaterial[t] = uint32_t(t % 3 == 0);
        model.triangleNode[t] = model.positions[model.triangles[t].x].x < 0 ? 1 : 2;
    }
    const auto rows = model.positions.size();
    Attributes& a = model.attributes;
    for (size_t row = 0; row < rows; ++row) {
        const float f = float(row) / float(rows);
        a.normals.push_back(glm::normalize(model.positions[row]));
        a.tangents.emplace_back(0.6f, 0, 0.8f, row % 2 ? 1.0f : -1.0f);
        for (auto& set : a.uvs) set.emplace_back(f, 0.1f + f);
        for (auto& set : a.colors) set.emplace_back(f, 1 - f, 0.3f, 1.0f);
        for (auto& set : a.joints) set.emplace_back(row % 2, 1, 0, 0);
        for (auto& set : a.weights) set.emplace_back(0.375f, 0.125f, 0, 0);
    }
    for (const char* name : {"smile", "frown"}) {
        MorphTarget shape;
        shape.name = name;
        for (size_t row = 0; row < rows; ++row) shape.positions.emplace_back(0.01f * float(row), 0, 0.5f);
        if (model.attributes.morphTargets.empty()) shape.normals.assign(rows, glm::vec3(0, 0.25f, 0));
        a.morphTargets.push_back(shape);
    }
    return model;
}

/// Triangles by the names of their node and material, in order.
using Key = std::pair<std::string, std::string>;
std::map<Key, std::vector<glm::uvec3>> byNames(const Model& model) {
    std::map<Key, std::vector<glm::uvec3>> out;
    for (size_t t = 0; t < model.triangles.size(); ++t) {
        const uint32_t node = model.triangleNode[t];
        out[{node == kNone ? "" : model.nodes[node].name, model.materials[model.triangleMaterial[t]].name}].push_back(
            model.triangles[t]);
    }
    return out;
}

template <typename T>
bool sameBits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Compares a column corner by corner over the same triangles in the same order.
template <typename T>
bool sameColumn(const Model& a, const std::vector<T>& columnA, const Model& b, const std::vector<T>& columnB) {
    if (columnA.empty() != columnB.empty()) return false;
    if (columnA.empty()) return true;
    const auto trianglesA = byNames(a), trianglesB = byNames(b);
    if (trianglesA.size() != trianglesB.size()) return false;
    for (const auto& [key, list] : trianglesA) {
        const auto other = trianglesB.find(key);
        if (other == trianglesB.end() || other->second.size() != list.size()) return false;
        for (size_t t = 0; t < list.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                if (!sameBits(columnA[list[t][k]], columnB[other->second[t][k]])) return false;
            }
        }
    }
    return true;
}

std::string readText(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST_CASE("a .glb keeps every attribute, name and material exactly") {
    const Model model = rich(), back = roundTrip(model, "rich.glb");
    const Attributes &a = model.attributes, &b = back.attributes;
    CHECK(sameColumn(model, model.positions, back, back.positions));
    CHECK(sameColumn(model, a.normals, back, b.normals));
    CHECK(sameColumn(model, a.tangents, back, b.tangents));
    for (size_t set = 0; set < Attributes::kUvSets; ++set) CHECK(sameColumn(model, a.uvs[set], back, b.uvs[set]));
    for (size_t set = 0; set < Attributes::kColorSets; ++set) {
        CHECK(sameColumn(model, a.colors[set], back, b.colors[set]));
    }
    for (size_t set = 0; set < Attributes::kJointSets; ++set) {
        CHECK(sameColumn(model, a.joints[set], back, b.joints[set]));
        CHECK(sameColumn(model, a.weights[set], back, b.weights[set]));
    }
    REQUIRE(b.morphTargets.size() == 2);
    for (size_t shape = 0; shape < 2; ++shape) {
        CHECK(b.morphTargets[shape].name == a.morphTargets[shape].name);
        CHECK(sameColumn(model, a.morphTargets[shape].positions, back, b.morphTargets[shape].positions));
    }
    CHECK(sameColumn(model, a.morphTargets[0].normals, back, b.morphTargets[0].normals));
    REQUIRE(back.materials.size() == 2);
    for (size_t m = 0; m < 2; ++m) {
        CHECK(back.materials[m].name == model.materials[m].name);
        CHECK(sameBits(back.materials[m].baseColor, model.materials[m].baseColor));
        CHECK(back.materials[m].metallic == model.materials[m].metallic);
        CHECK(back.materials[m].roughness == model.materials[m].roughness);
        CHECK(sameBits(back.materials[m].emissive, model.materials[m].emissive));
        CHECK(back.materials[m].doubleSided == model.materials[m].doubleSided);
        CHECK(back.materials[m].alphaBlend == model.materials[m].alphaBlend);
    }
}

TEST_CASE("a .glb of a moved node keeps positions exact: the node itself stands at the origin") {
    Model model = rich();
    model.nodes[0].toMesh[3] = glm::vec4(3, 1, 4, 1);
    model.nodes[1].toMesh[3] = glm::vec4(0.1f, 0.7f, 0.3f, 1);
    model.nodes.push_back({"lamp", 1, glm::mat4(1)});
    model.nodes.back().toMesh[3] = glm::vec4(5, 6, 7, 1);
    const Model back = roundTrip(model, "moved.glb");
    CHECK(sameColumn(model, model.positions, back, back.positions));
    bool found = false;
    for (const SceneNode& node : back.nodes) {
        if (node.name != "lamp") continue;
        found = true;
        CHECK(node.toMesh[3].x == doctest::Approx(5));
        CHECK(node.toMesh[3].z == doctest::Approx(7));
    }
    CHECK(found);
}

TEST_CASE("bundled models come back from .glb bit for bit") {
    for (const BundledModel which : {BundledModel::creature, BundledModel::shaft, BundledModel::temple}) {
        const Model model = makeModel(which, 20000), back = roundTrip(model, "model.glb");
        CAPTURE(int(which));
        CHECK(back.triangles.size() == model.triangles.size());
        CHECK(sameColumn(model, model.positions, back, back.positions));
        CHECK(sameColumn(model, model.attributes.normals, back, back.attributes.normals));
        CHECK(sameColumn(model, model.attributes.uvs[0], back, back.attributes.uvs[0]));
        CHECK(sameColumn(model, model.attributes.colors[0], back, back.attributes.colors[0]));
    }
}

TEST_CASE("a .ply keeps rows and faces in order, positions and normals exact, colours to 8 bits") {
    const Model model = makeModel(BundledModel::terrain, 5000), back = roundTrip(model, "terrain.ply");
    REQUIRE(back.triangles.size() == model.triangles.size());
    for (size_t t = 0; t < model.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = model.triangles[t][k], b = back.triangles[t][k];
            REQUIRE(sameBits(model.positions[a], back.positions[b]));
            REQUIRE(sameBits(model.attributes.normals[a], back.attributes.normals[b]));
            const glm::vec4 d = model.attributes.colors[0][a] - back.attributes.colors[0][b];
            REQUIRE(glm::dot(d, d) < 4 * 0.0021f * 0.0021f);
        }
    }
}

TEST_CASE("an .obj keeps positions exactly, faces in order within a material, and materials by name") {
    Model model = rich();
    for (glm::vec3& p : model.positions) p = p * 1.2345678f + glm::vec3(1e-7f, -123.456f, 3e8f);
    const Model back = roundTrip(model, "rich.obj");
    REQUIRE(back.triangles.size() == model.triangles.size());
    std::map<std::string, std::vector<glm::vec3>> corners[2];
    for (int side = 0; side < 2; ++side) {
        const Model& m = side ? back : model;
        // The file lists the left half first.
        for (const uint32_t node : {1u, 2u}) {
            for (size_t t = 0; t < m.triangles.size(); ++t) {
                if (side == 0 && m.triangleNode[t] != node) continue;
                if (side == 1 && node == 2) continue;
                const std::string& name = m.materials[m.triangleMaterial[t]].name;
                for (int k = 0; k < 3; ++k)
                    corners[side][name[0] == 'g' ? "g" : "r"].push_back(m.positions[m.triangles[t][k]]);
            }
        }
    }
    CHECK(corners[0].size() == 2);
    for (const auto& [name, list] : corners[0]) {
        const std::string material = name;
        CAPTURE(material);
        REQUIRE(corners[1][name].size() == list.size());
        bool same = true;
        for (size_t i = 0; i < list.size(); ++i) same = same && sameBits(list[i], corners[1][name][i]);
        CHECK(same);
    }
    CHECK(readText(scratch("rich.mtl")).find("newmtl glass") != std::string::npos);
}

TEST_CASE("an .obj without named materials has no .mtl") {
    const std::filesystem::path file = scratch("bare.obj");
    std::filesystem::remove(scratch("bare.mtl"));
    REQUIRE(exportModel(xgc::test::cube(1), file).ok());
    CHECK(!std::filesystem::exists(scratch("bare.mtl")));
    CHECK(readText(file).find("mtllib") == std::string::npos);
}

TEST_CASE("exports are the same bytes every time") {
    for (const char* name : {"again.glb", "again.obj", "again.ply"}) {
        REQUIRE(exportModel(rich(), scratch(name)).ok());
        const std::string first = readText(scratch(name));
        REQUIRE(exportModel(rich(), scratch(name)).ok());
        CHECK(readText(scratch(name)) == first);
        CHECK(!first.empty());
    }
}

TEST_CASE("an extension that cannot be written is a usage error that names those that can") {
    for (const char* name : {"x.stl", "x", "x.gltf", "x.glb.txt"}) {
        const Status status = exportModel(xgc::test::cube(1), scratch(name));
        CHECK(status.outcome == Outcome::usage);
        CHECK(status.message.find(".glb, .obj or .ply") != std::string::npos);
        CHECK(!std::filesystem::exists(scratch(name)));
    }
    CHECK(exportModel(xgc::test::cube(1), scratch("upper.PLY")).ok());
}

TEST_CASE("a model without faces and a folder that is not there are refused") {
    CHECK(exportModel(Model{}, scratch("empty.glb")).outcome == Outcome::badInput);
    CHECK(!exportModel(xgc::test::cube(1), scratch("no/such/folder.glb")).ok());
}

namespace {

struct Baked {
    Model source;
    AlignedBytes bytes;
    xgc::AssetView asset;
};

/// The temple as an asset with a part a material.
Baked bakedTemple() {
    Baked baked;
    baked.source = makeModel(BundledModel::temple, 3000);
    BakeOptions options;
    options.input = scratch("baked.glb");
    options.output = scratch("baked.xgc");
    options.parts = PartSource::material;
    REQUIRE(exportModel(baked.source, options.input).ok());
    BakeReport report;
    const Status status = bake(options, report);
    CAPTURE(status.message);
    REQUIRE(status.ok());
    REQUIRE(readFile(options.output, baked.bytes).ok());
    REQUIRE(xgc::openAll(baked.bytes.span(), baked.asset).ok());
    return baked;
}

/// Corners of all triangles, each triangle from its least corner on, sorted.
using Corner = std::array<float, 3>;
std::vector<std::array<Corner, 3>> sortedTriangles(const Model& model) {
    std::vector<std::array<Corner, 3>> out;
    for (const glm::uvec3 t : model.triangles) {
        std::array<Corner, 3> corners;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 p = model.positions[t[k]];
            corners[k] = {p.x, p.y, p.z};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        out.push_back(corners);
    }
    std::sort(out.begin(), out.end());
    return out;
}

} // namespace

TEST_CASE("level 0 of an asset is the input's triangles, with its materials and close attributes") {
    const Baked baked = bakedTemple();
    Model back;
    REQUIRE(modelFromAsset(baked.asset, std::vector<uint8_t>(baked.asset.patchCount(), 0), back).ok());
    CHECK(sortedTriangles(back) == sortedTriangles(baked.source));
    std::map<std::string, size_t> faces[2];
    for (const uint32_t m : baked.source.triangleMaterial) ++faces[0][baked.source.materials[m].name];
    for (const uint32_t m : back.triangleMaterial) ++faces[1][back.materials[m].name];
    CHECK(faces[0] == faces[1]);

    // Rows: each has a source row of the same position, uv and colour (8 bits) with nearly its normal.
    std::multimap<Corner, uint32_t> rows;
    const auto corner = [](glm::vec3 p) { return Corner{p.x, p.y, p.z}; };
    for (uint32_t r = 0; r < baked.source.positions.size(); ++r) rows.emplace(corner(baked.source.positions[r]), r);
    size_t matched = 0;
    for (uint32_t r = 0; r < back.positions.size(); ++r) {
        const auto [first, last] = rows.equal_range(corner(back.positions[r]));
        matched += std::any_of(first, last, [&](const auto& entry) {
            const Attributes &a = baked.source.attributes, &b = back.attributes;
            const uint32_t s = entry.second;
            const glm::vec4 color = a.colors[0][s] - b.colors[0][r];
            return a.uvs[0][s] == b.uvs[0][r] && glm::dot(a.normals[s], b.normals[r]) > 0.99999f &&
                   glm::dot(color, color) < 4 * 0.0021f * 0.0021f;
        });
    }
    CHECK(matched == back.positions.size());
}

TEST_CASE("coarser levels of an asset have fewer triangles, all over used rows") {
    const Baked baked = bakedTemple();
    Model fine, coarse;
    const std::vector<uint8_t> last(baked.asset.patchCount(), uint8_t(baked.asset.levelCount() - 1));
    REQUIRE(modelFromAsset(baked.asset, std::vector<uint8_t>(last.size(), 0), fine).ok());
    REQUIRE(modelFromAsset(baked.asset, last, coarse).ok());
    CHECK(coarse.triangles.size() < fine.triangles.size());
    std::vector<char> used(coarse.positions.size(), 0);
    for (const glm::uvec3 t : coarse.triangles) {
        for (int k = 0; k < 3; ++k) used[t[k]] = 1;
    }
    CHECK(std::find(used.begin(), used.end(), 0) == used.end());
    CHECK(coarse.attributes.normals.size() == coarse.positions.size());
}

TEST_CASE("a state of the wrong length or beyond the levels is a usage error that names the limits") {
    const Baked baked = bakedTemple();
    Model out;
    std::vector<uint8_t> levels(baked.asset.patchCount() + 1, 0);
    Status status = modelFromAsset(baked.asset, levels, out);
    CHECK(status.outcome == Outcome::usage);
    CHECK(status.message.find(std::to_string(baked.asset.patchCount()) + " patches") != std::string::npos);
    levels.pop_back();
    levels.back() = uint8_t(baked.asset.levelCount());
    status = modelFromAsset(baked.asset, levels, out);
    CHECK(status.outcome == Outcome::usage);
    CHECK(status.message.find("0 to " + std::to_string(baked.asset.levelCount() - 1)) != std::string::npos);
    CHECK(out.triangles.empty());
}
