#include "counted_allocations.h"
#include "meshes/baked_model.h"
#include "meshes/patched_torus.h"
#include "meshes/toy_asset.h"
#include "random.h"

#include <xgc/morph.h>
#include <xgc/select.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

namespace {

using namespace xgc;
using test::Random;

/// An asset and its table, under a name for messages.
struct Subject {
    std::string name;
    AssetView asset;
    std::vector<MorphRow> rows;
};

Subject subjectOf(const std::string& name, const std::string& failure, const AssetView& asset) {
    INFO(name << ": " << failure);
    REQUIRE(failure.empty());
    Subject s{name, asset, std::vector<MorphRow>(asset.record->vertexCount)};
    REQUIRE(morphRows(asset, s.rows).ok());
    return s;
}

const test::BakedModel& creature() {
    static const test::BakedModel model(bake::BundledModel::creature, 6000, 256);
    return model;
}

const std::vector<Subject>& subjects() {
    static const test::OpenAsset torus = test::openBuilt(test::patchedTorus({.patches = 4, .levels = 4}));
    static const test::BakedModel temple(bake::BundledModel::temple, 6000, 128);
    static const test::BakedModel optimal(bake::BundledModel::creature, 3000, 128, bake::Placement::optimal);
    static const std::vector<Subject> all = {
        subjectOf("toy", test::plain().error, test::plain().asset),
        subjectOf("toy with made vertices", test::withMadeVertices().error, test::withMadeVertices().asset),
        subjectOf("torus", torus.failure, torus.view),
        subjectOf("creature", creature().failure, creature().view),
        subjectOf("temple", temple.failure, temple.view),
        subjectOf("creature with made vertices", optimal.failure, optimal.view),
    };
    return all;
}

// States ------------------------------------------------------------------------------------------------------------

/// Levels near each other as well as far apart.
std::vector<uint8_t> randomLevels(const AssetView& asset, Random& random) {
    const uint32_t base = random.below(asset.levelCount()), spread = 1 + random.below(asset.levelCount());
    std::vector<uint8_t> levels(asset.patchCount());
    for (uint8_t& level : levels) level = uint8_t(std::min(base + random.below(spread), asset.levelCount() - 1));
    return levels;
}

/// Of patches at the coarsest level 0, as selection gives them.
std::vector<float> randomFractions(const AssetView& asset, Levels levels, Random& random) {
    std::vector<float> fractions(levels.size());
    for (size_t p = 0; p < levels.size(); ++p) {
        if (uint32_t(levels[p]) + 1 < asset.levelCount()) fractions[p] = random.between(0, 1) * kMaxFraction;
    }
    return fractions;
}

std::vector<float> lambdasOf(const AssetView& asset, Levels levels, std::span<const float> fractions = {}) {
    std::vector<float> lambdas(groupCount(asset));
    groupLambdas(asset, levels, fractions, lambdas);
    return lambdas;
}

/// The row of each slot of a patch, and the row that it is drawn as, by FORMAT.md section 4.
struct Slots {
    std::vector<uint32_t> row, drawn;
};

Slots slotsOf(const AssetView& asset, uint32_t patch, Levels levels) {
    const format::PatchRecord& record = asset.patches[patch];
    Slots slots;
    const auto add = [&](format::VertexRange range, uint32_t level) {
        for (uint32_t k = 0; k < range.count; ++k) {
            const size_t slot = slots.row.size(), at = record.firstParent + slot;
            const uint32_t row = range.first + k;
            const bool wide = record.flags & format::kWideSlots;
            slots.row.push_back(row);
            slots.drawn.push_back(asset.collapseLevels[row] > level
                                      ? row
                                      : slots.drawn[wide ? asset.parentsWide[at] : asset.parentsNarrow[at]]);
        }
    };
    for (const uint32_t domain : asset.domainsOf(patch)) {
        add(asset.domainRange(domain), domainLevel(asset, domain, levels));
    }
    add(asset.interiorRange(patch), levels[patch]);
    return slots;
}

struct Less {
    bool operator()(const glm::vec3& a, const glm::vec3& b) const {
        return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
    }
};

} // namespace

// The function ------------------------------------------------------------------------------------------------------

