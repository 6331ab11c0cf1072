#include "meshes/off.h"
#include "meshes/welded.h"
#include "segment/perceptual/exact_math.h"
#include "segment/perceptual/min_cut.h"
#include "segment/perceptual/nearest_position.h"
#include "segment/perceptual/piece.h"
#include "segment/perceptual/ray_scene.h"

#include <xgc/bake/models.h>
#include <xgc/bake/perceptual.h>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <map>
#include <numeric>
#include <random>
#include <set>

using namespace xgc;
using namespace xgc::bake;

namespace {

using test::Welded;
using test::weldedWithTopology;

Segmentation partsOf(const Welded& w, const PerceptualOptions& options = {}) {
    return segmentPerceptual(w.mesh, w.topology, options);
}

Segmentation partsOf(const Model& model, const PerceptualOptions& options = {}) {
    return partsOf(weldedWithTopology(model), options);
}

/// A copy moved by `offset` and scaled before that.
Model placed(Model model, const glm::vec3& scale, const glm::vec3& offset) {
    for (glm::vec3& p : model.positions) p = p * scale + offset;
    return model;
}

Model joined(const std::vector<Model>& models) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const Model& model : models) {
        const auto base = uint32_t(positions.size());
        positions.insert(positions.end(), model.positions.begin(), model.positions.end());
        for (const glm::uvec3& t : model.triangles) triangles.push_back(t + base);
    }
    return test::modelOf(std::move(positions), std::move(triangles));
}

/// A ball of radius 1 with `arms` long thin cones of flesh: bumps of its own surface.
Model ballWithArms(uint32_t n, std::span<const glm::vec3> arms) {
    Model model = test::sphere(n);
    for (glm::vec3& p : model.positions) {
        float reach = 0;
        for (const glm::vec3& arm : arms) {
            const float along = glm::dot(p, glm::normalize(arm));
            if (along > 0.94f) reach = std::max(reach, (along - 0.94f) / 0.06f);
        }
        p *= 1 + 2.5f * std::sqrt(reach);
    }
    return model;
}
const std::vector<glm::vec3> kFourArms = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Labels dense, complete, by area descending, and connected within a component, but for those that took in others.
void checkLabels(const Welded& w, const Segmentation& parts) {
    REQUIRE(parts.facePart.size() == w.mesh.faces.size());
    std::vector<uint8_t> seen(parts.partCount(), 0);
    for (const uint32_t p : parts.facePart) {
        REQUIRE(p < parts.partCount());
        seen[p] = 1;
    }
    CHECK(std::accumulate(seen.begin(), seen.end(), 0u) == parts.partCount());
    CHECK(std::set<std::string>(parts.partNames.begin(), parts.partNames.end()).size() == parts.partCount());
}

/// Connected sets of equal labels within components, over those that there must be.
uint32_t looseSets(const Welded& w, const Segmentation& parts) {
    std::vector<uint8_t> seen(w.mesh.faces.size(), 0);
    std::set<std::pair<uint32_t, uint32_t>> wanted; // component, part
    uint32_t sets = 0;
    std::vector<uint32_t> walk;
    for (uint32_t seed = 0; seed < seen.size(); ++seed) {
        wanted.insert({w.topology.faceComponent[seed], parts.facePart[seed]});
        if (seen[seed]) continue;
        ++sets;
        walk.assign(1, seed);
        seen[seed] = 1;
        for (size_t i = 0; i < walk.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                for (const uint32_t g : w.topology.facesOfEdge(w.topology.faceEdges[walk[i]][k])) {
                    if (seen[g] || parts.facePart[g] != parts.facePart[seed]) continue;
                    seen[g] = 1;
                    walk.push_back(g);
                }
            }
        }
    }
    return sets - uint32_t(wanted.size());
}

/// Pairs of faces on which two labelings disagree, over all pairs.
double randIndexError(std::span<const uint32_t> a, std::span<const uint32_t> b) {
    std::map<uint32_t, double> inA, inB;
    std::map<std::pair<uint32_t, uint32_t>, double> inBoth;
    for (size_t f = 0; f < a.size(); ++f) {
        ++inA[a[f]];
        ++inB[b[f]];
        ++inBoth[{a[f], b[f]}];
    }
    double error = 0;
    for (const auto& [part, n] : inA) error += n * n;
    for (const auto& [part, n] : inB) error += n * n;
    for (const auto& [part, n] : inBoth) error -= 2 * n * n;
    return error / (double(a.size()) * double(a.size()));
}

