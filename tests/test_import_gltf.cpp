#include "meshes/builders.h"
#include "meshes/gltf_text.h"

#include <xgc/bake/import.h>

#include <doctest/doctest.h>

#include <cstdio>

using namespace xgc::bake;
using xgc::test::GltfText;

namespace {

const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text));
}

Model read(const std::string& json) {
    Model model;
    const Status s = importModelFromMemory(bytesOf(json), ".gltf", model);
    INFO(s.message);
    REQUIRE(s.ok());
    return model;
}

std::string refusal(const std::string& json) {
    Model model;
    model.file = "untouched";
    const Status s = importModelFromMemory(bytesOf(json), ".gltf", model);
    CHECK(s.outcome == Outcome::badInput);
    CHECK(model.file == "untouched");
    return s.message;
}

bool names(const std::string& message, const std::string& part) {
    INFO(message);
    CHECK(message.find(part) != std::string::npos);
    return message.find(part) != std::string::npos;
}

/// The unit square in z = 0 as two triangles with 16-bit indices.
GltfText square() {
    GltfText g;
    g.floats("VEC3", 3, kSquare);
    g.accessor(g.view(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}), 5123, "SCALAR", 6);
    g.primitives = R"([{"attributes":{"POSITION":0},"indices":1}])";
    return g;
}

glm::vec3 faceNormal(const Model& m, size_t t) {
    const glm::uvec3 c = m.triangles[t];
    return glm::cross(m.positions[c.y] - m.positions[c.x], m.positions[c.z] - m.positions[c.x]);
}

} // namespace

TEST_CASE("indices of every type, and none, give the same triangles") {
    const auto check = [](const Model& m) {
        REQUIRE(m.triangles.size() == 2);
        CHECK(m.triangles[0] == glm::uvec3(0, 1, 2));
        CHECK(m.triangles[1] == glm::uvec3(0, 2, 3));
        CHECK(m.inputFaceCount == 2);
        CHECK(m.materials.size() == 1);
    };
    check(read(square().json()));
    GltfText small, large;
    for (GltfText* g : {&small, &large}) {
        g->floats("VEC3", 3, kSquare);
        g->primitives = R"([{"attributes":{"POSITION":0},"indices":1}])";
    }
    small.accessor(small.view(std::vector<uint8_t>{0, 1, 2, 0, 2, 3}), 5121, "SCALAR", 6);
    large.accessor(large.view(std::vector<uint32_t>{0, 1, 2, 0, 2, 3}), 5125, "SCALAR", 6);
    check(read(small.json()));
    check(read(large.json()));

    GltfText none;
    none.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 1, 1, 0, 5, 5, 5, 6, 5, 5, 6, 6, 5});
    none.primitives = R"([{"attributes":{"POSITION":0}}])";
    CHECK(read(none.json()).triangles == std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}});
}

TEST_CASE("strips and fans keep the winding, points and lines are left out") {
    GltfText g;
    g.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    g.floats("VEC3", 3, kSquare);
    g.primitives = R"([{"attributes":{"POSITION":0},"mode":5},{"attributes":{"POSITION":1},"mode":6},)"
                   R"({"attributes":{"POSITION":0},"mode":0},{"attributes":{"POSITION":0},"mode":3}])";
    const Model m = read(g.json());
    REQUIRE(m.triangles.size() == 4);
    CHECK(m.positions.size() == 8);
    for (size_t t = 0; t < 4; ++t) CHECK(faceNormal(m, t) == glm::vec3(0, 0, 1));
    CHECK(m.triangleFace == std::vector<uint32_t>{0, 1, 2, 3});
}

TEST_CASE("sparse accessors replace what they name, also over zeros") {
    GltfText g = square();
    const int index = g.view(std::vector<uint16_t>{2}), value = g.view(std::vector<float>{7, 8, 9});
    const std::string sparse =
        fmt::format(R"(,"sparse":{{"count":1,"indices":{{"bufferView":{},"componentType":5123}},)"
                    R"("values":{{"bufferView":{}}}}})",
                    index, value);
    g.accessor(0, 5126, "VEC3", 4, sparse);
    g.accessor(-1, 5126, "VEC3", 4, sparse);
    g.primitives = R"([{"attributes":{"POSITION":2,"NORMAL":3},"indices":1}])";
    const Model m = read(g.json());
    CHECK(m.positions[1] == glm::vec3(1, 0, 0));
    CHECK(m.positions[2] == glm::vec3(7, 8, 9));
    CHECK(m.attributes.normals[1] == glm::vec3(0));
    CHECK(glm::length(m.attributes.normals[2]) == doctest::Approx(1)); // and made unit

    GltfText outside = square();
    const int bad = outside.view(std::vector<uint16_t>{4}), v = outside.view(std::vector<float>{7, 8, 9});
    outside.accessor(0, 5126, "VEC3", 4,
                     fmt::format(R"(,"sparse":{{"count":1,"indices":{{"bufferView":{},"componentType":5123}},)"
                                 R"("values":{{"bufferView":{}}}}})",
                                 bad, v));
    outside.primitives = R"([{"attributes":{"POSITION":2},"indices":1}])";
    CHECK(names(refusal(outside.json()), "sparse index 4 past its 4 elements"));
}

