#include "bake/layout.h"
#include "meshes/hostile.h"
#include "meshes/toy_asset.h"
#include "segment/part_order.h"

#include <xgc/bake/perceptual.h>
#include <xgc/parts.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

using namespace xgc;
using namespace xgc::bake;
using format::PartShape;

namespace {

Segmentation labelled(std::vector<uint32_t> facePart, uint32_t count) {
    Segmentation parts;
    parts.facePart = std::move(facePart);
    for (uint32_t p = 0; p < count; ++p) parts.partNames.push_back("part-" + std::to_string(p));
    return parts;
}

std::vector<PartShape> shapesOf(const Mesh& mesh, const Segmentation& parts) {
    return layout::shapesOfParts(mesh, parts, layout::measureParts(mesh, parts));
}

PartShape shapeOfAll(const Mesh& mesh) {
    return shapesOf(mesh, labelled(std::vector<uint32_t>(mesh.faces.size(), 0), 1)).at(0);
}

glm::dvec3 vectorOf(const float (&v)[3]) {
    return {double(v[0]), double(v[1]), double(v[2])};
}

/// The promise of FORMAT.md, without any tolerance.
bool contains(const PartShape& shape, const glm::vec3& point) {
    for (int k = 0; k < 3; ++k) {
        const double along = glm::dot(glm::dvec3(point) - vectorOf(shape.boxCenter), vectorOf(shape.boxAxes[k]));
        if (!(std::abs(along) <= double(shape.boxHalfSizes[k]))) return false;
    }
    return true;
}

bool containsAll(const PartShape& shape, const Mesh& mesh) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(),
                       [&](const glm::vec3& p) { return contains(shape, p); });
}

/// Right-handed, of unit vectors at right angles.
bool isFrame(const PartShape& shape) {
    const glm::dvec3 x = vectorOf(shape.boxAxes[0]), y = vectorOf(shape.boxAxes[1]), z = vectorOf(shape.boxAxes[2]);
    return std::abs(glm::length(x) - 1) < 1e-6 && std::abs(glm::length(y) - 1) < 1e-6 &&
           glm::length(glm::cross(x, y) - z) < 1e-6 && std::abs(glm::dot(x, y)) < 1e-6;
}

/// A cube of n quads a side stretched to a box of sides 6, 3, 1, turned, and moved.
Mesh turnedBox(uint32_t n) {
    Model model = test::cube(n);
    for (glm::vec3& p : model.positions) {
        p *= glm::vec3(3, 1, 6);
        p = {0.6f * p.x - 0.8f * p.y, 0.8f * p.x + 0.6f * p.y, p.z};
        p = {p.x, 0.28f * p.y - 0.96f * p.z, 0.96f * p.y + 0.28f * p.z};
        p += glm::vec3(10, -20, 5);
    }
    return test::welded(model);
}

/// Parts 0..5 of a file: 4 joins 1, 5 joins 0, 1 joins 0, 3 joins 2; two pieces are left.
test::ToyAsset sixParts() {
    return test::assetOf(test::sphere(6), 6, [](const Mesh& mesh, Segmentation& parts) {
        parts.merges = {{1, 4, 0.1f}, {0, 5, 0.3f}, {0, 1, 0.2f}, {2, 3, 1.5f}};
        return test::toyHierarchy(mesh, parts, {});
    });
}

} // namespace

TEST_CASE("a part's box lies along it, is as small as it can be, and contains it") {
    for (const uint32_t n : {1u, 5u}) {
        const Mesh mesh = turnedBox(n);
        const PartShape shape = shapeOfAll(mesh);
        CHECK(isFrame(shape));
        CHECK(containsAll(shape, mesh));
        CHECK(shape.boxHalfSizes[0] == doctest::Approx(3));
        CHECK(shape.boxHalfSizes[1] == doctest::Approx(1.5));
        CHECK(shape.boxHalfSizes[2] == doctest::Approx(0.5));
        CHECK(glm::length(vectorOf(shape.boxCenter) - glm::dvec3(10, -20, 5)) < 1e-5);
        CHECK(std::abs(glm::dot(vectorOf(shape.boxAxes[0]), glm::dvec3(0, -0.96, 0.28))) == doctest::Approx(1));
        CHECK(std::abs(glm::dot(vectorOf(shape.boxAxes[2]), glm::dvec3(-0.8, 0.168, 0.576))) == doctest::Approx(1));
    }
}

TEST_CASE("noise does not turn the box of a part whose axes are all alike") {
    const PartShape shape = shapeOfAll(test::welded(test::cube(7)));
    for (int k = 0; k < 3; ++k) {
        CHECK(shape.boxHalfSizes[k] == doctest::Approx(0.5));
        for (int i = 0; i < 3; ++i) CHECK(std::abs(std::abs(shape.boxAxes[k][i]) - 0.5f) == doctest::Approx(0.5));
    }
}