/// Every part of `fine` lies in one of `coarse`.
bool liesWithin(const Segmentation& fine, const Segmentation& coarse) {
    std::map<uint32_t, uint32_t> home;
    for (size_t f = 0; f < fine.facePart.size(); ++f) {
        const auto [at, isNew] = home.try_emplace(fine.facePart[f], coarse.facePart[f]);
        if (at->second != coarse.facePart[f]) return false;
    }
    return true;
}

} // namespace

TEST_CASE("the project's own functions agree with the library's") {
    for (double x = 1e-6; x < 1e6; x *= 1.37) {
        CHECK(exact::log2(x) == doctest::Approx(std::log2(x)).epsilon(1e-9));
        CHECK(exact::pow(x, 0.32) == doctest::Approx(std::pow(x, 0.32)).epsilon(1e-9));
        CHECK(exact::pow(x, -1.2) == doctest::Approx(std::pow(x, -1.2)).epsilon(1e-9));
    }
    for (double x = -30; x < 30; x += 0.137) {
        CHECK(exact::exp(x) == doctest::Approx(std::exp(x)).epsilon(1e-9));
        CHECK(std::abs(exact::sin(x) - std::sin(x)) < 1e-9);
        CHECK(std::abs(exact::cos(x) - std::cos(x)) < 1e-9);
        const double angle = std::abs(x) / 30 * 3.14159;
        CHECK(std::abs(exact::upperAngle(std::sin(angle), std::cos(angle)) - angle) < 1e-9);
    }
    CHECK(exact::pow(0, 0.3) == 0);
    CHECK(exact::upperAngle(0, 0) == 0);
}

TEST_CASE("a ray meets what a look at every triangle finds") {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> anywhere(-1, 1);
    const auto point = [&] { return glm::vec3(anywhere(random), anywhere(random), anywhere(random)); };
    std::vector<glm::vec3> soup;
    for (int t = 0; t < 400; ++t) {
        const glm::vec3 at = point();
        for (int k = 0; k < 3; ++k) soup.push_back(at + 0.2f * point());
    }
    const RayScene scene(soup);
    const auto slow = [&](const glm::dvec3& o, const glm::dvec3& d) {
        double nearest = -1;
        for (size_t t = 0; t < soup.size(); t += 3) {
            const glm::dvec3 a(soup[t]), u = glm::dvec3(soup[t + 1]) - a, v = glm::dvec3(soup[t + 2]) - a;
            const glm::dvec3 p = glm::cross(d, v), s = o - a, q = glm::cross(s, u);
            const double det = glm::dot(u, p), x = glm::dot(s, p) / det, y = glm::dot(d, q) / det;
            const double at = glm::dot(v, q) / det;
            if (x >= 0 && y >= 0 && x + y <= 1 && at > 0 && (nearest < 0 || at < nearest)) nearest = at;
        }
        return nearest;
    };
    uint32_t hits = 0, occluder = 0, blocked = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 from = point(), to = point();
        const double expected = slow(from, to - from);
        const float at = scene.nearestHit(from, to - from, 0);
        CHECK(double(at) == doctest::Approx(expected).epsilon(1e-4));
        if (std::abs(expected - 1) > 1e-4) {
            CHECK(scene.isBlocked(from, to, occluder) == (expected > 0 && expected < 1));
        }
        hits += at > 0;
        blocked += expected > 0 && expected < 1;
    }
    CHECK(hits > 500);
    CHECK(blocked > 200);
    uint32_t none = 0;
    CHECK(RayScene({}).nearestHit({0, 0, 0}, {0, 0, 1}, 0) < 0);
    CHECK_FALSE(RayScene({}).isBlocked({0, 0, 0}, {0, 0, 1}, none));
}