TEST_CASE("interleaved streams are read with their stride") {
    GltfText g;
    std::vector<float> rows;
    for (size_t i = 0; i < 4; ++i) {
        rows.insert(rows.end(), kSquare.begin() + std::ptrdiff_t(i * 3), kSquare.begin() + std::ptrdiff_t(i * 3 + 3));
        rows.insert(rows.end(), {float(i), 0.5f});
    }
    const int view = g.view(rows, 20);
    g.accessor(view, 5126, "VEC3", 4);
    g.accessor(view, 5126, "VEC2", 4, R"(,"byteOffset":12)");
    g.primitives = R"([{"attributes":{"POSITION":0,"TEXCOORD_1":1},"mode":6}])";
    const Model m = read(g.json());
    CHECK(m.positions[2] == glm::vec3(1, 1, 0));
    CHECK(m.attributes.uvs[1] == std::vector<glm::vec2>{{0, 0.5f}, {1, 0.5f}, {2, 0.5f}, {3, 0.5f}});
    CHECK(m.attributes.uvs[0].empty());
}

TEST_CASE("normalized integers become fractions, colours of three components get alpha one") {
    GltfText g = square();
    g.accessor(g.view(std::vector<uint8_t>{255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 0}, 4), 5121, "VEC3",
               4, R"(,"normalized":true)");
    g.accessor(g.view(std::vector<uint16_t>(16, 65535)), 5123, "VEC4", 4, R"(,"normalized":true)");
    g.accessor(g.view(std::vector<int8_t>{0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, -128, 0}, 4), 5120, "VEC3", 4,
               R"(,"normalized":true)");
    g.primitives = R"([{"attributes":{"POSITION":0,"COLOR_0":2,"COLOR_1":3,"NORMAL":4},"indices":1}])";
    const Model m = read(g.json());
    CHECK(m.attributes.colors[0][0] == glm::vec4(1, 0, 51 / 255.0f, 1));
    CHECK(m.attributes.colors[0][3] == glm::vec4(1));
    CHECK(m.attributes.colors[1][2] == glm::vec4(1));
    CHECK(m.attributes.normals[0] == glm::vec3(0, 0, 1));
    CHECK(m.attributes.normals[3] == glm::vec3(0, 0, -1));
}

TEST_CASE("quantized positions are placed by their node") {
    GltfText g;
    g.accessor(g.view(std::vector<int16_t>{0, 0, 0, 0, 100, 0, 0, 0, 100, 100, 0, 0}, 8), 5122, "VEC3", 3);
    g.primitives = R"([{"attributes":{"POSITION":0}}])";
    g.nodes = R"([{"mesh":0,"scale":[0.5,0.5,0.5]}])";
    g.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
    CHECK(read(g.json()).positions[2] == glm::vec3(50, 50, 0));
}

TEST_CASE("a mesh under several nodes is copied, each with its own transform") {
    GltfText g = square();
    g.nodes = R"([{"name":"root","children":[1,2],"translation":[0,0,5]},{"name":"a","mesh":0},)"
              R"({"name":"b","mesh":0,"rotation":[0,0,1,0],"scale":[2,2,2]},{"name":"loose","mesh":0}])";
    g.more = R"(,"scenes":[{"nodes":[3]},{"nodes":[0]}],"scene":1)";
    const Model m = read(g.json());
    CHECK(m.triangles.size() == 4);
    REQUIRE(m.nodes.size() == 3);
    CHECK(m.nodes[2].name == "b");
    CHECK(m.nodes[2].parent == 0);
    CHECK(m.triangleNode == std::vector<uint32_t>{1, 1, 2, 2});
    CHECK(m.positions[2] == glm::vec3(1, 1, 5));
    CHECK(m.positions[6] == glm::vec3(-2, -2, 5));
    CHECK(m.triangles[2] == glm::uvec3(4, 5, 6));
}

