#include "meshes/off.h"
#include "meshes/welded.h"

#include <xgc/bake/segment.h>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

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

using test::Welded;
using test::weldedWithTopology;

Segmentation thesisParts(const Welded& w, const ThesisSegmentOptions& options = {},
                         ThesisSegmentTrace* trace = nullptr) {
    return segmentThesis(w.mesh, w.topology, options, trace);
}

/// Surface of a set of unit cells, outward, two triangles a square.
Model cells(const std::set<std::array<int, 3>>& filled) {
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (const std::array<int, 3>& cell : filled) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                std::array<int, 3> next = cell;
                next[axis] += side ? 1 : -1;
                if (filled.contains(next)) continue;
                const auto base = uint32_t(p.size());
                for (int k = 0; k < 4; ++k) {
                    glm::vec3 q(cell[0], cell[1], cell[2]);
                    q[axis] += float(side);
                    q[(axis + 1) % 3] += float(k & 1);
                    q[(axis + 2) % 3] += float(k >> 1);
                    p.push_back(q);
                }
                const glm::uvec3 u(base, base + 1, base + 3), v(base, base + 3, base + 2);
                t.push_back(side ? u : glm::uvec3(u.x, u.z, u.y));
                t.push_back(side ? v : glm::uvec3(v.x, v.z, v.y));
            }
        }
    }
    return test::modelOf(std::move(p), std::move(t));
}

/// A cube of one cell on the middle of a plate of 3 x 3.
std::set<std::array<int, 3>> cubeOnPlate() {
    std::set<std::array<int, 3>> filled{{1, 1, 1}};
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) filled.insert({x, y, 0});
    }
    return filled;
}

/// Two balls joined by a rod: a profile turned about the x axis.
Model dumbbell() {
    constexpr uint32_t kAround = 24, kArc = 16, kRod = 8;
    constexpr float kArcEnd = 2.889f; // where the ball is as thin as the rod
    std::vector<glm::vec2> profile;
    for (uint32_t i = 0; i <= kArc; ++i) {
        const float angle = kArcEnd * float(i) / kArc;
        profile.emplace_back(-2 - std::cos(angle), std::sin(angle));
    }
    const float rodStart = profile.back().x, rodRadius = profile.back().y;
    for (uint32_t i = 1; i < kRod; ++i) profile.emplace_back(rodStart - 2 * rodStart * float(i) / kRod, rodRadius);
    for (uint32_t i = 0; i <= kArc; ++i) profile.emplace_back(-profile[kArc - i].x, profile[kArc - i].y);

    const auto rings = uint32_t(profile.size()) - 1;
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (const glm::vec2& q : profile) {
        for (uint32_t a = 0; a < kAround; ++a) {
            const float angle = 6.2831853f * float(a) / kAround;
            p.emplace_back(q.x, q.y * std::cos(angle), q.y * std::sin(angle));
        }
    }
    for (uint32_t r = 0; r < rings; ++r) {
        for (uint32_t a = 0; a < kAround; ++a) {
            const uint32_t i = r * kAround + a, j = r * kAround + (a + 1) % kAround;
            t.emplace_back(i, i + kAround, j);
            t.emplace_back(j, i + kAround, j + kAround);
        }
    }
    for (uint32_t a = 0; a < kAround; ++a) { // the poles: one point each
        p[a] = p[0];
        p[rings * kAround + a] = p[rings * kAround];
    }
    return test::modelOf(std::move(p), std::move(t));
}

/// A sphere whose vertices are moved in and out by `amount` of the radius.
Model roughSphere(float amount) {
    Model model = test::sphere(24);
    for (glm::vec3& p : model.positions) { // by the place, so that equal positions stay equal
        const glm::ivec3 q(p * 1000.0f);
        const uint32_t hash = (uint32_t(q.x) * 73856093u) ^ (uint32_t(q.y) * 19349663u) ^ (uint32_t(q.z) * 83492791u);
        p *= 1 + amount * (float(hash * 2654435761u >> 16) / 32768.0f - 1);
    }
    return model;
}