TEST_CASE("the cheapest cut is found") {
    std::mt19937 random(9);
    for (int round = 0; round < 50; ++round) {
        constexpr uint32_t kNodes = 9; // source, sink and seven more: 128 cuts to try
        std::vector<std::array<float, kNodes>> capacity(kNodes);
        MinCut cut(kNodes);
        for (uint32_t a = 0; a < kNodes; ++a) {
            for (uint32_t b = std::max(a + 1, 2u); b < kNodes; ++b) {
                if (random() % 3 == 0) continue;
                const auto c = float(1 + random() % 16);
                capacity[a][b] = capacity[b][a] = c;
                cut.addEdge(a, b, c);
            }
        }
        const auto costOf = [&](uint32_t mask) { // bit n: node n on the source's side
            float sum = 0;
            for (uint32_t a = 0; a < kNodes; ++a) {
                for (uint32_t b = a + 1; b < kNodes; ++b)
                    sum += (mask >> a & 1) != (mask >> b & 1) ? capacity[a][b] : 0;
            }
            return sum;
        };
        float least = 1e9f;
        for (uint32_t rest = 0; rest < 1u << (kNodes - 2); ++rest) least = std::min(least, costOf(1 | rest << 2));
        const std::vector<uint8_t> side = cut.run();
        uint32_t mask = 0;
        for (uint32_t n = 0; n < kNodes; ++n) mask |= uint32_t(side[n]) << n;
        CHECK(costOf(mask) == least);
        CHECK((mask & 3) == 1);
    }
}

TEST_CASE("the nearest position is the one that a look at all finds") {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> coordinate(0, 9); // many equal ones
    const auto point = [&] { return glm::vec3(coordinate(random), coordinate(random), coordinate(random)); };
    std::vector<glm::vec3> positions(500);
    for (glm::vec3& p : positions) p = point();
    std::vector<uint32_t> chosen;
    for (uint32_t i = 0; i < positions.size(); i += 2) chosen.push_back(i);
    const NearestPosition nearest(positions, chosen);
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 at = point() + 0.25f;
        uint32_t best = chosen[0];
        for (const uint32_t c : chosen) {
            const glm::dvec3 d(positions[c] - at), least(positions[best] - at);
            if (glm::dot(d, d) < glm::dot(least, least)) best = c;
        }
        CHECK(nearest.of(at) == best);
    }
}

TEST_CASE("split triangles cover what they came from, edge to edge") {
    const Welded w = weldedWithTopology(test::cube(1));
    const LinkedFaces linked = linkFaces(w.mesh, w.topology);
    PieceScratch scratch = {std::vector<uint32_t>(w.mesh.positions.size(), bake::kNone),
                            std::vector<uint32_t>(w.mesh.faces.size(), bake::kNone)};
    const std::vector<double> areas(12, 0.5);
    const Piece piece = extractPiece(w.mesh, linked, linked.componentFaces, areas, 6, scratch);
    const Piece fine = splitLongEdges(piece, 500);
    CHECK(fine.triangleCount() >= 500);
    std::vector<double> area(12, 0.0);
    for (uint32_t t = 0; t < fine.triangleCount(); ++t) {
        const glm::uvec3 c = fine.triangles[t];
        const glm::dvec3 a(fine.positions[c.x]), b(fine.positions[c.y]), d(fine.positions[c.z]);
        area[fine.face[t]] += 0.5 * glm::length(glm::cross(b - a, d - a));
        for (int k = 0; k < 3; ++k) { // the neighbour has the same edge, the other way round
            const uint32_t g = fine.neighbours[t][k];
            REQUIRE(g != bake::kNone);
            bool found = false;
            for (int j = 0; j < 3; ++j) {
                found |= fine.triangles[g][j] == c[(k + 1) % 3] && fine.triangles[g][(j + 1) % 3] == c[k] &&
                         fine.neighbours[g][j] == t;
            }
            CHECK(found);
        }
    }
    for (const double a : area) CHECK(a == doctest::Approx(1.0 / 12).epsilon(1e-4));
}

