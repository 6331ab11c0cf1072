#include "meshes/builders.h"
#include "meshes/toy_hierarchy.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/indices.h>

#include <doctest/doctest.h>

#include <array>
#include <cstring>

using namespace xgc;
using namespace xgc::bake;
using test::ToyOptions;

namespace {

Mesh weldedMesh(const Model& model) {
    Mesh mesh;
    WeldReport report;
    const bake::Status s = weld(model, {}, mesh, report);
    REQUIRE_MESSAGE(s.ok(), s.message);
    return mesh;
}

/// A mesh, its hierarchy, and the asset that they became.
struct Baked {
    Mesh mesh;
    Segmentation parts;
    Hierarchy hierarchy;
    AlignedBytes file;
    AssetView asset;
};

AlignedBytes aligned(const std::vector<std::byte>& bytes) {
    AlignedBytes copy;
    copy.blocks.resize((bytes.size() + 63) / 64);
    copy.size = bytes.size();
    std::memcpy(copy.blocks.data(), bytes.data(), bytes.size());
    return copy;
}

Baked bakeToy(const Model& model, uint32_t patches, const ToyOptions& options) {
    Baked b;
    b.mesh = weldedMesh(model);
    b.parts = test::slabs(b.mesh, patches);
    b.hierarchy = test::toyHierarchy(b.mesh, b.parts, options);
    const bake::Status rules = checkHierarchy(b.mesh, b.hierarchy);
    REQUIRE_MESSAGE(rules.ok(), rules.message);
    std::vector<std::byte> bytes;
    const bake::Status s = layOutAsset(b.mesh, b.parts, b.hierarchy, test::toyErrors(b.hierarchy), false, "{}", bytes);
    REQUIRE_MESSAGE(s.ok(), s.message);
    b.file = aligned(bytes);
    const xgc::Status opened = openAll(b.file.span(), b.asset);
    REQUIRE_MESSAGE(opened.ok(), opened.message);
    return b;
}

/// Row to wedge, from the UV set in which the toy hierarchy writes it.
std::vector<uint32_t> wedgesOfRows(const AssetView& asset) {
    for (uint32_t i = 0; i < asset.vertexStreamCount; ++i) {
        const VertexStream& s = asset.vertexStreams[i];
        if (s.kind != format::StreamKind::uv) continue;
        std::vector<uint32_t> wedges(s.count);
        for (uint32_t row = 0; row < s.count; ++row) {
            float u = 0;
            std::memcpy(&u, s.bytes.data() + size_t(row) * s.stride, sizeof u);
            wedges[row] = uint32_t(u);
        }
        return wedges;
    }
    return {};
}

using Triangle = std::array<uint32_t, 3>;

/// Rotated so that the lowest corner is first: orientation is kept.
Triangle canonical(uint32_t a, uint32_t b, uint32_t c) {
    if (b < a && b < c) return {b, c, a};
    if (c < a && c < b) return {c, a, b};
    return {a, b, c};
}

std::vector<Triangle> drawnByDefinition(const Baked& b, Levels levels) {
    std::vector<Triangle> triangles;
    for (const glm::uvec3& t : drawSurface(b.mesh, b.hierarchy, levels).triangles) {
        triangles.push_back(canonical(t.x, t.y, t.z));
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

std::vector<Triangle> drawnByRuntime(const Baked& b, const std::vector<uint32_t>& wedges, Levels levels) {
    std::vector<uint32_t> scratch(scratchCapacity(b.asset));
    std::vector<Triangle> triangles;
    for (uint32_t p = 0; p < b.asset.patchCount(); ++p) {
        std::vector<uint32_t> out(indexCapacity(b.asset, p, levels[p]));
        const uint32_t count = buildIndices(b.asset, p, levels, scratch, out);
        REQUIRE(count <= out.size());
        for (uint32_t i = 0; i < count; i += 3) {
            triangles.push_back(canonical(wedges.at(out[i]), wedges.at(out[i + 1]), wedges.at(out[i + 2])));
        }
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

void checkState(const Baked& b, const std::vector<uint32_t>& wedges, Levels levels) {
    const bool same = drawnByRuntime(b, wedges, levels) == drawnByDefinition(b, levels);
    if (same) return;
    std::string state;
    for (const uint8_t l : levels) state += std::to_string(l) + " ";
    FAIL_CHECK("state " << state);
}

void checkAllStates(const Baked& b) {
    const std::vector<uint32_t> wedges = wedgesOfRows(b.asset);
    std::vector<uint8_t> levels(b.asset.patchCount(), 0);
    for (size_t carry = 0; carry < levels.size();) {
        checkState(b, wedges, levels);
        for (carry = 0; carry < levels.size() && ++levels[carry] == b.asset.levelCount(); ++carry) levels[carry] = 0;
    }
}

void checkRandomStates(const Baked& b, uint32_t count) {
    const std::vector<uint32_t> wedges = wedgesOfRows(b.asset);
    std::mt19937 random(7);
    std::vector<uint8_t> levels(b.asset.patchCount());
    for (uint32_t i = 0; i < count; ++i) {
        for (uint8_t& l : levels) l = uint8_t(random() % b.asset.levelCount());
        checkState(b, wedges, levels);
    }
}

} // namespace

TEST_CASE("every state of a small asset draws what the hierarchy defines") {
    for (uint32_t seed = 1; seed <= 4; ++seed) {
        for (const bool lock : {false, true}) {
            for (const bool make : {false, true}) {
                ToyOptions options;
                options.seed = seed;
                options.levelCount = 5;
                options.lockBoundaries = lock;
                options.makeVertices = make;
                checkAllStates(bakeToy(test::sphere(4), 3, options));
            }
        }
    }
}

TEST_CASE("random states of a larger asset draw what the hierarchy defines") {
    ToyOptions options;
    options.levelCount = 12;
    options.share = 0.25f;
    for (const bool make : {false, true}) {
        options.makeVertices = make;
        checkRandomStates(bakeToy(test::sphere(24), 9, options), 60);
        checkRandomStates(bakeToy(test::grid(40), 6, options), 60);
    }
}