void checkDenseAndOrdered(const Mesh& mesh, const Segmentation& parts) {
    REQUIRE(parts.facePart.size() == mesh.faces.size());
    std::vector<double> area(parts.partCount(), 0.0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        REQUIRE(parts.facePart[f] < parts.partCount());
        const glm::uvec3 c = mesh.facePositions(f);
        const glm::dvec3 a(mesh.positions[c.x]), b(mesh.positions[c.y]), d(mesh.positions[c.z]);
        area[parts.facePart[f]] += glm::length(glm::cross(b - a, d - a)) / 2;
    }
    CHECK(std::is_sorted(area.begin(), area.end(), std::greater<>()));
    CHECK(std::set(parts.facePart.begin(), parts.facePart.end()).size() == parts.partCount());
    CHECK(std::set(parts.partNames.begin(), parts.partNames.end()).size() == parts.partCount());
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

TEST_CASE(".seg files: written, read back, and refused by name where they are none") {
    const std::filesystem::path dir = std::filesystem::path(XGC_BINARY_DIR) / "test_segment";
    std::filesystem::create_directories(dir);
    const std::vector<uint32_t> labels = {3, 0, 4294967294u};
    REQUIRE(writeSegFile(dir / "a.seg", labels).ok());
    std::vector<uint32_t> back;
    REQUIRE(readSegFile(dir / "a.seg", 3, back).ok());
    CHECK(back == labels);

    const auto refusal = [&](const std::filesystem::path& file, uint32_t faces) {
        const Status status = readSegFile(file, faces, back);
        CHECK(status.outcome == Outcome::badInput);
        CHECK(back == labels);
        CHECK(status.message.starts_with(file.string()));
        return status.message;
    };
    CHECK(refusal(dir / "none.seg", 3).find("no such file") != std::string::npos);
    CHECK(refusal(dir, 3).find("is a directory") != std::string::npos);
    CHECK(refusal(dir / "a.seg", 4).find("3 lines for a model of 4 faces") != std::string::npos);
    std::ofstream(dir / "huge.seg") << std::string(100000, '\n');
    CHECK(refusal(dir / "huge.seg", 3).find("far too long") != std::string::npos);
    CHECK_FALSE(writeSegFile(dir / "no/such/folder/a.seg", labels).ok());
}

TEST_CASE("a wholly convex body is one part") {
    CHECK(thesisParts(weldedWithTopology(test::cube(1))).partCount() == 1);
    CHECK(thesisParts(weldedWithTopology(test::cube(5))).partCount() == 1);
    CHECK(thesisParts(weldedWithTopology(test::sphere(12))).partCount() == 1);
    CHECK(thesisParts(weldedWithTopology(test::grid(6))).partCount() == 1);
}

TEST_CASE("a cube on a plate is two parts, cut along the concave edges") {
    const Welded w = weldedWithTopology(cells(cubeOnPlate()));
    const Segmentation parts = thesisParts(w);
    CHECK(parts.partNames == std::vector<std::string>{"part-0", "part-1"});
    checkDenseAndOrdered(w.mesh, parts);
    for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
        const glm::uvec3 c = w.mesh.facePositions(f);
        const float z = w.mesh.positions[c.x].z + w.mesh.positions[c.y].z + w.mesh.positions[c.z].z;
        CHECK(parts.facePart[f] == (z > 3 ? 1 : 0));
    }
}

TEST_CASE("an L stays one part: its flat sides lead round the concave edge, as at the thesis's T") {
    CHECK(thesisParts(weldedWithTopology(cells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}))).partCount() == 1);
}

TEST_CASE("a dumbbell is two balls and a rod, or as many parts as are asked for") {
    const Welded w = weldedWithTopology(dumbbell());
    ThesisSegmentTrace trace;
    const Segmentation parts = thesisParts(w, {}, &trace);
    CHECK(trace.equationCount == 3);
    CHECK_FALSE(trace.noisy);
    CHECK(parts.partCount() == 3);
    checkDenseAndOrdered(w.mesh, parts);
    for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) { // the rod is the smallest
        const glm::uvec3 c = w.mesh.facePositions(f);
        const float x = (w.mesh.positions[c.x].x + w.mesh.positions[c.y].x + w.mesh.positions[c.z].x) / 3;
        if (std::abs(x) < 0.8f) CHECK(parts.facePart[f] == 2);
        if (std::abs(x) > 1.2f) CHECK(parts.facePart[f] != 2);
    }
    for (const uint32_t wanted : {1u, 2u, 3u}) {
        ThesisSegmentOptions options;
        options.partsCount = wanted;
        CHECK(thesisParts(w, options).partCount() == wanted);
    }
}