TEST_CASE("flat parts, parts along a line and parts without area have boxes too") {
    const Mesh flat = test::welded(test::grid(5));
    const PartShape flatShape = shapeOfAll(flat);
    CHECK(isFrame(flatShape));
    CHECK(containsAll(flatShape, flat));
    CHECK(flatShape.boxHalfSizes[2] == 0);

    const Mesh line = test::welded(test::modelOf({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {4, 4, 0}}, {{0, 1, 2}, {1, 2, 3}}));
    const PartShape lineShape = shapeOfAll(line);
    CHECK(isFrame(lineShape));
    CHECK(containsAll(lineShape, line));
    CHECK(lineShape.boxHalfSizes[0] == doctest::Approx(std::sqrt(8.0)));
    CHECK(lineShape.boxHalfSizes[1] < 1e-6f);
}

TEST_CASE("random parts lie in their boxes") {
    const Mesh mesh = test::welded(test::sphere(12));
    const Segmentation parts = test::slabs(mesh, 7);
    const std::vector<PartShape> shapes = shapesOf(mesh, parts);
    REQUIRE(shapes.size() == 7);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        const PartShape& shape = shapes[parts.facePart[f]];
        for (int k = 0; k < 3; ++k) CHECK(contains(shape, mesh.positions[p[k]]));
    }
    for (const PartShape& shape : shapes) CHECK(isFrame(shape));
}

