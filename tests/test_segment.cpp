#include "meshes/builders.h"

#include <xgc/bake/segment.h>

#include <doctest/doctest.h>

using namespace xgc;
using namespace xgc::bake;

namespace {

/// Two squares of different size, far apart, of two triangles each; a mesh without welding.
Mesh twoSquares() {
    Mesh mesh;
    for (const float size : {1.0f, 2.0f}) {
        const float x = size * 10;
        const auto base = uint32_t(mesh.positions.size());
        for (const glm::vec2 q : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
            mesh.wedgePosition.push_back(uint32_t(mesh.positions.size()));
            mesh.positions.emplace_back(x + size * q.x, size * q.y, 0);
        }
        mesh.faces.emplace_back(base, base + 1, base + 2);
        mesh.faces.emplace_back(base, base + 2, base + 3);
    }
    mesh.faceInput = {0, 1, 2, 3};
    mesh.faceMaterial = {0, 0, 1, 1};
    mesh.faceNode.assign(4, bake::kNone);
    mesh.inputFaceCount = 4;
    mesh.materials.resize(2);
    return mesh;
}

Status parse(std::string_view text, std::vector<uint32_t>& labels) {
    return parseSeg(text, "x.seg", 3, labels);
}

} // namespace

TEST_CASE("none is one part") {
    const Segmentation parts = segmentNone(twoSquares());
    CHECK(parts.facePart == std::vector<uint32_t>{0, 0, 0, 0});
    CHECK(parts.partNames == std::vector<std::string>{"all"});
}

TEST_CASE("parts are ordered by area, largest first, and ties by the lowest face") {
    Mesh mesh = twoSquares();
    CHECK(segmentByLabels(mesh, std::vector<uint32_t>{7, 7, 3, 3}).facePart == std::vector<uint32_t>{1, 1, 0, 0});
    CHECK(segmentByLabels(mesh, std::vector<uint32_t>{7, 3, 9, 9}).facePart == std::vector<uint32_t>{1, 2, 0, 0});
    CHECK(segmentByLabels(mesh, std::vector<uint32_t>{7, 3, 9, 9}).partNames ==
          std::vector<std::string>{"label-9", "label-7", "label-3"});
}

TEST_CASE("parts by material carry the materials' names, made unique") {
    Mesh mesh = twoSquares();
    mesh.materials[0].name = mesh.materials[1].name = "steel";
    CHECK(segmentByMaterial(mesh).partNames == std::vector<std::string>{"steel", "steel-2"});
    mesh.materials[0].name = "steel-2";
    mesh.materials[1].name.clear();
    CHECK(segmentByMaterial(mesh).partNames == std::vector<std::string>{"material-1", "steel-2"});
    CHECK(segmentByMaterial(mesh).facePart == std::vector<uint32_t>{1, 1, 0, 0});
}

TEST_CASE("labels of the input survive the way through a mesh that lost faces") {
    Mesh mesh = twoSquares();
    mesh.faceInput = {2, 3, 3, 8}; // 0, 1, 4..7, 9 and 10 were dropped; 3 was a polygon
    mesh.inputFaceCount = 11;
    const std::vector<uint32_t> given = {9, 9, 5, 6, 9, 9, 9, 9, 7, 9, 9};
    const Segmentation parts = segmentByLabels(mesh, given);
    CHECK(parts.partNames == std::vector<std::string>{"label-6", "label-7", "label-5"});
    CHECK(inputLabels(mesh, parts) == std::vector<uint32_t>{2, 2, 2, 0, 0, 0, 1, 1, 1, 1, 1});
}

TEST_CASE(".seg: one id a line, with CRLF, blanks and empty lines at the end accepted") {
    const std::vector<uint32_t> wanted = {4, 0, 4294967294u};
    for (const std::string_view text : {"4\n0\n4294967294\n", "4\n0\n4294967294", "4\r\n0\r\n4294967294\r\n",
                                        " 4 \n\t0\n4294967294\n\n  \n", "4\n0\n4294967294\r"}) {
        std::vector<uint32_t> labels;
        const Status status = parse(text, labels);
        CHECK_MESSAGE(status.ok(), status.message);
        CHECK(labels == wanted);
    }
    std::vector<uint32_t> none{1};
    CHECK(parseSeg("", "x.seg", 0, none).ok());
    CHECK(none.empty());
}

TEST_CASE(".seg: what is wrong is refused with its line, and nothing is changed") {
    struct Case {
        std::string_view text;
        const char* message;
    };
    for (const Case& c :
         {Case{"1\n2\n", "x.seg: 2 lines for a model of 3 faces"}, Case{"", "x.seg: 0 lines"},
          Case{"1\n2\n3\n4\n", "more lines than the model has faces (3)"}, Case{"1\n-2\n3\n", "line 2: '-2' is not"},
          Case{"1\n2\nthree\n", "line 3: 'three' is not"}, Case{"1\n\n3\n", "line 2: '' is not"},
          Case{"1\n2 2\n3\n", "line 2: '2 2' is not"}, Case{"1.5\n2\n3\n", "line 1: '1.5' is not"},
          Case{"+1\n2\n3\n", "line 1: '+1' is not"}, Case{"1\n2\n4294967295\n", "line 3: '4294967295' is too large"},
          Case{"99999999999999999999\n2\n3\n", "line 1: '99999999999999999999' is too large"},
          Case{"1\n\x01\x80\n3\n", "line 2: '\?\?' is not"}, Case{"1\r2\r3\r", "line 1: '1?2?3' is not"}}) {
        std::vector<uint32_t> labels{42};
        const Status status = parse(c.text, labels);
        CHECK(status.outcome == Outcome::badInput);
        CHECK_MESSAGE(status.message.find(c.message) != std::string::npos, status.message);
        CHECK(labels == std::vector<uint32_t>{42});
    }
}
