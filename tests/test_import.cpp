#include "meshes/builders.h"

#include <xgc/bake/import.h>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>

using namespace xgc::bake;

/// Assimp 5.2.5 itself leaks the mesh at hand when it refuses a file.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libassimp.so";
}

namespace {

std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text));
}

Model read(const std::string& text, const std::string& extension) {
    Model model;
    const Status s = importModelFromMemory(bytesOf(text), extension, model);
    INFO(s.message);
    REQUIRE(s.ok());
    return model;
}

std::string refusal(const std::string& text, const std::string& extension) {
    Model model;
    model.file = "untouched";
    const Status s = importModelFromMemory(bytesOf(text), extension, model);
    CHECK(s.outcome == Outcome::badInput);
    CHECK(model.file == "untouched");
    return s.message;
}

bool names(const std::string& message, const std::string& part) {
    INFO(message);
    CHECK(message.find(part) != std::string::npos);
    return message.find(part) != std::string::npos;
}

/// Corners of a triangle as coordinates, for readers number rows as they like.
std::array<glm::vec3, 3> corners(const Model& m, size_t t) {
    const glm::uvec3 c = m.triangles[t];
    return {m.positions[c.x], m.positions[c.y], m.positions[c.z]};
}

double area(const Model& m, size_t t, const glm::vec3& facing) {
    const auto [a, b, c] = corners(m, t);
    return double(glm::dot(glm::cross(b - a, c - a), facing)) / 2;
}

/// A file in a folder of its own that goes with it.
class TemporaryFolder {
public:
    TemporaryFolder() : path(std::filesystem::temp_directory_path() / fmt::format("xgc-import-{}", getpid())) {
        std::filesystem::create_directories(path);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path); }
    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(path / name, std::ios::binary) << text;
        return path / name;
    }
    std::filesystem::path path;
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

template <class T>
void append(std::string& to, const T& value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binaryStl(uint32_t promised, const std::vector<float>& corners) {
    std::string out(80, 'x');
    append(out, promised);
    for (size_t i = 0; i < corners.size(); i += 9) {
        for (int k = 0; k < 3; ++k) append(out, 0.0f);
        for (size_t k = 0; k < 9; ++k) append(out, corners[i + k]);
        append(out, uint16_t(0));
    }
    return out;
}

std::string binaryPly() {
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) append(out, v);
    out += '\3';
    for (const int v : {0, 1, 2}) append(out, v);
    out += '\4';
    for (const int v : {0, 1, 2, 3}) append(out, v);
    return out;
}

const std::string kOff =
    "OFF\n# a comment\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 2\n3 0 1 2\n4 0 1 2 3\n2 0 1\n3 4 1 2\n";
const std::string kAsciiPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0 0 255 0\n0 1 0 0 0 51\n"
    "2 2 2 0 0 0\n3 0 1 2\n4 0 1 2 3\n2 0 1\n3 4 1 2\n";
const std::string kAsciiStl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
    "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
    "endloop\nendfacet\nendsolid a\n";

} // namespace

TEST_CASE("an OBJ keeps the file's face order over objects, groups and materials") {
    const Model m =
        read(kSquare + "f 1 2 3\no one\nusemtl A\nf 2 3 4\ng two\nusemtl B\nf 3 4 1\no one\nusemtl A\nf 4 1 2\n"
                       "l 1 2\np 1\nf -4 -3 -2\n",
             ".obj");
    CHECK(m.inputFaceCount == 5);
    REQUIRE(m.triangles.size() == 5);
    CHECK(m.triangleFace == std::vector<uint32_t>{0, 1, 2, 3, 4});
    CHECK(corners(m, 1)[0] == glm::vec3(1, 0, 0));
    CHECK(corners(m, 2)[0] == glm::vec3(1, 1, 0));
    CHECK(corners(m, 3)[0] == glm::vec3(0, 1, 0));
    CHECK(corners(m, 4)[0] == glm::vec3(0, 0, 0));
    REQUIRE(m.materials.size() == 3);
    CHECK(m.materials[0].name == "A");
    CHECK(m.materials[1].name == "B");
    CHECK(m.materials[2].name == "default");
    CHECK(m.triangleMaterial == std::vector<uint32_t>{2, 0, 1, 0, 0});
    REQUIRE(m.nodes.size() == 2);
    CHECK(m.triangleNode == std::vector<uint32_t>{kNone, 0, 1, 0, 0});
}

