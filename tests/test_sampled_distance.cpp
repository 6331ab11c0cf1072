#include "bench/sampled_distance.h"
#include "meshes/builders.h"

#include <doctest/doctest.h>

#include <cmath>

// The instrument that the benchmarks judge by.

using namespace xgc;
using namespace xgc::bench;

namespace {

Surface scaled(Surface s, float factor) {
    for (glm::vec3& p : s.points) p *= factor;
    return s;
}

Surface surfaceOfModel(const bake::Model& model) {
    return surfaceOf(test::welded(model));
}

} // namespace

TEST_CASE("a sphere lies its radii's difference from a larger one") {
    const Surface sphere = surfaceOfModel(test::sphere(64));
    const DistanceReference reference(sphere, 50'000);
    const TwoSided d = reference.compare(scaled(sphere, 1.1f));
    CHECK(d.rms() == doctest::Approx(0.1).epsilon(2e-3)); // flat faces: less than the radii by up to 3e-4
    CHECK(d.max() == doctest::Approx(0.1).epsilon(2e-3));
    CHECK(reference.diagonal() == doctest::Approx(std::sqrt(12.0)).epsilon(1e-3));
}

TEST_CASE("a surface lies on itself, also far from the origin") {
    Surface sphere = surfaceOfModel(test::sphere(24));
    CHECK(DistanceReference(sphere, 20'000).compare(sphere).max() < 1e-7);
    for (glm::vec3& p : sphere.points) p += glm::vec3(1000, -2000, 500);
    CHECK(DistanceReference(sphere, 20'000).compare(sphere).max() < 2e-4); // an ulp at 2000 is 1.2e-4
}

TEST_CASE("what one surface lacks counts one way only") {
    const Surface square = surfaceOfModel(test::grid(16));
    Surface half = square;
    std::erase_if(half.triangles, [&](const glm::uvec3& t) {
        return square.points[t.x].x + square.points[t.y].x + square.points[t.z].x > 1.5f;
    });
    const TwoSided d = DistanceReference(square).compare(half);
    CHECK(d.toReference.max == 0);
    CHECK(d.fromReference.max == 0.5);
    CHECK(d.fromReference.rms == doctest::Approx(std::sqrt(0.125 / 3)).epsilon(1e-3));
    CHECK(d.rms() == doctest::Approx(std::sqrt(0.125 / 6)).epsilon(1e-3));
}

TEST_CASE("the maximum sees a needle that no sample hits") {
    Surface square = surfaceOfModel(test::grid(64));
    const DistanceReference reference(square, 1000);
    const auto tip = uint32_t(square.points.size());
    square.points.emplace_back(0.5f, 0.5f, 0.25f);
    square.triangles.emplace_back(0, 1, tip);
    square.points[1] = square.points[0] + glm::vec3(1e-6f, 0, 0);
    CHECK(reference.compare(square).toReference.max == 0.25);
}

TEST_CASE("samples cover the surface evenly by area") {
    const Surface square = surfaceOfModel(test::grid(3));
    uint32_t left = 0;
    const auto samples = samplePoints(square, 10'000);
    REQUIRE(samples.size() == 10'000);
    for (const SamplePoint& s : samples) {
        left += s.point.x < 0.5f;
        const glm::uvec3& t = square.triangles[s.triangle];
        const glm::vec3 again =
            s.weights.x * square.points[t.x] + s.weights.y * square.points[t.y] + s.weights.z * square.points[t.z];
        CHECK(glm::distance(again, s.point) < 1e-6f);
    }
    CHECK(std::abs(int(left) - 5000) < 150);
}

TEST_CASE("PLY files keep surfaces exactly") {
    Surface s = surfaceOfModel(test::sphere(4));
    for (const glm::vec3& p : s.points) {
        s.normals.push_back(p / 3.0f);
        s.uvs.emplace_back(p.x, p.z / 7);
    }
    const auto file = std::filesystem::path(XGC_BINARY_DIR) / "sampled_distance.ply";
    REQUIRE(writePly(file, s).ok());
    Surface back;
    REQUIRE(readPly(file, back).ok());
    CHECK(back.points == s.points);
    CHECK(back.normals == s.normals);
    CHECK(back.uvs == s.uvs);
    CHECK(back.triangles == s.triangles);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
    CHECK(!readPly(file, back).ok());
}