TEST_CASE("at whole lambdas every row is where the state has it") {
    for (const Subject& s : subjects()) {
        INFO(s.name);
        Random random(1);
        size_t wrong = 0, checked = 0;
        for (int i = 0; i < 20; ++i) {
            const std::vector<uint8_t> levels = randomLevels(s.asset, random);
            const std::vector<float> lambdas = lambdasOf(s.asset, levels);
            for (uint32_t p = 0; p < s.asset.patchCount(); ++p) {
                const Slots slots = slotsOf(s.asset, p, levels);
                for (size_t k = 0; k < slots.row.size(); ++k) {
                    const MorphBlend blend = morph(s.rows, lambdas, slots.row[k]);
                    wrong += blend.count != 1 || blend.rows[0] != slots.drawn[k] || blend.weights[0] != 1;
                    ++checked;
                }
            }
        }
        CHECK(wrong == 0);
        CHECK(checked > 1000);
    }
}

TEST_CASE("a drawn row goes from its own place to that of the next state") {
    for (const Subject& s : subjects()) {
        INFO(s.name);
        Random random(2);
        size_t wrongStart = 0, wrongEnd = 0, far = 0, moved = 0;
        for (int i = 0; i < 20; ++i) {
            const std::vector<uint8_t> from = randomLevels(s.asset, random);
            std::vector<uint8_t> to = from;
            std::vector<float> fractions(from.size());
            for (size_t p = 0; p < to.size(); ++p) {
                if (random.below(3) == 0 || uint32_t(to[p]) + 1 == s.asset.levelCount()) continue;
                ++to[p];
                fractions[p] = kMaxFraction;
            }
            const auto start = lambdasOf(s.asset, from), end = lambdasOf(s.asset, to),
                       nearly = lambdasOf(s.asset, from, fractions);
            for (uint32_t p = 0; p < s.asset.patchCount(); ++p) {
                const Slots before = slotsOf(s.asset, p, from), after = slotsOf(s.asset, p, to);
                for (size_t k = 0; k < before.row.size(); ++k) {
                    const uint32_t row = before.drawn[k];
                    const glm::vec3 is = s.asset.positions[row], becomes = s.asset.positions[after.drawn[k]];
                    wrongStart += morphedPosition(s.asset, s.rows, start, row) != is;
                    wrongEnd += morphedPosition(s.asset, s.rows, end, row) != becomes;
                    const float left = glm::length(morphedPosition(s.asset, s.rows, nearly, row) - becomes);
                    far += left > 2 * (1 - kMaxFraction) * morphSpeed(s.asset, s.rows, row) +
                                      1e-6f * s.asset.record->sphereRadius;
                    moved += is != becomes;
                }
            }
        }
        CHECK(wrongStart == 0);
        CHECK(wrongEnd == 0);
        CHECK(far == 0);
        CHECK(moved > 100);
    }
}

TEST_CASE("corners of one place stay together, whatever patch draws them and whatever the lambdas") {
    for (const Subject& s : subjects()) {
        INFO(s.name);
        Random random(3);
        size_t apart = 0, shared = 0, blended = 0;
        // Every level is the finest one of some states, and near the others.
        for (uint32_t i = 0; i < 2 * s.asset.levelCount(); ++i) {
            std::vector<uint8_t> levels(s.asset.patchCount());
            const uint32_t spread = i % 2 ? s.asset.levelCount() : 2;
            for (uint8_t& level : levels)
                level = uint8_t(std::min(i / 2 + random.below(spread), s.asset.levelCount() - 1));
            const std::vector<float> fractions = randomFractions(s.asset, levels, random);
            const std::vector<float> lambdas = lambdasOf(s.asset, levels, fractions);
            std::map<glm::vec3, glm::vec3, Less> places;
            for (uint32_t p = 0; p < s.asset.patchCount(); ++p) {
                const Slots slots = slotsOf(s.asset, p, levels);
                for (size_t k = 0; k < slots.row.size(); ++k) {
                    if (!s.asset.birthLevels.empty() && s.asset.birthLevels[slots.row[k]] > 0) continue;
                    const glm::vec3 at = morphedPosition(s.asset, s.rows, lambdas, slots.drawn[k]);
                    blended += at != s.asset.positions[slots.drawn[k]];
                    const auto [known, isNew] = places.emplace(s.asset.positions[slots.row[k]], at);
                    shared += !isNew;
                    apart += known->second != at;
                }
            }
        }
        CHECK(apart == 0);
        CHECK(shared > 100);
        CHECK(blended > 100);
    }
}