TEST_CASE("convex and flat bodies are one part") {
    CHECK(partsOf(test::cube(1)).partCount() == 1);
    CHECK(partsOf(test::cube(30)).partCount() == 1);
    CHECK(partsOf(test::sphere(24)).partCount() == 1);
    CHECK(partsOf(test::grid(1)).partCount() == 1);
    CHECK(partsOf(test::grid(40)).partCount() == 1);
    CHECK(partsOf(test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})).partCount() == 1);
    const Model tetrahedron =
        test::modelOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
    CHECK(partsOf(tetrahedron).partCount() == 1);
}

TEST_CASE("a mesh without area is one part") {
    CHECK(partsOf(test::modelOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}})).partCount() == 1);
}

TEST_CASE("each arm of a ball is a part, and the ball") {
    const Model model = ballWithArms(40, kFourArms);
    const Welded w = weldedWithTopology(model);
    const Segmentation parts = partsOf(w);
    checkLabels(w, parts);
    CHECK(parts.partCount() == 5);
    std::set<uint32_t> tips; // the faces farthest out
    for (const glm::vec3& arm : kFourArms) {
        uint32_t tip = 0;
        for (uint32_t f = 0; f < w.mesh.faceCount(); ++f) {
            const auto out = [&](uint32_t g) { return glm::dot(w.mesh.positions[w.mesh.facePositions(g).x], arm); };
            if (out(f) > out(tip)) tip = f;
        }
        tips.insert(parts.facePart[tip]);
    }
    CHECK(tips.size() == 4);
    CHECK_FALSE(tips.contains(0)); // the largest is the ball
}

TEST_CASE("separate bodies are parts; crumbs go with what they lie nearest to") {
    const Model cube = test::cube(4);
    const std::vector<Model> table = {placed(cube, {4, 4, 0.2f}, {0, 0, 0}), placed(cube, {0.3f, 0.3f, 3}, {1, 1, -2}),
                                      placed(cube, {0.3f, 0.3f, 3}, {-1, 1, -2}),
                                      placed(cube, {0.3f, 0.3f, 3}, {1, -1, -2}),
                                      placed(cube, {0.3f, 0.3f, 3}, {-1, -1, -2})};
    CHECK(partsOf(joined(table)).partCount() == 5);

    std::vector<Model> withCrumb = table;
    withCrumb.push_back(placed(cube, glm::vec3(0.01f), {1, 1, -3.6f})); // below the second leg
    const Welded w = weldedWithTopology(joined(withCrumb));
    const Segmentation parts = partsOf(w);
    CHECK(parts.partCount() == 5);
    CHECK(parts.facePart.back() == parts.facePart[12 * 16 + 5]);
}

TEST_CASE("nothing but crumbs is one part") {
    std::vector<Model> dust;
    for (int i = 0; i < 600; ++i) dust.push_back(placed(test::cube(1), glm::vec3(0.1f), {float(i), float(i % 7), 0}));
    CHECK(partsOf(joined(dust)).partCount() == 1);
}

TEST_CASE("winding, doubled faces and seams do not matter") {
    const Model model = ballWithArms(30, kFourArms);
    const Segmentation parts = partsOf(model);
    REQUIRE(parts.partCount() == 5);

    Model mixed = model;
    std::mt19937 random(1);
    for (glm::uvec3& t : mixed.triangles) {
        if (random() % 2) std::swap(t.x, t.y);
    }
    CHECK(randIndexError(partsOf(mixed).facePart, parts.facePart) < 0.02);

    std::vector<glm::uvec3> both = model.triangles;
    for (const glm::uvec3& t : model.triangles) both.emplace_back(t.x, t.z, t.y);
    const Segmentation doubled = partsOf(test::modelOf(model.positions, both));
    const size_t half = model.triangles.size();
    CHECK(randIndexError(std::span(doubled.facePart).first(half), parts.facePart) < 0.02);
    for (size_t f = 0; f < half; ++f) REQUIRE(doubled.facePart[f] == doubled.facePart[f + half]);

    std::vector<glm::vec3> soup;
    std::vector<glm::uvec3> loose;
    for (const glm::uvec3& t : model.triangles) {
        const auto base = uint32_t(soup.size());
        for (int k = 0; k < 3; ++k) soup.push_back(model.positions[t[k]]);
        loose.emplace_back(base, base + 1, base + 2);
    }
    CHECK(partsOf(test::modelOf(soup, loose)).facePart == parts.facePart);
}