TEST_CASE("triangles fall into the ten types of definition 1") {
    // A triangle with a neighbour across each side, its far corner lowered (convex), raised (concave) or level.
    const std::array<glm::vec3, 3> corner = {glm::vec3(0, 0, 0), glm::vec3(4, 0, 0), glm::vec3(2, 4, 0)};
    const std::array<glm::vec3, 3> outer = {glm::vec3(2, -4, 0), glm::vec3(6, 4, 0), glm::vec3(-2, 4, 0)};
    const std::array<uint32_t, 3> typeOfOne = {2, 3, 6}; // of a triangle with that one edge and two borders
    // Type by the number of convex and of concave edges.
    const uint32_t typeOf[4][4] = {{3, 6, 5, 4}, {2, 9, 8, 0}, {1, 7, 0, 0}, {0, 0, 0, 0}};
    std::set<uint32_t> seen;
    for (uint32_t combination = 0; combination < 27; ++combination) {
        const std::array<uint32_t, 3> kind = {combination % 3, combination / 3 % 3, combination / 9};
        std::vector<glm::vec3> p(corner.begin(), corner.end());
        std::vector<glm::uvec3> t{{0, 1, 2}};
        std::array<uint32_t, 10> wanted{};
        std::array<uint32_t, 3> count{};
        for (uint32_t k = 0; k < 3; ++k) {
            p.push_back(outer[k] + glm::vec3(0, 0, float(kind[k]) - 1));
            t.emplace_back((k + 1) % 3, k, k + 3);
            ++wanted[typeOfOne[kind[k]]];
            ++count[kind[k]];
        }
        const uint32_t type = typeOf[count[0]][count[2]];
        seen.insert(type);
        ++wanted[type];
        ThesisSegmentTrace trace;
        thesisParts(weldedWithTopology(test::modelOf(p, t)), {}, &trace);
        CHECK(trace.triangleTypes == wanted);
    }
    CHECK(seen.size() == 10);
}

TEST_CASE("the flat tolerance decides what counts as flat") {
    const auto kindAt = [](float height, float tolerance) {
        const Welded w = weldedWithTopology(
            test::modelOf({{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0.5f, -1, height}}, {{0, 1, 2}, {1, 0, 3}}));
        ThesisSegmentOptions options;
        options.flatTolerance = tolerance;
        ThesisSegmentTrace trace;
        thesisParts(w, options, &trace);
        return trace.edgeKinds[0];
    };
    CHECK(kindAt(0, 0) == EdgeKind::flat);
    CHECK(kindAt(0.01f, 6e-3f) == EdgeKind::flat); // 0.01 of a length of 2
    CHECK(kindAt(0.01f, 4e-3f) == EdgeKind::concave);
    CHECK(kindAt(-0.01f, 4e-3f) == EdgeKind::convex);
    CHECK(kindAt(-0.02f, 6e-3f) == EdgeKind::convex);
}