TEST_CASE("a mirroring node flips winding, normals and tangents as its geometry") {
    GltfText g = square();
    g.floats("VEC3", 3, {0, 0, 1, 0, 0, 1, 0.6f, 0, 0.8f, 0, 0, 1});
    g.floats("VEC4", 4, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1});
    g.primitives = R"([{"attributes":{"POSITION":0,"NORMAL":2,"TANGENT":3},"indices":1}])";
    g.nodes = R"([{"mesh":0,"scale":[-2,1,1]}])";
    const Model m = read(g.json());
    CHECK(m.positions[1] == glm::vec3(-2, 0, 0));
    for (size_t t = 0; t < 2; ++t) CHECK(faceNormal(m, t).z > 0); // still faces +z, as its normals do
    CHECK(m.attributes.normals[0] == glm::vec3(0, 0, 1));
    const glm::vec3 n = m.attributes.normals[2]; // (0.6, 0, 0.8) by the inverse transpose: (-0.3, 0, 0.8), unit
    CHECK(n.x / n.z == doctest::Approx(-0.375));
    CHECK(glm::length(n) == doctest::Approx(1));
    CHECK(m.attributes.tangents[0] == glm::vec4(-1, 0, 0, -1));
    CHECK(m.attributes.tangents[3].w == 1);
}

TEST_CASE("morph targets are displacements by the linear part, with names") {
    GltfText g = square();
    g.floats("VEC3", 3, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    g.primitives = R"([{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"targets":[{"POSITION":0,"NORMAL":2},{}]},)"
                   R"({"attributes":{"POSITION":0},"indices":1}])";
    g.nodes = R"([{"mesh":0,"scale":[2,2,2],"translation":[9,9,9]}])";
    std::string json = g.json();
    json.replace(json.find(R"("meshes":[{)"), 11, R"("meshes":[{"extras":{"targetNames":["smile"]},)");
    const Model m = read(json);
    REQUIRE(m.attributes.morphTargets.size() == 2);
    const MorphTarget& smile = m.attributes.morphTargets[0];
    CHECK(smile.name == "smile");
    REQUIRE(smile.positions.size() == 8);
    CHECK(smile.positions[1] == glm::vec3(2, 0, 0));
    CHECK(smile.positions[5] == glm::vec3(0));     // the second primitive has none
    CHECK(smile.normals[1] == glm::vec3(0, 0, 1)); // unit normals are not scaled
    CHECK(m.attributes.morphTargets[1].positions.empty());
    CHECK(m.attributes.normals[5] == glm::vec3(0));
}

TEST_CASE("a skinned mesh stays in its bind space; padding joints become zero") {
    GltfText g = square();
    g.accessor(g.view(std::vector<uint8_t>{0, 1, 9, 9, 0, 1, 9, 9, 0, 1, 9, 9, 0, 1, 9, 9}), 5121, "VEC4", 4);
    g.floats("VEC4", 4, {0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0});
    g.floats("MAT4", 16,
             {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 0, 0, 1});
    g.primitives = R"([{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"indices":1},)"
                   R"({"attributes":{"POSITION":0},"indices":1}])";
    g.nodes = R"([{"mesh":0,"skin":0,"translation":[5,5,5]},{"name":"hip","translation":[0,0,3],"children":[2]},)"
              R"({"name":"knee"}])";
    g.more = R"(,"skins":[{"name":"s","joints":[2,1],"inverseBindMatrices":4}],"scenes":[{"nodes":[0,1]}])";
    const Model m = read(g.json());
    CHECK(m.positions[1] == glm::vec3(1, 0, 0));
    REQUIRE(m.skins.size() == 1);
    CHECK(m.nodes[m.skins[0].joints[0]].name == "knee");
    CHECK(m.nodes[m.skins[0].joints[0]].toMesh[3].z == 3);
    CHECK(m.skins[0].inverseBind[1][3].x == 4);
    CHECK(m.nodes[0].skin == 0);
    CHECK(m.attributes.joints[0][0] == glm::u16vec4(0, 1, 0, 0));
    CHECK(m.attributes.weights[0][4] == glm::vec4(1, 0, 0, 0)); // the second primitive has none

    GltfText far = g;
    far.more = R"(,"skins":[{"joints":[2],"inverseBindMatrices":4}],"scenes":[{"nodes":[0,1]}])";
    CHECK(names(refusal(far.json()), "vertex 0 follows joint 1 of 1"));
}

TEST_CASE("joints outside the scene are nodes all the same") {
    GltfText g = square();
    g.nodes = R"([{"mesh":0,"skin":0},{"name":"outside","mesh":0}])";
    g.more = R"(,"skins":[{"joints":[1]}],"scenes":[{"nodes":[0]}])";
    const Model m = read(g.json());
    CHECK(m.triangles.size() == 2);
    REQUIRE(m.nodes.size() == 2);
    CHECK(m.nodes[1].name == "outside");
}

TEST_CASE("materials are read, and one is made where a primitive has none") {
    GltfText g = square();
    g.primitives =
        R"([{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":0},"indices":1,"material":0}])";
    g.more =
        R"(,"materials":[{"name":"red","pbrMetallicRoughness":{"baseColorFactor":[1,0,0,0.5],"metallicFactor":0.25},)"
        R"("alphaMode":"BLEND","doubleSided":true,"emissiveFactor":[0,0.5,0],)"
        R"("extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}}}])";
    const Model m = read(g.json());
    REQUIRE(m.materials.size() == 2);
    CHECK(m.triangleMaterial == std::vector<uint32_t>{1, 1, 0, 0});
    CHECK(m.materials[0].name == "red");
    CHECK(m.materials[0].baseColor == glm::vec4(1, 0, 0, 0.5f));
    CHECK(m.materials[0].metallic == 0.25f);
    CHECK(m.materials[0].emissive == glm::vec3(0, 2, 0));
    CHECK(m.materials[0].alphaBlend);
    CHECK(m.materials[0].doubleSided);
    CHECK(m.materials[1].name == "default");
}

