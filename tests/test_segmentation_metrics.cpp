#include "meshes/builders.h"

#include <xgc/bake/segmentation_metrics.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace xgc;
using namespace xgc::bake;

namespace {

struct Welded {
    Mesh mesh;
    Topology topology;
    MetricSurface surface;
};

Welded welded(const Model& model) {
    Welded w;
    WeldReport report;
    const Status status = weld(model, {}, w.mesh, report);
    REQUIRE_MESSAGE(status.ok(), status.message);
    w.topology = buildTopology(w.mesh);
    w.surface = prepareSurface(w.mesh, w.topology);
    return w;
}

/// A strip of squares between x[0], x[1], ... of height `height`, its top moved by `shear`. Square i is cut from its
/// lower left to its upper right corner: face 2i below, 2i + 1 above.
///
///     t0---t1---t2
///     |1 / |3 / |
///     | / 0| / 2|
///     b0---b1---b2
Model strip(std::span<const float> x, float height = 1, float shear = 0) {
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (const float at : x) {
        p.emplace_back(at, 0, 0);
        p.emplace_back(at + shear, height, 0);
    }
    for (uint32_t b = 0; b + 2 < p.size(); b += 2) {
        t.emplace_back(b, b + 2, b + 3);
        t.emplace_back(b, b + 3, b + 1);
    }
    return test::modelOf(std::move(p), std::move(t));
}

constexpr std::array<float, 5> kFourSquares = {0, 1, 2, 3, 4};

/// Both ways round: every metric is symmetric, to the bit where a sum has the same terms.
SegmentationErrors compare(const MetricSurface& surface, const std::vector<uint32_t>& a,
                           const std::vector<uint32_t>& b) {
    const MetricLabels labelsA = prepareLabels(surface, a), labelsB = prepareLabels(surface, b);
    const SegmentationErrors errors = compareLabels(surface, labelsA, labelsB);
    const SegmentationErrors back = compareLabels(surface, labelsB, labelsA);
    CHECK(errors.randIndex == back.randIndex);
    CHECK(errors.cutDiscrepancy == back.cutDiscrepancy);
    CHECK(errors.hamming == doctest::Approx(back.hamming));
    CHECK(errors.globalConsistency == doctest::Approx(back.globalConsistency));
    CHECK(errors.localConsistency == doctest::Approx(back.localConsistency));
    return errors;
}

const std::vector<uint32_t> kHalves = {0, 0, 0, 0, 1, 1, 1, 1};
const std::vector<uint32_t> kFirstSquare = {0, 0, 1, 1, 1, 1, 1, 1};
const std::vector<uint32_t> kAllSquares = {0, 0, 1, 1, 2, 2, 3, 3};

} // namespace

TEST_CASE("the average radius is the area-weighted mean distance from the centroid") {
    // Centroid (2, 1/2). Lower triangles have theirs at (i + 2/3, 1/3): off by (-4/3, -1/3, 2/3, 5/3) and 1/6; upper
    // ones mirror them. In sixths: sqrt(64 + 1), sqrt(4 + 1), sqrt(16 + 1), sqrt(100 + 1).
    const Welded w = welded(strip(kFourSquares));
    CHECK(w.surface.area == 4);
    CHECK(w.surface.averageRadius ==
          doctest::Approx((std::sqrt(65.0) + std::sqrt(5.0) + std::sqrt(17.0) + std::sqrt(101.0)) / 24).epsilon(1e-12));

    // Weighted by area: squares of 1 and 3 on one line. Centroid x = (1 * 1/2 + 3 * 5/2) / 4 = 2. Lower centroids at
    // x = 2/3 and 3, upper at 1/3 and 2; y is off by 1/6 everywhere.
    const auto off = [](double x) { return std::sqrt(x * x + 1.0 / 36); };
    const Welded uneven = welded(strip(std::array<float, 3>{0, 1, 4}));
    CHECK(uneven.surface.averageRadius ==
          doctest::Approx((0.5 * off(2 - 2.0 / 3) + 0.5 * off(2 - 1.0 / 3) + 1.5 * off(1) + 1.5 * off(0)) / 4)
              .epsilon(1e-12));
}

TEST_CASE("two cuts a square apart") {
    const Welded w = welded(strip(kFourSquares));
    const SegmentationErrors e = compare(w.surface, kHalves, kFirstSquare);
    // Pairs together: 6 + 6 and 1 + 15; in both: overlaps of 2, 2 and 4 faces, 1 + 1 + 6. Disagree 12 + 16 - 2 * 8 =
    // 12, over (8 - 1) / 2 * 8 = 24 with the integer division (28 without).
    CHECK(e.randIndex == 0.5);
    // Four cut vertices, each 1 from the other cut.
    REQUIRE(e.cutDiscrepancy.has_value());
    CHECK(*e.cutDiscrepancy == doctest::Approx(1 / w.surface.averageRadius).epsilon(1e-12));
    // The left half shares 1 with each side of the other cut: 1 of 4 is missed. Back: of the right 3, 1 of 4.
    CHECK(e.hamming == 0.25);
    // From the halves: 4 faces of the left half have half of it outside: 2. Back: 2 faces at 4/6 and 4 at 2/6: 8/3.
    CHECK(e.globalConsistency == doctest::Approx(2.0 / 8));
    // Faces 0 and 1: min(1/2, 0); 2 and 3: min(1/2, 4/6); the rest min(0, 2/6).
    CHECK(e.localConsistency == doctest::Approx(1.0 / 8));
}