TEST_CASE("a rough sphere is noisy, is smoothed, and is merged by its own areas") {
    const Welded w = weldedWithTopology(roughSphere(0.01f));
    ThesisSegmentTrace trace;
    ThesisSegmentOptions options;
    const Segmentation parts = thesisParts(w, options, &trace);
    CHECK(trace.noisy);
    CHECK_FALSE(trace.noisyAfterSmoothing);
    CHECK(trace.smoothingRounds > 0);
    CHECK(trace.firstHistogram[0] > trace.histogram[0]);
    checkDenseAndOrdered(w.mesh, parts);

    // n counts the filled regions of 1 percent or more of the mesh as it was given.
    std::vector<double> area(trace.filledCount, 0.0);
    double total = 0;
    for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
        const glm::uvec3 c = w.mesh.facePositions(f);
        const glm::dvec3 a(w.mesh.positions[c.x]), b(w.mesh.positions[c.y]), d(w.mesh.positions[c.z]);
        area[trace.filledRegions[f]] += glm::length(glm::cross(b - a, d - a)) / 2;
        total += glm::length(glm::cross(b - a, d - a)) / 2;
    }
    const auto large = std::count_if(area.begin(), area.end(), [&](double a) { return a >= 0.01 * total; });
    CHECK(trace.equationCount == large);

    options.smoothingRounds = 0;
    ThesisSegmentTrace unsmoothed;
    thesisParts(w, options, &unsmoothed);
    CHECK(unsmoothed.noisyAfterSmoothing);
    CHECK(unsmoothed.filledCount > trace.filledCount);
    options.noiseRatio = 1e9f; // nothing is noisy
    thesisParts(w, options, &unsmoothed);
    CHECK(unsmoothed.noisy == (unsmoothed.firstHistogram[0] > 99.99));
}

TEST_CASE("the histogram sums to 100 percent") {
    for (const Model& model : {dumbbell(), roughSphere(0.02f), cells(cubeOnPlate()), test::cube(1)}) {
        ThesisSegmentTrace trace;
        thesisParts(weldedWithTopology(model), {}, &trace);
        double first = 0, last = 0;
        for (int i = 0; i < 100; ++i) {
            first += trace.firstHistogram[i];
            last += trace.histogram[i];
        }
        CHECK(first == doctest::Approx(100).epsilon(1e-9));
        CHECK(last == doctest::Approx(100).epsilon(1e-9));
    }
}

TEST_CASE("winding does not matter: inside out, or face by face") {
    for (const Model& model : {dumbbell(), cells(cubeOnPlate())}) {
        const std::vector<uint32_t> wanted = thesisParts(weldedWithTopology(model)).facePart;
        Model insideOut = model, mixed = model;
        for (glm::uvec3& t : insideOut.triangles) std::swap(t.y, t.z);
        for (size_t i = 0; i < mixed.triangles.size(); i += 1 + i % 3)
            std::swap(mixed.triangles[i].y, mixed.triangles[i].z);
        CHECK(thesisParts(weldedWithTopology(insideOut)).facePart == wanted);
        CHECK(thesisParts(weldedWithTopology(mixed)).facePart == wanted);
    }
}

TEST_CASE("a mesh scaled by a power of two has the same parts") {
    const std::vector<uint32_t> wanted = thesisParts(weldedWithTopology(roughSphere(0.01f))).facePart;
    for (const float scale : {1.0f / (1 << 20), 0.5f, 4096.0f}) {
        Model model = roughSphere(0.01f);
        for (glm::vec3& p : model.positions) p *= scale;
        CHECK(thesisParts(weldedWithTopology(model)).facePart == wanted);
    }
    CHECK(thesisParts(weldedWithTopology(roughSphere(0.01f))).facePart == wanted);
}

TEST_CASE("edges of more than two faces are closed, and regions still meet there") {
    const Welded w = weldedWithTopology(cells({{0, 0, 0}, {1, 1, 0}})); // two cubes with one edge in common
    CHECK(thesisParts(w).partCount() == 2);
    ThesisSegmentOptions options;
    options.partsCount = 1;
    CHECK(thesisParts(w, options).partCount() == 1);
}

TEST_CASE("the report holds what the trace saw") {
    const Welded w = weldedWithTopology(roughSphere(0.01f));
    ThesisSegmentTrace trace;
    const Segmentation parts = thesisParts(w, {}, &trace);
    const std::string json = thesisReportJson("rough \"sphere\".off", w.mesh, {}, trace, parts);
    CHECK(json.find("\"input\": \"rough \\\"sphere\\\".off\"") != std::string::npos);
    CHECK(json.find("\"noisy\": true") != std::string::npos);
    CHECK(json.find(fmt::format("\"filledRegions\": {},", trace.filledCount)) != std::string::npos);
    CHECK(json.find(fmt::format("\"equationCount\": {},", trace.equationCount)) != std::string::npos);
    for (const char* key : {"triangleTypes", "firstHistogram", "histogram", "smoothingRounds", "areaPercent"}) {
        CHECK(json.find(fmt::format("\"{}\": ", key)) != std::string::npos);
    }
}

