#include <xgc/bake/hierarchy.h>
#include <xgc/indices.h>

#include "meshes/patched_torus.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>

namespace {

using Triangle = std::array<float, 9>; ///< three positions, the least first, orientation kept
constexpr uint32_t kGuard = 0xdeadbeef;

Triangle triangleOf(std::array<glm::vec3, 3> p) {
    const auto less = [](const glm::vec3& a, const glm::vec3& b) {
        return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
    };
    std::rotate(p.begin(), std::min_element(p.begin(), p.end(), less), p.end());
    return {p[0].x, p[0].y, p[0].z, p[1].x, p[1].y, p[1].z, p[2].x, p[2].y, p[2].z};
}

/// Indices of a patch, built into exactly its capacity between guard words.
std::vector<uint32_t> build(const xgc::AssetView& asset, uint32_t patch, xgc::Levels levels) {
    const uint32_t capacity = xgc::indexCapacity(asset, patch, levels);
    std::vector<uint32_t> scratch(xgc::scratchCapacity(asset) + 1, kGuard), out(capacity + 2, kGuard);
    const uint32_t count =
        xgc::buildIndices(asset, patch, levels, std::span(scratch).first(scratch.size() - 1), {&out[1], capacity});
    CHECK(count <= capacity);
    CHECK(scratch.back() == kGuard);
    CHECK(out.front() == kGuard);
    CHECK(out.back() == kGuard);
    return {out.begin() + 1, out.begin() + 1 + count};
}

std::vector<Triangle> drawn(const xgc::AssetView& asset, uint32_t patch, xgc::Levels levels) {
    const std::vector<uint32_t> indices = build(asset, patch, levels);
    std::vector<Triangle> triangles;
    for (size_t i = 0; i < indices.size(); i += 3) {
        triangles.push_back(triangleOf(
            {asset.positions[indices[i]], asset.positions[indices[i + 1]], asset.positions[indices[i + 2]]}));
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

/// Triangles of vertex rows, sorted, the least row of each first.
std::vector<std::array<uint32_t, 3>> drawnRows(const xgc::AssetView& asset, uint32_t patch, xgc::Levels levels) {
    const std::vector<uint32_t> indices = build(asset, patch, levels);
    std::vector<std::array<uint32_t, 3>> triangles;
    for (size_t i = 0; i < indices.size(); i += 3) {
        triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
        std::rotate(triangles.back().begin(), std::min_element(triangles.back().begin(), triangles.back().end()),
                    triangles.back().end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

std::vector<std::vector<Triangle>> expected(const xgc::test::Patched& built, xgc::Levels levels) {
    const xgc::bake::Hierarchy& h = built.hierarchy;
    const xgc::bake::DrawnSurface surface = xgc::bake::drawSurface(built.mesh, h, levels);
    std::vector<std::vector<Triangle>> patches(h.patchCount());
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto at = [&](int k) { return h.positions[h.wedgePosition[surface.triangles[t][k]]]; };
        patches[h.facePatch[surface.face[t]]].push_back(triangleOf({at(0), at(1), at(2)}));
    }
    for (auto& p : patches) std::sort(p.begin(), p.end());
    return patches;
}

class States {
public:
    explicit States(const xgc::AssetView& asset) : asset_(asset) {}
    std::vector<uint8_t> next() {
        std::vector<uint8_t> levels(asset_.patchCount());
        for (uint8_t& l : levels) l = uint8_t(engine_() % asset_.levelCount());
        return levels;
    }
    /// Differs in one patch.
    std::vector<uint8_t> near(std::vector<uint8_t> levels) {
        levels[engine_() % levels.size()] = uint8_t(engine_() % asset_.levelCount());
        return levels;
    }

private:
    const xgc::AssetView& asset_;
    std::minstd_rand engine_{11};
};

} // namespace

TEST_CASE("a patch's indices are the surface of the state by definition, whatever the neighbours' levels") {
    for (const uint32_t repeated : {0u, 2u}) {
        const auto built =
            xgc::test::patchedTorus({.patches = 4, .levels = 3, .materials = 2, .repeatedLevels = repeated});
        REQUIRE(xgc::bake::checkHierarchy(built.mesh, built.hierarchy).message == "");
        const auto asset = xgc::test::openBuilt(built);
        REQUIRE(asset.failure == "");
        States states(asset.view);
        for (int i = 0; i < 60; ++i) {
            const std::vector<uint8_t> levels = states.next();
            const auto truth = expected(built, levels);
            for (uint32_t p = 0; p < asset.view.patchCount(); ++p) CHECK(drawn(asset.view, p, levels) == truth[p]);
        }
    }
}

TEST_CASE("patches built in one state close: every edge is used once in each direction") {
    const auto asset = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 5, .levels = 3}));
    REQUIRE(asset.failure == "");
    States states(asset.view);
    for (int i = 0; i < 40; ++i) {
        const std::vector<uint8_t> levels = states.next();
        std::map<std::pair<uint32_t, uint32_t>, int> uses;
        for (uint32_t p = 0; p < asset.view.patchCount(); ++p) {
            const std::vector<uint32_t> indices = build(asset.view, p, levels);
            for (size_t t = 0; t < indices.size(); t += 3) {
                for (size_t k = 0; k < 3; ++k) {
                    const uint32_t a = indices[t + k], b = indices[t + (k + 1) % 3];
                    CHECK(a != b);
                    uses[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
                }
            }
        }
        for (const auto& [edge, sum] : uses) CHECK(sum == 0);
    }
}

TEST_CASE("patches with more than 65,536 slots use wide slots and give the same surface") {
    // A patch has 257 x 257 slots.
    const auto built = xgc::test::patchedTorus({.patches = 2, .levels = 8});
    const auto asset = xgc::test::openBuilt(built);
    REQUIRE(asset.failure == "");
    CHECK((asset.view.patches[0].flags & xgc::format::kWideSlots) != 0);
    CHECK(xgc::scratchCapacity(asset.view) == 257 * 257);
    const std::vector<uint8_t> levels = {2, 0, 5, 8};
    const auto truth = expected(built, levels);
    for (uint32_t p = 0; p < 4; ++p) CHECK((drawn(asset.view, p, levels) == truth[p]));
}

TEST_CASE("the capacity is exact at level 0, and no level that rises raises it") {
    const auto asset = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 3, .levels = 4}));
    REQUIRE(asset.failure == "");
    const uint32_t patches = asset.view.patchCount();
    States states(asset.view);
    for (uint32_t p = 0; p < patches; ++p) {
        const std::vector<uint8_t> finest(patches, 0), coarsest(patches, uint8_t(asset.view.levelCount() - 1));
        CHECK(xgc::indexCapacity(asset.view, p, finest) == 3 * 2 * 16 * 16);
        CHECK(build(asset.view, p, finest).size() == 3 * 2 * 16 * 16);
        CHECK(xgc::indexCapacity(asset.view, p, coarsest) >= build(asset.view, p, coarsest).size());
        CHECK(xgc::indexCapacity(asset.view, p, coarsest) <= 3 * 16);
        for (int i = 0; i < 100; ++i) {
            std::vector<uint8_t> levels = states.next();
            const uint32_t before = xgc::indexCapacity(asset.view, p, levels);
            uint8_t& level = levels[size_t(i) % patches];
            level = uint8_t(std::min<uint32_t>(level + 1u, asset.view.levelCount() - 1));
            CHECK(xgc::indexCapacity(asset.view, p, levels) <= before);
        }
    }
}