TEST_CASE("missing images are no error") {
    GltfText g = square();
    g.more = R"(,"images":[{"uri":"nowhere.png"},{"bufferView":99,"mimeType":"image/png"}],"textures":[{"source":0}],)"
             R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    CHECK(read(g.json()).triangles.size() == 2);
}

TEST_CASE("unsupported required extensions are refused by name, harmless ones are not") {
    for (const std::string name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_unheard_of"}) {
        GltfText g = square();
        g.more = fmt::format(R"(,"extensionsRequired":["KHR_materials_unlit","{}"])", name);
        CHECK(names(refusal(g.json()), name));
    }
    GltfText g = square();
    g.more = R"(,"extensionsRequired":["KHR_materials_unlit","KHR_texture_transform","KHR_texture_basisu"])";
    CHECK(read(g.json()).triangles.size() == 2);
}

TEST_CASE("accessors that reach past their data are refused before anything is read") {
    struct Case {
        const char* accessor;
        const char* message;
    };
    for (const Case c :
         {Case{R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":5})", "reach past the 48"},
          Case{R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4,"byteOffset":4})", "reach past"},
          Case{R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4,"byteOffset":18446744073709551608})",
               "reach past"},
          Case{R"({"bufferView":9,"componentType":5126,"type":"VEC3","count":4})", "buffer view 9 of"},
          Case{R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4611686018427387905})", "promises"},
          Case{R"({"componentType":5126,"type":"VEC3","count":1000000000})", "promises 1000000000"},
          Case{R"({"bufferView":0,"componentType":5126,"type":"VEC2","count":4})", "2 components where 3"},
          Case{R"({"bufferView":0,"componentType":5130,"type":"VEC3","count":2})", "component type 5130"}}) {
        GltfText g = square();
        std::string json = g.json();
        const std::string old = R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4})";
        json.replace(json.find(old), old.size(), c.accessor);
        CHECK(names(refusal(json), c.message));
    }
    GltfText g = square();
    g.accessor(g.view(std::vector<uint8_t>{0, 1, 4}), 5121, "SCALAR", 3);
    g.primitives = R"([{"attributes":{"POSITION":0},"indices":2}])";
    CHECK(names(refusal(g.json()), "index 2 names vertex 4 of 4"));
    g.primitives = R"([{"attributes":{"POSITION":0,"NORMAL":77},"indices":1}])";
    CHECK(names(refusal(g.json()), "accessor 77 of 3"));
    g.primitives = R"([{"attributes":{"NORMAL":0},"indices":1}])";
    CHECK(names(refusal(g.json()), "no POSITION"));
    g.primitives = R"([{"attributes":{"POSITION":0},"indices":1,"material":3}])";
    CHECK(names(refusal(g.json()), "material 3 of 0"));
}