TEST_CASE("islands have no one to merge with and stay") {
    const Welded w = weldedWithTopology(cells({{0, 0, 0}, {3, 0, 0}, {6, 0, 0}}));
    ThesisSegmentOptions options;
    options.partsCount = 1;
    CHECK(thesisParts(w, options).partCount() == 3);
    CHECK(segmentByComponent(w.mesh, w.topology).partNames ==
          std::vector<std::string>{"component-0", "component-1", "component-2"});
}

TEST_CASE("a face of no area neither opens a concave edge nor makes a part") {
    Model model = cells(cubeOnPlate());
    // One of the plate's faces at the cube's foot is split at the middle of that edge; a needle fills the crack.
    const Welded before = weldedWithTopology(model);
    uint32_t split = 0;
    glm::uvec3 turned(0);
    for (uint32_t f = 0; f < model.triangles.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const glm::uvec3 t = model.triangles[f];
            const glm::vec3 a = model.positions[t[k]], b = model.positions[t[(k + 1) % 3]],
                            c = model.positions[t[(k + 2) % 3]];
            const bool onPlate = a.z == 1 && b.z == 1 && c.z == 1;
            const bool atFoot = a.y == 1 && b.y == 1 && std::min(a.x, b.x) == 1 && std::max(a.x, b.x) == 2 && c.y < 1;
            if (!onPlate || !atFoot) continue;
            split = f;
            turned = glm::uvec3(t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        }
    }
    REQUIRE(turned != glm::uvec3(0));
    const auto middle = uint32_t(model.positions.size());
    model.positions.push_back((model.positions[turned.x] + model.positions[turned.y]) * 0.5f);
    model.triangles[split] = {turned.x, middle, turned.z};
    model.triangles.emplace_back(middle, turned.y, turned.z);
    model.triangles.emplace_back(turned.x, turned.y, middle);
    model = test::modelOf(model.positions, model.triangles);
    const Welded w = weldedWithTopology(model);
    CHECK(w.mesh.faceCount() == before.mesh.faceCount() + 2);
    ThesisSegmentOptions options;
    options.merge = false;
    CHECK(thesisParts(before, options).partCount() == 2);
    CHECK(thesisParts(w, options).partCount() == 2);
    checkDenseAndOrdered(w.mesh, thesisParts(w));
}

TEST_CASE("a mesh without any area has parts all the same") {
    const Welded w =
        weldedWithTopology(test::modelOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 3, 2}}));
    CHECK(thesisParts(w).facePart == std::vector<uint32_t>{0, 0});
}

TEST_CASE("real models have as many parts as a person might see") {
    const std::filesystem::path data = test::dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        fmt::print("SKIPPED: segmentation of real models (no XGC_DATA)\n");
        return;
    }
    struct Case {
        uint32_t model, least, most;
        bool noisy;
    };
    for (const Case& c : {Case{161, 4, 12, false}, Case{81, 5, 20, false}, Case{281, 5, 40, true},
                          Case{21, 2, 6, false}, Case{121, 5, 20, false}}) {
        CAPTURE(c.model);
        const Model model = test::readOff(data / "psb/off" / fmt::format("{}.off", c.model));
        REQUIRE_FALSE(model.triangles.empty());
        const Welded w = weldedWithTopology(model);
        ThesisSegmentTrace trace;
        const Segmentation parts = thesisParts(w, {}, &trace);
        CHECK(parts.partCount() >= c.least);
        CHECK(parts.partCount() <= c.most);
        CHECK(trace.noisy == c.noisy);
        checkDenseAndOrdered(w.mesh, parts);
        std::vector<uint32_t> back;
        std::string text;
        for (const uint32_t label : inputLabels(w.mesh, parts)) text += std::to_string(label) + "\n";
        REQUIRE(parseSeg(text, "back.seg", w.mesh.inputFaceCount, back).ok());
        CHECK(segmentByLabels(w.mesh, back).facePart == parts.facePart);
    }
}