TEST_CASE("OBJ statements may be indented, continued and end in CR LF") {
    const Model m =
        read("v 0 0 0\r\n  v 1 0 0\r\n\tv 1 1 0\r\nv 0 1 0\r\n\r\n  f 1 2 \\\r\n 3\r\n# f 1 2 3\r\nf 1 3 4", ".obj");
    CHECK(m.inputFaceCount == 2);
    CHECK(m.triangles.size() == 2);
}

TEST_CASE("OBJ quads, degenerate faces and faces of two corners keep their number") {
    const Model m = read(kSquare + "f 1 2 3 4\nf 1 2\nf 1 1 2\nf 1 2 3\n", ".obj");
    CHECK(m.inputFaceCount == 4);
    CHECK(m.triangleFace == std::vector<uint32_t>{0, 0, 2, 3});
}

TEST_CASE("OBJ corners carry UVs and normals") {
    const Model m =
        read(kSquare + "vt 0 0\nvt 1 0\nvt 0.5 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/2/1 4/3/1\n", ".obj");
    CHECK(m.attributes.uvs[0][m.triangles[0].z] == glm::vec2(0.5f, 1));
    CHECK(m.attributes.uvs[0][m.triangles[1].y] == glm::vec2(1, 0));
    CHECK(m.attributes.normals[m.triangles[1].y] == glm::vec3(0, 0, 1));
}