TEST_CASE("an edge of many faces does not break a body") {
    Model model = ballWithArms(30, kFourArms);
    const glm::uvec3 t = model.triangles[100];
    for (const glm::vec3& fin : {glm::vec3(3, 3, 3), glm::vec3(3, -3, 3)}) {
        model.positions.push_back(fin * 0.4f);
        model.triangles.emplace_back(t.x, t.y, uint32_t(model.positions.size()) - 1);
    }
    const Welded w = weldedWithTopology(test::modelOf(model.positions, model.triangles));
    const Segmentation parts = partsOf(w);
    checkLabels(w, parts);
    CHECK(parts.partCount() >= 5);
    CHECK(parts.partCount() <= 7);
}

TEST_CASE("scaling by a power of two changes nothing, and threads do not") {
    const Welded w = weldedWithTopology(makeModel(BundledModel::creature, 9000));
    const Segmentation parts = partsOf(w);
    checkLabels(w, parts);
    Welded large = w;
    for (glm::vec3& p : large.mesh.positions) p *= 1024.0f;
    CHECK(partsOf(large).facePart == parts.facePart);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(partsOf(w).facePart == parts.facePart);
}

TEST_CASE("how a mesh lies in space and the order of its faces hardly matter") {
    const Welded w = weldedWithTopology(makeModel(BundledModel::creature, 9000));
    const uint32_t count = w.mesh.faceCount();
    Welded changed = w;
    for (glm::vec3& p : changed.mesh.positions)
        p = 3.0f * glm::vec3(-0.6f * p.y + 0.8f * p.z, p.x, 0.8f * p.y + 0.6f * p.z) + glm::vec3(1, 2, 3);
    for (uint32_t f = 0; f < count / 2; ++f) std::swap(changed.mesh.faces[f], changed.mesh.faces[count - 1 - f]);
    changed.topology = buildTopology(changed.mesh);
    const std::vector<uint32_t> before = partsOf(w).facePart, after = partsOf(changed).facePart;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> both; // faces per pair of parts
    std::map<uint32_t, uint32_t> most;                      // of them, per part
    for (uint32_t f = 0; f < count; ++f) ++both[{before[f], after[count - 1 - f]}];
    for (const auto& [pair, faces] : both) most[pair.first] = std::max(most[pair.first], faces);
    uint32_t alike = 0;
    for (const auto& [part, faces] : most) alike += faces;
    CHECK(most.size() == partsOf(changed).partCount());
    CHECK(alike > count * 97 / 100);
}

TEST_CASE("the bundled models fall into sensible parts") {
    const std::map<BundledModel, std::pair<uint32_t, uint32_t>> kCounts = {{BundledModel::creature, {10, 40}},
                                                                           {BundledModel::shaft, {3, 40}},
                                                                           {BundledModel::terrain, {1, 80}},
                                                                           {BundledModel::temple, {20, 500}},
                                                                           {BundledModel::tree, {1, 100}}};
    for (const auto& [which, range] : kCounts) {
        const Welded w = weldedWithTopology(makeModel(which, 8000));
        const Segmentation parts = partsOf(w);
        checkLabels(w, parts);
        CHECK(parts.partCount() >= range.first);
        CHECK(parts.partCount() <= range.second);
        CHECK(looseSets(w, parts) == 0);
    }
}

TEST_CASE("contours of very fine meshes leave every part connected") {
    for (const BundledModel which : {BundledModel::creature, BundledModel::terrain}) {
        const Welded w = weldedWithTopology(makeModel(which, 60000)); // more faces than cells
        const PerceptualSegmenter segmenter(w.mesh, w.topology);
        REQUIRE(segmenter.trace().front().cells < segmenter.trace().front().faces);
        for (const float detail : {1.0f, 0.5f, 2.0f}) {
            const Segmentation parts = segmenter.parts({0, detail});
            checkLabels(w, parts);
            CHECK(looseSets(w, parts) == 0);
        }
    }
}

