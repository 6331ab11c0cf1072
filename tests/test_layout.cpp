#include "meshes/toy_asset.h"

#include <xgc/bake/default_hierarchy.h>
#include <xgc/bake/patches.h>
#include <xgc/indices.h>

#include <doctest/doctest.h>

#include <array>

using namespace xgc;
using namespace xgc::bake;
using test::ToyOptions;

namespace {

using Baked = test::ToyAsset;

Baked bakeToy(const Model& model, uint32_t patches, const ToyOptions& options) {
    Baked b = test::toyAsset(model, patches, options);
    REQUIRE_MESSAGE(b.error.empty(), b.error);
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
        std::vector<uint32_t> out(indexCapacity(b.asset, p, levels));
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

TEST_CASE("indices wider than 16 bits draw the same") {
    ToyOptions options;
    options.levelCount = 3;
    const Baked b = bakeToy(test::grid(260), 1, options);
    CHECK((b.asset.patches[0].flags & format::kWideSlots) != 0);
    CHECK(b.asset.parentsNarrow.empty());
    checkAllStates(b);
}

TEST_CASE("patches of narrow and of wide slots stand side by side") {
    ToyOptions options;
    options.levelCount = 3;
    Baked b;
    WeldReport report;
    REQUIRE(weld(test::grid(270), {}, b.mesh, report).ok());
    b.parts = test::slabs(b.mesh, 20);
    for (uint32_t& part : b.parts.facePart) part = part == 19 ? 1 : 0;
    b.parts.partNames.resize(2);
    b.hierarchy = test::toyHierarchy(b.mesh, b.parts, options);
    const bake::Status s = layOutAsset(b.mesh, b.parts, b.hierarchy, test::toyErrors(b.hierarchy), false, "", b.bytes);
    REQUIRE_MESSAGE(s.ok(), s.message);
    b.file = test::aligned(b.bytes);
    REQUIRE(openAll(b.file.span(), b.asset).ok());
    CHECK(!b.asset.parentsNarrow.empty());
    CHECK(!b.asset.parentsWide.empty());
    checkAllStates(b);
}

TEST_CASE("uniform face counts of the levels are those that are drawn") {
    for (const bool lock : {false, true}) {
        ToyOptions options;
        options.lockBoundaries = lock;
        const Baked b = bakeToy(test::sphere(8), 5, options);
        for (uint32_t level = 0; level < b.asset.levelCount(); ++level) {
            const std::vector<uint8_t> levels(b.asset.patchCount(), uint8_t(level));
            CHECK(b.asset.levels[level].faceCount == drawSurface(b.mesh, b.hierarchy, levels).triangles.size());
        }
    }
}

TEST_CASE("a face list is what its patch draws with all patches at the list's level, in fewer and fewer faces") {
    ToyOptions options;
    options.levelCount = 12;
    options.share = 0.25f;
    const Baked b = bakeToy(test::sphere(24), 5, options);
    const uint32_t patches = b.asset.patchCount();
    std::vector<std::vector<uint32_t>> drawn(b.asset.levelCount(), std::vector<uint32_t>(patches));
    for (uint32_t level = 0; level < b.asset.levelCount(); ++level) {
        const std::vector<uint8_t> levels(patches, uint8_t(level));
        for (const uint32_t f : drawSurface(b.mesh, b.hierarchy, levels).face) ++drawn[level][b.hierarchy.facePatch[f]];
    }
    uint32_t coarse = 0;
    for (uint32_t p = 0; p < patches; ++p) {
        for (uint32_t level = 0; level < b.asset.levelCount(); ++level) {
            const std::vector<uint8_t> levels(patches, uint8_t(level));
            uint32_t listed = 0;
            for (const format::FaceList& list : b.asset.listsOf(p)) {
                if (list.level > level) continue;
                listed = list.faceCount;
                coarse += list.level == level && level > 0;
                if (list.level == level) CHECK(listed == drawn[level][p]);
            }
            CHECK(indexCapacity(b.asset, p, levels) == 3 * listed);
            // Lists are short: not many faces are passed over.
            CHECK((listed < 6 * drawn[level][p] || listed <= 16));
        }
    }
    CHECK(coarse >= 2 * patches);
}

TEST_CASE("domains are cut by how long their vertices live, and no parent lies behind its child") {
    ToyOptions options;
    options.levelCount = 12;
    options.share = 0.25f;
    const Baked b = bakeToy(test::sphere(24), 5, options);
    const AssetView& a = b.asset;
    std::vector<uint8_t> lastLevel(a.collapseLevels.begin(), a.collapseLevels.end());
    uint32_t cut = 0, falling = 0;
    for (uint32_t p = 0; p < a.patchCount(); ++p) {
        std::vector<uint32_t> rows;
        const auto append = [&](format::VertexRange range) {
            for (uint32_t k = 0; k < range.count; ++k) rows.push_back(range.first + k);
        };
        for (const uint32_t d : a.domainsOf(p)) append(a.domainRange(d));
        append(a.interiorRange(p));
        for (size_t slot = rows.size(); slot-- > 0;) {
            const uint32_t up = rows[a.parentsNarrow[a.patches[p].firstParent + slot]];
            falling += up > rows[slot];
            lastLevel[up] = std::max(lastLevel[up], lastLevel[rows[slot]]);
        }
    }
    CHECK(falling == 0);
    // Pieces of one domain: what lives longest comes first.
    const auto of = [&](uint32_t d) { return std::vector<uint32_t>(a.patchesOf(d).begin(), a.patchesOf(d).end()); };
    for (uint32_t d = 0; d < a.domains.size(); ++d) {
        for (uint32_t e = d + 1; e < a.domains.size(); ++e) {
            if (of(d) != of(e)) continue;
            ++cut;
            const auto levels = [&](uint32_t domain) {
                const format::VertexRange r = a.domainRange(domain);
                return std::minmax_element(lastLevel.begin() + r.first, lastLevel.begin() + r.first + r.count);
            };
            CHECK(*levels(d).first > *levels(e).second);
        }
    }
    CHECK(cut > 0);
}

namespace {

/// Returns how many triangles were held against a cone.
uint32_t checkBoundsAndCones(const AssetView& asset) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out(3 * size_t(asset.record->maxPatchFaces));
    std::mt19937 random(3);
    uint32_t outside = 0, checked = 0;
    std::vector<uint8_t> levels(asset.patchCount());
    for (int state = 0; state < 300; ++state) {
        for (size_t p = 0; p < levels.size(); ++p) {
            const uint32_t last = state % 2 ? asset.patches[p].coneLevel : asset.levelCount() - 1;
            levels[p] = uint8_t(random() % 2 ? last : random() % (last + 1));
        }
        for (uint32_t p = 0; p < levels.size(); ++p) {
            const format::PatchRecord& r = asset.patches[p];
            const glm::vec3 center(r.sphereCenter[0], r.sphereCenter[1], r.sphereCenter[2]);
            const glm::vec3 axis(r.coneAxis[0], r.coneAxis[1], r.coneAxis[2]);
            const uint32_t count = buildIndices(asset, p, levels, scratch, out);
            for (uint32_t i = 0; i < count; ++i) {
                const glm::vec3 x = asset.positions[out[i]];
                outside += glm::length(x - center) > r.sphereRadius;
                for (int k = 0; k < 3; ++k) outside += x[k] < r.boxMin[k] || x[k] > r.boxMax[k];
            }
            for (uint32_t i = 0; i < count && levels[p] <= r.coneLevel && r.coneCosine > 0; i += 3) {
                const glm::dvec3 a(asset.positions[out[i]]), c(asset.positions[out[i + 1]]),
                    d(asset.positions[out[i + 2]]);
                const glm::dvec3 n = glm::cross(c - a, d - a);
                if (glm::length(n) == 0) continue;
                ++checked;
                outside += glm::dot(n, glm::dvec3(axis)) < r.coneCosine * glm::length(n);
            }
        }
    }
    CHECK(outside == 0);
    return checked;
}

} // namespace

TEST_CASE("bounds contain every triangle of every state, and cones every normal up to their level") {
    ToyOptions options;
    options.levelCount = 4;
    options.share = 0.2f;
    for (const bool make : {false, true}) {
        options.makeVertices = make;
        CHECK(checkBoundsAndCones(bakeToy(test::sphere(6), 6, options).asset) > 0);
    }
}

TEST_CASE("bounds and cones hold in the default hierarchy") {
    std::mt19937 random(5);
    const auto build = [](const Mesh& mesh, const Segmentation& parts) {
        const Topology topology = buildTopology(mesh);
        return buildDefaultHierarchy(mesh, topology, splitPatches(mesh, topology, parts, 0), {});
    };
    for (const uint32_t patches : {4u, 9u, 20u}) {
        for (const float height : {0.01f, 0.03f}) {
            Model model = test::grid(24);
            for (glm::vec3& p : model.positions) p.z = height * float(random() % 1000) / 1000;
            const Baked b = test::assetOf(model, patches, build);
            REQUIRE_MESSAGE(b.error.empty(), b.error);
            CHECK(checkBoundsAndCones(b.asset) > 0);
        }
    }
}

TEST_CASE("parts carry their name, area, centre and neighbours") {
    ToyOptions options;
    const Baked b = bakeToy(test::cube(4), 3, options);
    double area = 0;
    for (const format::PartRecord& part : b.asset.parts) area += part.area;
    CHECK(area == doctest::Approx(6));
    REQUIRE(b.asset.parts.size() == 3);
    CHECK(b.asset.text(b.asset.parts[1].name) == "part 1");
    const auto neighboursOf = [&](uint32_t i) {
        const format::PartRecord& part = b.asset.parts[i];
        const auto n = b.asset.partNeighbours.subspan(part.firstNeighbour, part.neighbourCount);
        return std::vector<uint32_t>(n.begin(), n.end());
    };
    CHECK(neighboursOf(0) == std::vector<uint32_t>{1});
    CHECK(neighboursOf(1) == std::vector<uint32_t>{0, 2});
}

TEST_CASE("attributes come back row by row within the precision of their encodings") {
    ToyOptions options;
    Baked b;
    Model model = test::sphere(6);
    model.attributes.normals = model.positions;
    for (const glm::vec3& p : model.positions) {
        model.attributes.colors[0].emplace_back(p * 0.5f + 0.5f, 1.0f);
        model.attributes.tangents.emplace_back(p.y, -p.x, 0.0f, p.z < 0 ? -1.0f : 1.0f);
        model.attributes.joints[0].emplace_back(1, 2, 3, 4);
        model.attributes.weights[0].emplace_back(p, 0.25f);
    }
    b = bakeToy(model, 2, options);
    const std::vector<uint32_t> wedges = wedgesOfRows(b.asset);
    REQUIRE(b.asset.vertexStreamCount == 7);
    CHECK(b.asset.vertexStreams[0].kind == format::StreamKind::position);
    const Attributes& a = b.hierarchy.attributes;
    double worstNormal = 1;
    float worstColor = 0;
    bool exactWeights = true;
    for (uint32_t row = 0; row < wedges.size(); ++row) {
        const uint32_t w = wedges[row];
        for (uint32_t s = 0; s < b.asset.vertexStreamCount; ++s) {
            const VertexStream& stream = b.asset.vertexStreams[s];
            const std::byte* at = stream.bytes.data() + size_t(row) * stream.stride;
            if (stream.kind == format::StreamKind::normal) {
                std::array<int16_t, 2> e{};
                std::memcpy(e.data(), at, sizeof e);
                glm::dvec3 n(e[0] / 32767.0, e[1] / 32767.0, 0);
                n.z = 1 - std::abs(n.x) - std::abs(n.y);
                if (n.z < 0) {
                    const glm::dvec3 o = n;
                    n.x = (1 - std::abs(o.y)) * (o.x < 0 ? -1 : 1);
                    n.y = (1 - std::abs(o.x)) * (o.y < 0 ? -1 : 1);
                }
                worstNormal =
                    std::min(worstNormal, glm::dot(glm::normalize(n), glm::normalize(glm::dvec3(a.normals[w]))));
            } else if (stream.kind == format::StreamKind::color) {
                for (int k = 0; k < 4; ++k) {
                    worstColor = std::max(worstColor, std::abs(float(uint8_t(at[k])) / 255.0f - a.colors[0][w][k]));
                }
            } else if (stream.kind == format::StreamKind::weights) {
                exactWeights = exactWeights && std::memcmp(at, &a.weights[0][w], 16) == 0;
            }
        }
    }
    CHECK(worstNormal > 1 - 1e-8);
    CHECK(worstColor <= 0.5f / 255 + 1e-6f);
    CHECK(exactWeights);
}

TEST_CASE("errors that fall with the level are refused, and nothing is written") {
    const Baked b = bakeToy(test::sphere(3), 2, {});
    PatchErrors errors = test::toyErrors(b.hierarchy);
    errors.values[2] = errors.values[1] * 0.5f;
    std::vector<std::byte> out(3);
    const bake::Status s = layOutAsset(b.mesh, b.parts, b.hierarchy, errors, false, "", out);
    CHECK(s.outcome == Outcome::promiseBroken);
    CHECK(s.message.find("falls with the level, patch 0") != std::string::npos);
    CHECK(out.size() == 3);
}