TEST_CASE("needsRebuild is true exactly where the triangles differ") {
    const auto asset =
        xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 4, .levels = 3, .materials = 1, .repeatedLevels = 2}));
    REQUIRE(asset.failure == "");
    States states(asset.view);
    int rebuilt = 0, kept = 0, levelChangedAlone = 0;
    for (int i = 0; i < 300; ++i) {
        const std::vector<uint8_t> before = states.next(), after = i % 3 ? states.near(before) : states.next();
        for (uint32_t p = 0; p < asset.view.patchCount(); ++p) {
            const bool differs = drawnRows(asset.view, p, before) != drawnRows(asset.view, p, after);
            CHECK(xgc::needsRebuild(asset.view, p, before, after) == differs);
            ++(differs ? rebuilt : kept);
            levelChangedAlone += !differs && before[p] != after[p];
        }
    }
    CHECK(rebuilt > 100);
    CHECK(kept > 100);
    CHECK(levelChangedAlone > 10); // levels that repeat a surface cost nothing
}

TEST_CASE("domainLevel is the least level over the domain's patches") {
    const auto asset = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 3, .levels = 1}));
    REQUIRE(asset.failure == "");
    const std::vector<uint8_t> levels = {1, 0, 1, 1, 1, 1, 0, 1, 1};
    for (uint32_t d = 0; d < asset.view.domains.size(); ++d) {
        uint32_t least = 255;
        for (const uint32_t p : asset.view.patchesOf(d)) least = std::min<uint32_t>(least, levels[p]);
        CHECK(xgc::domainLevel(asset.view, d, levels) == least);
    }
}