TEST_CASE("as many parts as asked for") {
    const Welded ball = weldedWithTopology(ballWithArms(30, kFourArms)),
                 creature = weldedWithTopology(makeModel(BundledModel::creature, 9000));
    const PerceptualSegmenter ballSegmenter(ball.mesh, ball.topology),
        creatureSegmenter(creature.mesh, creature.topology);
    for (uint32_t count = 1; count <= 40; ++count) {
        CHECK(ballSegmenter.parts({count, 1}).partCount() == count);
        const Segmentation parts = creatureSegmenter.parts({count, 1});
        checkLabels(creature, parts);
        CHECK(parts.partCount() == std::max(count, creature.topology.componentCount));
    }
}

TEST_CASE("less detail joins the default's parts, more splits them") {
    for (const BundledModel which : {BundledModel::creature, BundledModel::temple}) {
        const Welded w = weldedWithTopology(makeModel(which, 9000));
        const PerceptualSegmenter segmenter(w.mesh, w.topology);
        const Segmentation parts = segmenter.parts({});
        uint32_t before = 0;
        for (const float detail : {0.1f, 0.3f, 0.6f, 1.5f, 3.0f}) {
            const Segmentation other = segmenter.parts({0, detail});
            checkLabels(w, other);
            INFO(int(which), " at detail ", detail);
            CHECK((detail < 1 ? liesWithin(parts, other) : liesWithin(other, parts)));
            CHECK(other.partCount() >= before);
            CHECK((detail < 1 ? other.partCount() <= parts.partCount() : other.partCount() > parts.partCount()));
            before = other.partCount();
        }
    }
}

TEST_CASE("merges join neighbours down to the separate pieces, the dearest last") {
    const Welded w = weldedWithTopology(makeModel(BundledModel::creature, 9000));
    const PerceptualSegmenter segmenter(w.mesh, w.topology);
    for (const Segmentation& parts :
         {segmenter.parts({}), segmentByComponent(w.mesh, w.topology), segmentNone(w.mesh)}) {
        const std::vector<PartMerge> merges = segmenter.merges(parts);
        std::set<uint32_t> left;
        for (uint32_t p = 0; p < parts.partCount(); ++p) left.insert(p);
        for (const PartMerge& merge : merges) {
            CHECK(merge.a < merge.b);
            CHECK(left.contains(merge.a));
            CHECK(left.erase(merge.b) == 1);
            CHECK(merge.cost >= 0);
        }
        CHECK(left.size() <= w.topology.componentCount);
    }
}

TEST_CASE("real meshes: connected parts, far better than chance against people") {
    const std::filesystem::path data = test::dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        MESSAGE("SKIPPED: real meshes (no XGC_DATA)");
        return;
    }
    double error = 0;
    const std::vector<uint32_t> kModels = {1, 81, 121, 161, 241, 281, 381};
    for (const uint32_t n : kModels) {
        const Welded w = weldedWithTopology(test::readOff(data / "psb" / "off" / fmt::format("{}.off", n)));
        const Segmentation parts = partsOf(w);
        checkLabels(w, parts);
        CHECK(looseSets(w, parts) == 0);
        std::vector<uint32_t> people;
        REQUIRE(readSegFile(data / "psb" / "seg" / std::to_string(n) / fmt::format("{}_0.seg", n),
                            w.mesh.inputFaceCount, people)
                    .ok());
        error += randIndexError(inputLabels(w.mesh, parts), people) / double(kModels.size());
    }
    CHECK(error < 0.1);
}

TEST_CASE("real meshes: any number of threads gives the same parts") {
    const std::filesystem::path data = test::dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        MESSAGE("SKIPPED: real meshes (no XGC_DATA)");
        return;
    }
    for (const uint32_t n : {21u, 121u, 241u, 381u}) {
        const Welded w = weldedWithTopology(test::readOff(data / "psb" / "off" / fmt::format("{}.off", n)));
        std::vector<uint32_t> first;
        for (const int threads : {1, 2, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
            tbb::task_arena arena(threads);
            const Segmentation parts = arena.execute([&] { return partsOf(w); });
            if (threads == 1) first = parts.facePart;
            CHECK(parts.facePart == first);
        }
    }
}