TEST_CASE("contours are as long as the edges that two parts share, from both sides") {
    // Quadrants of a square; a cut through it leaves the upper right one above the lower right one.
    const Mesh mesh = test::welded(test::grid(4));
    std::vector<uint32_t> quadrant;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        const glm::vec3 c = (mesh.positions[p.x] + mesh.positions[p.y] + mesh.positions[p.z]) / 3.0f;
        quadrant.push_back(uint32_t(c.x > 0.5f) + 2 * uint32_t(c.y > 0.25f));
    }
    const std::vector<layout::PartFigures> square = layout::measureParts(mesh, labelled(quadrant, 4));
    CHECK(square[0].neighbours == std::vector<uint32_t>{1, 2});
    CHECK(square[0].contours == std::vector<float>{0.25f, 0.5f});
    CHECK(square[1].contours == std::vector<float>{0.25f, 0.5f});
    CHECK(square[3].neighbours == std::vector<uint32_t>{1, 2});
    CHECK(square[3].contours == std::vector<float>{0.5f, 0.75f});

    // Three faces at one edge of length 2: each part has it with each other once.
    const Mesh fan = test::welded(
        test::modelOf({{0, 0, 0}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
    for (const layout::PartFigures& part : layout::measureParts(fan, labelled({0, 1, 2}, 3)))
        CHECK(part.contours == std::vector<float>{2, 2});
}

TEST_CASE("a part's salience is the cost of the first merge that it is in") {
    const test::ToyAsset a = sixParts();
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    REQUIRE(a.asset.partShapes.size() == 6);
    std::vector<float> saliences;
    std::vector<uint32_t> joinedBy;
    for (const PartShape& shape : a.asset.partShapes) {
        saliences.push_back(shape.salience);
        joinedBy.push_back(shape.joinedBy);
    }
    CHECK(saliences == std::vector<float>{0.3f, 0.1f, 1, 1, 0.1f, 0.3f});
    CHECK(joinedBy == std::vector<uint32_t>{kNone, 2, kNone, 3, 0, 1});
    CHECK(a.asset.merges[3].cost == 1.5f);
    REQUIRE(a.asset.contours.size() == a.asset.partNeighbours.size());
    for (uint32_t p = 0; p < 6; ++p) {
        for (size_t n = 0; n < a.asset.neighboursOf(p).size(); ++n) {
            const uint32_t other = a.asset.neighboursOf(p)[n];
            const auto back = a.asset.neighboursOf(other);
            const size_t at = size_t(std::find(back.begin(), back.end(), p) - back.begin());
            REQUIRE(at < back.size());
            CHECK(a.asset.contoursOf(p)[n] == a.asset.contoursOf(other)[at]);
            CHECK(a.asset.contoursOf(p)[n] > 0);
        }
    }
}

TEST_CASE("parts join as the file says, down to the pieces that stay apart") {
    const test::ToyAsset a = sixParts();
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    const std::vector<std::vector<uint32_t>> expected = {{0, 0, 1, 1, 0, 0}, {0, 0, 1, 1, 0, 0}, {0, 0, 1, 2, 0, 0},
                                                         {0, 1, 2, 3, 1, 0}, {0, 1, 2, 3, 1, 4}, {0, 1, 2, 3, 4, 5},
                                                         {0, 1, 2, 3, 4, 5}};
    for (uint32_t wanted = 1; wanted <= expected.size(); ++wanted) {
        CAPTURE(wanted);
        std::vector<uint32_t> groups(6, 99);
        CHECK(mergedParts(a.asset, wanted, groups) == std::clamp(wanted, 2u, 6u));
        CHECK(groups == expected[wanted - 1]);
    }
}

TEST_CASE("a file without merges keeps its parts") {
    const test::ToyAsset a = test::assetOf(test::sphere(4), 3, [](const Mesh& mesh, Segmentation& parts) {
        parts.merges.clear();
        return test::toyHierarchy(mesh, parts, {});
    });
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    CHECK(a.asset.merges.empty());
    CHECK(a.asset.partShapes[1].salience == 1);
    std::vector<uint32_t> groups(3);
    CHECK(mergedParts(a.asset, 1, groups) == 3);
    CHECK(groups == std::vector<uint32_t>{0, 1, 2});
}

TEST_CASE("shapes and contours for other than all parts and neighbours are refused") {
    const test::ToyAsset a = sixParts();
    const auto header = test::load<format::FileHeader>(a.bytes, 0);
    for (const format::SectionId shortened : {format::SectionId::partShapes, format::SectionId::contours}) {
        layout::FileBuilder file;
        for (uint32_t i = 0; i < header.sectionCount; ++i) {
            auto s = test::load<format::SectionRecord>(a.bytes, sizeof header + i * sizeof(format::SectionRecord));
            if (s.id == format::SectionId::pages || s.id == format::SectionId::streams) continue; // the builder's
            if (s.id == shortened) s.count -= 1, s.rawBytes -= s.stride;
            file.codedSection(s, format::Codec::none, std::span(a.bytes).subspan(s.offset, s.rawBytes));
        }
        for (const format::StreamRecord& s : a.asset.streams) {
            const uint64_t at = a.asset.pages[0].offset + s.offset;
            file.codedStream(s, format::Codec::none, std::span(a.bytes).subspan(at, s.storedBytes));
        }
        std::vector<std::byte> bytes;
        file.finish(a.asset.levelCount(), bytes);
        const AlignedBytes copy = test::aligned(bytes);
        AssetView view;
        const xgc::Status s = openAll(copy.span(), view);
        CHECK(s.code == StatusCode::corrupt);
        CHECK_MESSAGE(std::string_view(s.message).find("has another count than") != std::string_view::npos, s.message);
    }
}

TEST_CASE("merges that no order of joining has are not laid out") {
    const std::vector<std::vector<PartMerge>> wrong = {{{1, 0, 0.5f}},
                                                       {{0, 3, 0.5f}},
                                                       {{1, 1, 0.5f}},
                                                       {{0, 2, 0.5f}, {1, 2, 0.5f}},
                                                       {{1, 2, 0.5f}, {0, 1, -1.0f}},
                                                       {{0, 1, 0.5f}, {1, 2, 0.5f}}};
    for (const std::vector<PartMerge>& merges : wrong) {
        const test::ToyAsset a = test::assetOf(test::sphere(4), 3, [&](const Mesh& mesh, Segmentation& parts) {
            parts.merges = merges;
            return test::toyHierarchy(mesh, parts, {});
        });
        CHECK_FALSE(a.error.empty());
    }
}

TEST_CASE("parts are named after the node or material that holds them alone, and names stay unique") {
    Mesh mesh = test::welded(test::sphere(8));
    const Segmentation plain = [&] {
        Segmentation parts = test::slabs(mesh, 4);
        return labelled(parts.facePart, 4);
    }();
    const auto names = [&] {
        Segmentation parts = plain;
        nameParts(mesh, parts);
        CHECK(parts.facePart == plain.facePart);
        return parts.partNames;
    };
    using Names = std::vector<std::string>;
    CHECK(names() == plain.partNames); // one material, no node

    mesh.materials.resize(3);
    mesh.materials[0].name = "skin";
    mesh.materials[1].name = "glass";
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) mesh.faceMaterial[f] = plain.facePart[f] == 1 ? 1 : 0;
    CHECK(names() == Names{"part-0", "glass", "part-2", "part-3"}); // three have skin

    for (uint32_t f = 0, n = 0; f < mesh.faceCount(); ++f) {
        if (plain.facePart[f] == 1 && n++ % 5 == 0) mesh.faceMaterial[f] = 0;
    }
    CHECK(names() == plain.partNames); // a fifth of it is another's

    mesh.nodes = {{"wheel", kNone, glm::mat4(1)}, {"wheel", 0, glm::mat4(1)}, {"part-3", 0, glm::mat4(1)}};
    mesh.nodes.push_back({"roof", 0, glm::mat4(1)});
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) mesh.faceNode[f] = plain.facePart[f];
    CHECK(names() == Names{"part-0", "part-1", "part-2", "roof"}); // wheel twice, part-3 taken
    mesh.nodes[1].name = "";
    CHECK(names() == Names{"wheel", "part-1", "part-2", "roof"});
}