TEST_CASE("a refinement has no consistency error, but all others") {
    const Welded w = welded(strip(kFourSquares));
    const SegmentationErrors e = compare(w.surface, kHalves, kAllSquares);
    // Together 12 and 4, in both 4: 12 + 4 - 8 = 8 of 24.
    CHECK(e.randIndex == doctest::Approx(8.0 / 24));
    // Of the six cut vertices at x = 1, 2, 3 four are 1 from the cut at 2; its own two are on the other cut: 4 / 8.
    CHECK(*e.cutDiscrepancy == doctest::Approx(0.5 / w.surface.averageRadius).epsilon(1e-12));
    // Each half misses a square: 2 of 4; back nothing.
    CHECK(e.hamming == 0.25);
    CHECK(e.globalConsistency == 0);
    CHECK(e.localConsistency == 0);
}

TEST_CASE("equal labelings have no error, whatever their ids") {
    const Welded w = welded(strip(std::array<float, 5>{0, 0.1f, 0.7f, 1.3f, 4.7f}, 0.3f, 0.2f));
    const SegmentationErrors e = compare(w.surface, {7, 7, 1, 0, 0, 4294967294u, 7, 1}, {0, 0, 3, 9, 9, 2, 0, 3});
    CHECK(e.randIndex == 0);
    CHECK(e.cutDiscrepancy == 0.0);
    CHECK(e.hamming == 0);
    CHECK(e.globalConsistency == 0);
    CHECK(e.localConsistency == 0);
}

TEST_CASE("one segment has no cut to be far from, and no consistency error") {
    const Welded w = welded(strip(kFourSquares));
    const SegmentationErrors e = compare(w.surface, std::vector<uint32_t>(8, 5), kFirstSquare);
    // Together 28 and 16, in both 16.
    CHECK(e.randIndex == 0.5);
    CHECK_FALSE(e.cutDiscrepancy.has_value());
    // One way 1 of 4 is missed, the other nothing.
    CHECK(e.hamming == 0.125);
    CHECK(e.globalConsistency == 0);
    CHECK(e.localConsistency == 0);
}

TEST_CASE("a labeling of two components has two segments, but no cut") {
    Model model = strip(std::array<float, 2>{0, 1});
    for (const glm::vec3 p : {glm::vec3(5, 0, 0), glm::vec3(6, 0, 0), glm::vec3(5, 1, 0)}) model.positions.push_back(p);
    model.triangles.emplace_back(4, 5, 6);
    model.triangleFace.push_back(2);
    model.triangleMaterial.push_back(0);
    model.triangleNode.push_back(bake::kNone);
    model.inputFaceCount = 3;
    const Welded w = welded(model);
    const SegmentationErrors e = compare(w.surface, {0, 0, 1}, {0, 1, 1});
    CHECK_FALSE(e.cutDiscrepancy.has_value());
    // One pair each, none in both: 2 over (3 - 1) / 2 * 3.
    CHECK(e.randIndex == doctest::Approx(2.0 / 3));
    // Each face is 1/2, so 1/2 of 3/2 either way. Consistency: faces 0 and 1 at 1/2, 2 at 0; back 0 at 0.
    CHECK(e.hamming == doctest::Approx(1.0 / 3));
    CHECK(e.globalConsistency == doctest::Approx(1.0 / 3));
    CHECK(e.localConsistency == doctest::Approx(0.5 / 3));
}

TEST_CASE("Hamming weighs by area, the others count faces") {
    // Squares of 1 and 9; labelings that differ by the square of 1 or by a half of the other.
    const Welded w = welded(strip(std::array<float, 3>{0, 1, 10}));
    const SegmentationErrors e = compare(w.surface, {0, 0, 1, 1}, {0, 0, 0, 1});
    // The square of 9 misses 4.5 of 10; back the segment of 5.5 misses its square of 1, not its 4.5.
    CHECK(e.hamming == doctest::Approx((0.45 + 0.1) / 2));
    // Together 1 + 1 and 3, in both 1: 5 - 2 = 3 over (4 - 1) / 2 * 4 = 4.
    CHECK(e.randIndex == 0.75);
    // From the squares: faces 2 and 3 at 1/2: 1; back: 0 and 1 at 1/3, 2 at 2/3: 4/3.
    CHECK(e.globalConsistency == doctest::Approx(0.25));
    // Faces 0 and 1: min(0, 1/3); 2: min(1/2, 2/3); 3: min(1/2, 0).
    CHECK(e.localConsistency == doctest::Approx(0.125));
}