TEST_CASE("the material library beside an OBJ is read; where it is missing the names stay") {
    const TemporaryFolder folder;
    folder.write("m.mtl", "newmtl unused\nKd 0 0 0\nnewmtl red\nKd 1 0 0\nd 0.5\n");
    const auto file = folder.write("a.OBJ", "mtllib m.mtl\n" + kSquare + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n");
    Model m;
    REQUIRE(importModel(file, m).ok());
    REQUIRE(m.materials.size() == 2);
    CHECK(m.materials[0].baseColor == glm::vec4(1, 0, 0, 0.5f));
    CHECK(m.materials[1].name == "blue");
    std::filesystem::remove(folder.path / "m.mtl");
    REQUIRE(importModel(file, m).ok());
    CHECK(m.materials[0].name == "red");
    CHECK(m.materials[0].baseColor == glm::vec4(1));
}

TEST_CASE("a concave polygon is covered once, whatever its orientation and first corner") {
    // An L, an arrow whose notch sees no whole fan, and a comb.
    const std::vector<std::vector<glm::vec2>> shapes = {
        {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
        {{0, 0}, {4, 2}, {0, 4}, {1, 2}},
        {{0, 0},
         {7, 0},
         {7, 3},
         {6, 3},
         {6, 1},
         {5, 1},
         {5, 3},
         {4, 3},
         {4, 1},
         {3, 1},
         {3, 3},
         {2, 3},
         {2, 1},
         {1, 1},
         {1, 3},
         {0, 3}},
    };
    const std::vector<double> areas = {3, 6, 15};
    for (size_t s = 0; s < shapes.size(); ++s) {
        const size_t n = shapes[s].size();
        for (size_t turn = 0; turn < n; ++turn) {
            for (const bool flipped : {false, true}) {
                std::string obj, face = "f";
                for (const glm::vec2& p : shapes[s]) obj += fmt::format("v 1 {} {}\n", p.x, p.y); // in x = 1
                for (size_t i = 0; i < n; ++i)
                    face += fmt::format(" {}", 1 + (flipped ? 2 * n - turn - i : turn + i) % n);
                const Model m = read(obj + face + "\n", ".obj");
                CHECK(m.inputFaceCount == 1);
                REQUIRE(m.triangles.size() == n - 2);
                double sum = 0;
                for (size_t t = 0; t < m.triangles.size(); ++t) {
                    const double a = area(m, t, {flipped ? -1 : 1, 0, 0});
                    CHECK(a > 0);
                    sum += a;
                    CHECK(m.triangleFace[t] == 0);
                }
                CHECK(sum == doctest::Approx(areas[s]));
            }
        }
    }
}

TEST_CASE("polygons without area or that cross themselves still give their triangles, soon") {
    CHECK(read("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", ".obj").triangles.size() == 2);
    CHECK(read("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", ".obj").triangles.size() == 2);
    std::string obj, face = "f";
    for (int i = 0; i < 20000; ++i) { // a star that crosses itself everywhere
        obj += fmt::format("v {} {} 0\n", i * 7919 % 1009, i * 104729 % 2003);
        face += fmt::format(" {}", i + 1);
    }
    CHECK(read(obj + face + "\n", ".obj").triangles.size() == 19998);
}

TEST_CASE("OFF and PLY keep face order, polygons and faces of two corners") {
    for (const auto& [text, extension] : {std::pair(kOff, ".off"), std::pair(kAsciiPly, ".ply")}) {
        const Model m = read(text, extension);
        CHECK(m.inputFaceCount == 4);
        CHECK(m.positions.size() == 5);
        CHECK(m.triangleFace == std::vector<uint32_t>{0, 1, 1, 3});
        CHECK(m.triangles[0] == glm::uvec3(0, 1, 2));
        CHECK(m.triangles[3] == glm::uvec3(4, 1, 2));
    }
    const Model colored = read(kAsciiPly, ".ply");
    CHECK(colored.attributes.colors[0][2] == glm::vec4(0, 1, 0, 1));
    const Model binary = read(binaryPly(), ".ply");
    CHECK(binary.triangleFace == std::vector<uint32_t>{0, 1, 1});
    CHECK(binary.positions[2] == glm::vec3(1, 1, 0));
}

TEST_CASE("STL gives its facets in order, without facet normals") {
    for (const std::string& text : {kAsciiStl, binaryStl(2, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0})}) {
        const Model m = read(text, ".stl");
        CHECK(m.inputFaceCount == 2);
        CHECK(m.attributes.normals.empty());
        CHECK(corners(m, 1)[2] == glm::vec3(0, 1, 0));
        Mesh mesh;
        WeldReport report;
        REQUIRE(weld(m, {}, mesh, report).ok());
        CHECK(mesh.wedgePosition.size() == 4);
    }
}

TEST_CASE("no truncation of a small file crashes, and none of a counted format passes for whole") {
    const std::string obj = kSquare + "vt 0 0\nvn 0 0 1\nusemtl A\nf 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1\n";
    const std::string stl = binaryStl(2, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
    for (const auto& [text, extension, counted] :
         {std::tuple(obj, ".obj", false), std::tuple(kOff, ".off", true), std::tuple(kAsciiPly, ".ply", true),
          std::tuple(binaryPly(), ".ply", true), std::tuple(kAsciiStl, ".stl", false), std::tuple(stl, ".stl", true)}) {
        const uint32_t whole = read(text, extension).inputFaceCount;
        for (size_t length = 0; length < text.size(); ++length) {
            Model m;
            const Status s = importModelFromMemory(bytesOf(text).first(length), extension, m);
            const std::string where =
                fmt::format("{} {} of {} bytes, {} faces", extension, length, text.size(), m.inputFaceCount);
            INFO(where);
            CHECK((s.ok() || !s.message.empty()));
            if (s.ok() && counted) CHECK(m.inputFaceCount == whole); // only the last blanks or digits are missing
        }
    }
}

TEST_CASE("headers that promise more than the file holds are refused at once") {
    CHECK(names(refusal("OFF\n4000000000 1 0\n0 0 0\n", ".off"), "promises 4000000000 vertices"));
    CHECK(names(refusal("OFF\n3 99999999999999999999999 0\n", ".off"), "faces"));
    std::string ply = kAsciiPly;
    ply.replace(ply.find("vertex 5"), 8, "vertex 2147483647");
    CHECK(names(refusal(ply, ".ply"), "promises 2147483647 vertex"));
    CHECK(!refusal(binaryStl(4000000000u, {0, 0, 0, 1, 0, 0, 1, 1, 0}), ".stl").empty());
}

TEST_CASE("files that cannot be are refused by what is wrong with them") {
    const TemporaryFolder folder;
    Model m;
    const auto message = [&](const std::filesystem::path& file) {
        const Status s = importModel(file, m);
        CHECK(s.outcome == Outcome::badInput);
        CHECK(names(s.message, file.string()));
        return s.message;
    };
    CHECK(names(message(folder.path / "none.obj"), "no such file"));
    CHECK(names(message(folder.path), "directory"));
    CHECK(names(message(folder.write("empty.ply", "")), "empty"));
    CHECK(names(message("/dev/null"), "not a regular file"));
    CHECK(names(message(folder.write("a.unheard", "v 0 0 0\n")), "no reader for the extension"));
    CHECK(names(message(folder.write("a", "v 0 0 0\n")), "no reader for the extension"));
    CHECK(names(message(folder.write("a.glb", kOff)), "magic"));
    CHECK(!message(folder.write("b.obj", kOff)).empty());
    CHECK(!message(folder.write("b.off", kAsciiPly)).empty());
    CHECK(!message(folder.write("b.ply", kAsciiStl)).empty());
    CHECK(names(message(folder.write("points.obj", kSquare)), "no triangle"));
    if (geteuid() != 0) {
        const auto closed = folder.write("closed.obj", kSquare);
        std::filesystem::permissions(closed, std::filesystem::perms::none);
        CHECK(names(message(closed), "permissions"));
    }
    CHECK(importModel(folder.write("a.xgc", "XGC"), m).outcome == Outcome::usage);
}

TEST_CASE("OBJ indices out of range are refused") {
    CHECK(!refusal(kSquare + "f 1 2 5\n", ".obj").empty());
    CHECK(!refusal(kSquare + "f 1 2 -9\n", ".obj").empty());
    CHECK(!refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 7\n", ".off").empty());
    // Assimp would take a later line for the face, unchecked.
    CHECK(names(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n0\n3 0 1 900000\n", ".off"), "face 0 has no corners"));
    CHECK(names(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n10 0 1 2 0 1 2 0 1 2 0\n", ".off"), "triangulate"));
    std::string ply = kAsciiPly;
    ply.replace(ply.find("3 4 1 2"), 7, "3 9 1 2");
    CHECK(!refusal(ply, ".ply").empty());
}

TEST_CASE("NaN in a file reaches welding, which names it") {
    for (const char* bad : {"nan", "inf", "1e99"}) {
        Model m;
        Mesh mesh;
        WeldReport report;
        const Status s =
            importModelFromMemory(bytesOf(fmt::format("v 0 {} 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", bad)), ".obj", m);
        INFO(bad, " ", s.message);
        CHECK((!s.ok() || names(weld(m, {}, mesh, report).message, "used by face 0")));
    }
}

TEST_CASE("every real mesh is read with the file's face count, in its order") {
    const auto dir = xgc::test::dataDir(XGC_SOURCE_DIR);
    if (dir.empty()) {
        std::puts("SKIPPED: real meshes (no XGC_DATA)");
        return;
    }
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(dir / "mesh")) {
        std::ifstream in(entry.path());
        uint32_t expected = 0;
        std::string line;
        if (entry.path().extension() == ".off") {
            uint32_t vertices = 0;
            in >> line >> vertices >> expected;
        } else {
            while (std::getline(in, line)) expected += line.starts_with("f ");
        }
        Model m;
        REQUIRE(importModel(entry.path(), m).ok());
        CHECK(m.inputFaceCount == expected);
        ++files;
    }
    CHECK(files == 10);
    for (const int number : {1, 101, 281, 399}) { // faces as the file lists them
        const auto path = dir / fmt::format("psb/off/{}.off", number);
        if (!std::filesystem::exists(path)) continue;
        Model m;
        REQUIRE(importModel(path, m).ok());
        std::ifstream in(path);
        std::string magic;
        uint32_t vertices = 0, faces = 0, edges = 0, corners = 0;
        in >> magic >> vertices >> faces >> edges;
        REQUIRE(m.inputFaceCount == faces);
        float skip = 0;
        for (uint32_t i = 0; i < vertices * 3; ++i) in >> skip;
        uint32_t different = 0;
        for (uint32_t f = 0; f < faces; ++f) {
            glm::uvec3 c;
            in >> corners >> c.x >> c.y >> c.z;
            different += m.triangles[f] != c || m.triangleFace[f] != f;
        }
        CHECK(different == 0);
    }
}