TEST_CASE("broken node trees are refused") {
    GltfText g = square();
    g.nodes = R"([{"children":[1]},{"children":[2]},{"children":[1],"mesh":0}])";
    g.more = R"(,"scenes":[{"nodes":[0]}])";
    CHECK(names(refusal(g.json()), "node 1 has two parents or is its own ancestor"));
    g.nodes = R"([{"children":[5]}])";
    CHECK(names(refusal(g.json()), "node 5 of 1"));
    g.nodes = R"([{"mesh":3}])";
    CHECK(names(refusal(g.json()), "mesh 3 of 1"));
    g.nodes = R"([{"mesh":0,"skin":0}])";
    CHECK(names(refusal(g.json()), "skin 0 of 0"));
    g.nodes = R"([{"mesh":0}])";
    g.more = R"(,"scenes":[{"nodes":[0]}],"scene":4)";
    CHECK(names(refusal(g.json()), "default scene 4 of 1"));
}

TEST_CASE("deep nesting, whether of nodes or of JSON, does not exhaust the stack") {
    GltfText g = square();
    g.nodes = R"([{"mesh":0})";
    for (int i = 1; i < 20000; ++i) g.nodes += fmt::format(R"(,{{"children":[{}]}})", i - 1);
    g.nodes += "]";
    CHECK(read(g.json()).nodes.size() == 20000);
    GltfText deep = square();
    deep.more = R"(,"extras":)" + std::string(200000, '[') + std::string(200000, ']');
    CHECK(names(refusal(deep.json()), "nested too deeply"));
}

TEST_CASE("instancing past the limits is refused") {
    GltfText g = square();
    g.nodes = R"([{"mesh":0},{"mesh":0},{"mesh":0}])";
    Model m;
    ImportLimits limits;
    limits.maxFaces = 5;
    CHECK(names(importModelFromMemory(bytesOf(g.json()), ".gltf", m, limits).message, "more than 5 faces"));
    limits = {};
    limits.maxVertices = 11;
    CHECK(names(importModelFromMemory(bytesOf(g.json()), ".gltf", m, limits).message, "more than 11 vertices"));
}

TEST_CASE("other glTF versions, external buffers and wrong JSON are refused clearly") {
    std::string json = square().json();
    json.replace(json.find("2.0"), 3, "1.0");
    CHECK(names(refusal(json), "glTF version 1.0"));
    CHECK(names(refusal(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"a.bin"}]})"), "a.bin"));
    CHECK(names(refusal(R"({"asset":{"version":"2.0"}})"), "no triangle"));
    CHECK(names(refusal("[1, 2]"), "no object"));
    CHECK(names(refusal("solid foo"), "truncated or damaged"));
    CHECK(names(refusal(""), "empty"));
}

TEST_CASE("a GLB is its JSON and its chunk; no truncation or altered byte of it crashes") {
    GltfText g = square();
    const std::vector<std::byte> glb = g.glb();
    Model m;
    REQUIRE(importModelFromMemory(glb, ".glb", m).ok());
    CHECK(m.positions == read(g.json()).positions);
    for (size_t length = 0; length < glb.size(); ++length) {
        CHECK(!importModelFromMemory(std::span(glb).first(length), ".glb", m).ok());
    }
    for (size_t at = 0; at < glb.size(); ++at) {
        for (const int flip : {1, 0x80, 0xff}) {
            std::vector<std::byte> altered = glb;
            altered[at] ^= std::byte(flip);
            Model altModel;
            const Status s = importModelFromMemory(altered, ".glb", altModel);
            CHECK((s.ok() ? altModel.triangles.size() > 0 : !s.message.empty()));
        }
    }
}

TEST_CASE("the glTF sample files are read whole") {
    const auto dir = xgc::test::dataDir(XGC_SOURCE_DIR);
    if (dir.empty()) {
        std::puts("SKIPPED: glTF sample files (no XGC_DATA)");
        return;
    }
    Model fox, morph, helmet;
    REQUIRE(importModel(dir / "gltf/Fox.glb", fox).ok());
    CHECK(fox.triangles.size() == 576);
    CHECK(fox.skins.at(0).joints.size() == 24);
    CHECK(fox.attributes.joints[0].size() == fox.positions.size());
    CHECK(!fox.attributes.uvs[0].empty());
    REQUIRE(importModel(dir / "gltf/MorphStressTest.gltf", morph).ok());
    CHECK(morph.attributes.morphTargets.size() == 8);
    CHECK(morph.attributes.morphTargets[0].name == "Key 1");
    REQUIRE(importModel(dir / "gltf/FlightHelmet/FlightHelmet.gltf", helmet).ok()); // its images are missing
    CHECK(helmet.nodes.size() == 6);
    CHECK(helmet.materials.size() == 6);
    CHECK(helmet.triangles.size() == 94722);
}