TEST_CASE("cut vertices are counted once each") {
    const Welded w = welded(strip(kFourSquares));
    // Face 0 alone is cut off by b0 t1 and b1 t1. From b0, b1 and t1 to the cut at 2: 2, 1 and 1; back 1 and 1.
    const std::vector<uint32_t> faceZero = {1, 0, 0, 0, 0, 0, 0, 0};
    CHECK(prepareLabels(w.surface, faceZero).cut.size() == 3);
    CHECK(*compare(w.surface, faceZero, kHalves).cutDiscrepancy ==
          doctest::Approx(6.0 / 5 / w.surface.averageRadius).epsilon(1e-12));
}

TEST_CASE("distances follow edges by length, not by number") {
    // The top is moved by -1, so that the diagonals, b0 t1, ..., are the short edges: 0.1.
    const Welded w = welded(strip(kFourSquares, 0.1f, -1));
    // Cuts b1 t1 and b2 t2: b1 t2 and t2 b1 are 0.1 apart, t1 to t2 and b2 to b1 are 1.
    CHECK(*compare(w.surface, kFirstSquare, kHalves).cutDiscrepancy ==
          doctest::Approx(2.2 / 4 / w.surface.averageRadius).epsilon(1e-6));
    const std::vector<uint32_t> last = {0, 0, 0, 0, 0, 0, 1, 1};
    // Cuts b1 t1 and b3 t3. b1 - t2 - t3: 0.1 + 1; t1 - t2 - t3: 2; b3 - b2 - b1: 2; t3 - t2 - b1 (or b2): 1.1.
    CHECK(*compare(w.surface, kFirstSquare, last).cutDiscrepancy ==
          doctest::Approx(6.2 / 4 / w.surface.averageRadius).epsilon(1e-6));
}

TEST_CASE("where no path leads to the cut, distances are straight") {
    // Two strips of two squares, the second 3 above the first, not joined.
    Model model = strip(std::array<float, 3>{0, 1, 2});
    for (uint32_t i = 0; i < 6; ++i) model.positions.push_back(model.positions[i] + glm::vec3(0, 4, 0));
    for (uint32_t i = 0; i < 4; ++i) model.triangles.push_back(model.triangles[i] + glm::uvec3(6));
    model = test::modelOf(model.positions, model.triangles);
    const Welded w = welded(model);
    // Cuts at x = 1: (1, 0) and (1, 1) below, (1, 4) and (1, 5) above: nearest 4, 3, 3, 4.
    const std::vector<uint32_t> below = {0, 0, 1, 1, 2, 2, 2, 2}, above = {0, 0, 0, 0, 1, 1, 2, 2};
    CHECK(*compare(w.surface, below, above).cutDiscrepancy ==
          doctest::Approx(14.0 / 4 / w.surface.averageRadius).epsilon(1e-12));
}

TEST_CASE("the first two faces of a non-manifold edge decide") {
    // Three triangles around the edge from (0,0,0) to (0,0,1).
    const Welded w = welded(
        test::modelOf({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
    CHECK(prepareLabels(w.surface, std::vector<uint32_t>{0, 0, 1}).cut.empty());
    CHECK(prepareLabels(w.surface, std::vector<uint32_t>{0, 1, 1}).cut == std::vector<uint32_t>{0, 1});
}

TEST_CASE("a polygon is one face, and a dropped face counts without area") {
    // Two squares as quadrangles, and a face that welding drops: it has a corner twice.
    Model model = strip(std::array<float, 3>{0, 1, 2});
    model.triangles.emplace_back(0, 0, 2);
    model.triangleFace = {0, 0, 1, 1, 2};
    model.triangleMaterial.push_back(0);
    model.triangleNode.push_back(bake::kNone);
    model.inputFaceCount = 3;
    const Welded w = welded(model);
    CHECK(w.surface.faceArea == std::vector<double>{1, 1, 0});
    CHECK(w.surface.joints.size() == 1);
    // Pairs together: 1 and 1, in both none: 2 of (3 - 1) / 2 * 3. Areas agree wherever there are any.
    const SegmentationErrors e = compare(w.surface, {0, 1, 0}, {0, 1, 1});
    CHECK(e.randIndex == doctest::Approx(2.0 / 3));
    CHECK(e.hamming == 0);
    CHECK(e.cutDiscrepancy == 0.0);
}

TEST_CASE("tiny surfaces do not divide by zero") {
    const Welded one = welded(test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
    const SegmentationErrors e = compare(one.surface, {0}, {1});
    CHECK(e.randIndex == 0);
    CHECK(e.hamming == 0);
    // All corners on one line: no area and no radius.
    const Welded line = welded(test::modelOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 3, 2}}));
    const SegmentationErrors flat = compare(line.surface, {0, 1}, {1, 0});
    CHECK_FALSE(flat.cutDiscrepancy.has_value());
    CHECK(flat.hamming == 0);
    CHECK(std::isfinite(flat.globalConsistency));
}