TEST_CASE("weights are positive, add up to one and are as few as said") {
    for (const Subject& s : subjects()) {
        INFO(s.name);
        Random random(4);
        size_t wrong = 0, cut = 0;
        std::array<size_t, kMorphRows + 1> counts{};
        for (int i = 0; i < 20; ++i) {
            const std::vector<uint8_t> levels = randomLevels(s.asset, random);
            const std::vector<float> lambdas = lambdasOf(s.asset, levels, randomFractions(s.asset, levels, random));
            for (uint32_t row = 0; row < s.rows.size(); ++row) {
                const MorphBlend blend = morph(s.rows, lambdas, row);
                double sum = 0;
                for (uint32_t k = 0; k < blend.count; ++k) {
                    wrong += !(blend.weights[k] >= 0);
                    sum += double(blend.weights[k]);
                }
                wrong += std::abs(sum - 1) > 1e-6;
                ++counts[blend.count];
                // The last one would be on its way too.
                const MorphRow& last = s.rows[blend.rows[blend.count - 1]];
                cut += lambdas[last.group()] > float(last.collapseLevel()) - 1;
            }
        }
        std::string histogram;
        for (const size_t count : counts) histogram += std::to_string(count) + " ";
        INFO(histogram);
        CHECK(wrong == 0);
        CHECK(cut == 0);
    }
}

TEST_CASE("no row moves faster than its speed while lambdas change") {
    for (const Subject& s : subjects()) {
        INFO(s.name);
        Random random(5);
        size_t wrong = 0;
        float most = 0;
        for (int i = 0; i < 10; ++i) {
            std::vector<uint8_t> levels = randomLevels(s.asset, random);
            std::vector<float> fractions = randomFractions(s.asset, levels, random);
            std::vector<float> before = lambdasOf(s.asset, levels, fractions);
            for (int step = 0; step < 10; ++step) {
                constexpr float kRate = 0.125f;
                for (size_t p = 0; p < levels.size(); ++p) {
                    const float lambda =
                        std::clamp(float(levels[p]) + fractions[p] + (2 * random.between(0, 1) - 1) * kRate, 0.0f,
                                   float(s.asset.levelCount() - 1));
                    levels[p] = uint8_t(lambda);
                    fractions[p] = std::min(lambda - float(levels[p]), kMaxFraction);
                }
                const std::vector<float> after = lambdasOf(s.asset, levels, fractions);
                for (uint32_t row = 0; row < s.rows.size(); ++row) {
                    const uint32_t group = s.rows[row].group();
                    const float lambda = std::min(before[group], after[group]);
                    if (s.rows[row].collapseLevel() <= uint32_t(lambda)) continue; // drawn neither before nor after
                    const float moved = glm::length(morphedPosition(s.asset, s.rows, after, row) -
                                                    morphedPosition(s.asset, s.rows, before, row));
                    const float allowed = 1.001f * kRate * morphSpeed(s.asset, s.rows, row);
                    wrong += moved > allowed + 1e-6f * s.asset.record->sphereRadius;
                    if (allowed > 0) most = std::max(most, moved / allowed);
                }
                before = after;
            }
        }
        CHECK(wrong == 0);
        CHECK(most > 0.5f); // the bound is not idle
    }
}

TEST_CASE("neither the table nor the lambdas allocate") {
    const Subject& s = subjects().front();
    std::vector<MorphRow> rows(s.rows.size());
    std::vector<float> lambdas(groupCount(s.asset));
    const std::vector<uint8_t> levels(s.asset.patchCount());
    const uint64_t before = test::allocations;
    const Status status = morphRows(s.asset, rows);
    groupLambdas(s.asset, levels, {}, lambdas);
    CHECK(test::allocations == before);
    CHECK(status.ok());
}
