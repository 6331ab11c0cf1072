#include "expanded.h"
#include "nearest.h"

#include <xgc/bake/verify.h>
#include <xgc/indices.h>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <numeric>

namespace xgc::bake {
namespace {

constexpr double kPromiseMargin = 1.05;

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t next() {
        uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    uint32_t below(uint32_t n) { return uint32_t((next() >> 32) * n >> 32); }
    double unit() { return double(next() >> 11) * 0x1p-53; }

private:
    uint64_t state_;
};

/// The uniform states come first; then random ones: all levels, only the ends, or one patch apart from the rest.
std::vector<uint8_t> stateLevels(const AssetView& asset, uint64_t seed, uint32_t index) {
    const uint32_t levelCount = asset.levelCount(), patchCount = asset.patchCount();
    std::vector<uint8_t> levels(patchCount, uint8_t(std::min(index, levelCount - 1)));
    if (index < levelCount) return levels;
    Random random(seed * 0x9e3779b97f4a7c15u + index);
    const uint32_t kind = index % 4;
    const uint32_t rest = random.below(levelCount);
    for (uint8_t& level : levels) {
        level = uint8_t(kind == 0   ? (random.below(2) ? levelCount - 1 : 0)
                        : kind == 1 ? rest
                                    : random.below(levelCount));
    }
    if (kind == 1) levels[random.below(patchCount)] = uint8_t(random.below(levelCount));
    return levels;
}

/// A triangle with its smallest row first, so that equal ones compare equal.
glm::uvec3 rotated(glm::uvec3 t) {
    while (t.x > t.y || t.x > t.z) t = {t.y, t.z, t.x};
    return t;
}

bool lessTriangle(const glm::uvec3& a, const glm::uvec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

void sortTriangles(std::vector<glm::uvec3>& triangles) {
    for (glm::uvec3& t : triangles) t = rotated(t);
    std::sort(triangles.begin(), triangles.end(), lessTriangle);
}

/// Triangles in one sorted list but not in the other.
uint64_t differing(const std::vector<glm::uvec3>& a, const std::vector<glm::uvec3>& b) {
    std::vector<glm::uvec3> difference;
    std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(difference), lessTriangle);
    return difference.size();
}

/// One state, drawn by the runtime and by definition.
struct State {
    std::vector<uint8_t> levels;
    std::vector<uint32_t> rep;
    std::vector<glm::uvec3> drawn; ///< by buildIndices
    std::vector<glm::uvec3> solid; ///< by definition, not degenerate
    std::vector<uint32_t> solidFace;
    uint64_t miscounted = 0; ///< patches that draw more triangles than triangleBound, or other than uniformTriangles
};

class Checker {
public:
    Checker(const AssetView& asset, const VerifyOptions& options) : asset_(asset), options_(options), expanded_(asset) {
        for (const glm::uvec3& f : expanded_.faces) baseNormals_.push_back(normal(f));
    }

    void check(uint32_t index, VerifyReport& report) const {
        const State state = makeState(index);
        ++report.states;
        report.faces += state.drawn.size();
        report.miscounted += state.miscounted;
        checkDrawn(state, report);
        checkFlips(state, report);
        checkEdges(state, report);
        if (index < options_.errorStates) checkErrors(state, index, report);
    }

    /// E over the largest sampled deviation of each patch that deviates in the uniform state of a level.
    std::vector<double> tightness(uint32_t level) const {
        const State state = makeState(level);
        std::vector<double> largest(asset_.patchCount(), 0.0);
        std::vector<uint32_t> all(expanded_.faces.size());
        std::iota(all.begin(), all.end(), 0u);
        Random random(options_.seed + level);
        sampleLargest(state.solid, state.solidFace, *base_, random, largest);
        sampleLargest(expanded_.faces, all, *surface(state.solid), random, largest);
        std::vector<double> ratios;
        for (uint32_t p = 0; p < largest.size(); ++p) {
            if (largest[p] > 1e-6 * asset_.record->sphereRadius) ratios.push_back(asset_.error(p, level) / largest[p]);
        }
        return ratios;
    }

    void checkMonotone(VerifyReport& report) const {
        for (uint32_t p = 0; p < asset_.patchCount(); ++p) {
            for (uint32_t l = 1; l < asset_.levelCount(); ++l) {
                report.fallingErrors += asset_.error(p, l) < asset_.error(p, l - 1);
            }
        }
    }

    void prepareErrors() { base_ = surface(expanded_.faces); }

private:
    glm::dvec3 normal(const glm::uvec3& t) const {
        const glm::dvec3 a(asset_.positions[t.x]), b(asset_.positions[t.y]), c(asset_.positions[t.z]);
        return glm::cross(b - a, c - a);
    }

    std::unique_ptr<Nearest> surface(const std::vector<glm::uvec3>& triangles) const {
        return std::make_unique<Nearest>(std::vector<glm::vec3>(asset_.positions.begin(), asset_.positions.end()),
                                         triangles);
    }

    glm::uvec3 points(const glm::uvec3& t) const {
        return {expanded_.point[t.x], expanded_.point[t.y], expanded_.point[t.z]};
    }

    State makeState(uint32_t index) const {
        State state;
        state.levels = stateLevels(asset_, options_.seed, index);
        state.rep = representatives(asset_, expanded_, state.levels);
        std::vector<uint32_t> scratch(scratchCapacity(asset_)), out;
        const bool uniform =
            !asset_.patchFaceCounts.empty() &&
            std::adjacent_find(state.levels.begin(), state.levels.end(), std::not_equal_to<>()) == state.levels.end();
        for (uint32_t p = 0; p < asset_.patchCount(); ++p) {
            out.resize(indexCapacity(asset_, p, state.levels));
            const uint32_t count = buildIndices(asset_, p, state.levels, scratch, out);
            const uint32_t bound = triangleBound(asset_, p, state.levels);
            state.miscounted += uniform ? count / 3 != bound : count / 3 > bound;
            for (uint32_t i = 0; i + 2 < count; i += 3) state.drawn.emplace_back(out[i], out[i + 1], out[i + 2]);
        }
        for (uint32_t f = 0; f < expanded_.faces.size(); ++f) {
            const glm::uvec3 face = expanded_.faces[f];
            const glm::uvec3 t(state.rep[face.x], state.rep[face.y], state.rep[face.z]);
            if (t.x == t.y || t.y == t.z || t.z == t.x) continue;
            state.solid.push_back(t);
            state.solidFace.push_back(f);
        }
        return state;
    }

    void checkDrawn(const State& state, VerifyReport& report) const {
        std::vector<glm::uvec3> drawn = state.drawn, solid = state.solid;
        sortTriangles(drawn);
        sortTriangles(solid);
        report.mismatches += differing(drawn, solid);
        for (const glm::uvec3& t : state.drawn) {
            const glm::uvec3 p = points(t);
            report.degenerate += p.x == p.y || p.y == p.z || p.z == p.x;
        }
    }

    void checkFlips(const State& state, VerifyReport& report) const {
        for (size_t i = 0; i < state.solid.size(); ++i) {
            report.flips += glm::dot(normal(state.solid[i]), baseNormals_[state.solidFace[i]]) < 0;
        }
    }

    /// The borders of a state are the image of the borders of level 0, edge for edge, modulo two.
    void checkEdges(const State& state, VerifyReport& report) const {
        std::vector<glm::uvec3> triangles;
        for (const glm::uvec3& t : state.drawn) triangles.push_back(points(t));
        std::vector<uint64_t> odd, expected;
        for (const EdgeUse& e : countEdges(triangles)) {
            if (e.uses % 2)
                odd.push_back(e.edge);
            else
                report.fourUseEdges += e.uses >= 4;
        }
        for (const glm::uvec2& b : expanded_.borders) {
            const uint32_t p = expanded_.point[state.rep[b.x]], q = expanded_.point[state.rep[b.y]];
            if (p != q) expected.push_back(edgeKey(p, q));
        }
        std::sort(expected.begin(), expected.end());
        std::vector<uint64_t> image;
        for (size_t i = 0; i < expected.size();) {
            size_t j = i;
            while (j < expected.size() && expected[j] == expected[i]) ++j;
            if ((j - i) % 2) image.push_back(expected[i]);
            i = j;
        }
        std::vector<uint64_t> difference;
        std::set_symmetric_difference(odd.begin(), odd.end(), image.begin(), image.end(),
                                      std::back_inserter(difference));
        report.oddEdges += difference.size();
    }

    double promise(const State& state, uint32_t patch) const {
        float largest = 0;
        for (const uint32_t q : expanded_.adjacentPatches[patch]) {
            largest = std::max(largest, asset_.error(q, state.levels[q]));
        }
        return largest * kPromiseMargin;
    }

    /// Random points of the triangles against the other surface. Triangles are drawn at random, by number and not by
    /// area: small ones, where detail is, count as much.
    void sampleError(const State& state, const std::vector<glm::uvec3>& triangles, const std::vector<uint32_t>& face,
                     const Nearest& other, Random& random, VerifyReport& report) const {
        if (triangles.empty()) return;
        const double slack = 1e-6 * asset_.record->sphereRadius; // float coordinates of the samples
        for (uint32_t i = 0; i < options_.errorSamples; ++i) {
            const uint32_t k = random.below(uint32_t(triangles.size()));
            double u = random.unit(), v = random.unit();
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const glm::uvec3 t = triangles[k];
            const glm::dvec3 a(asset_.positions[t.x]), b(asset_.positions[t.y]), c(asset_.positions[t.z]);
            const double distance = other.distance(glm::vec3(a + u * (b - a) + v * (c - a)));
            const double allowed = promise(state, expanded_.facePatch[face[k]]) + slack;
            ++report.errorSamples;
            report.errorViolations += distance > allowed;
            report.worstErrorRatio = std::max(report.worstErrorRatio, distance / allowed);
        }
    }

    /// Points of random triangles of each patch, inside, on edges and at corners, against the other surface.
    void sampleLargest(const std::vector<glm::uvec3>& triangles, const std::vector<uint32_t>& face,
                       const Nearest& other, Random& random, std::vector<double>& largest) const {
        std::vector<std::vector<uint32_t>> ofPatch(asset_.patchCount());
        for (uint32_t i = 0; i < face.size(); ++i) ofPatch[expanded_.facePatch[face[i]]].push_back(i);
        for (uint32_t p = 0; p < ofPatch.size(); ++p) {
            const uint32_t samples = ofPatch[p].empty() || triangles.empty() ? 0 : options_.tightnessSamples;
            for (uint32_t i = 0; i < samples; ++i) {
                const glm::uvec3 t = triangles[ofPatch[p][random.below(uint32_t(ofPatch[p].size()))]];
                double u = random.unit(), v = random.unit();
                if (u + v > 1) u = 1 - u, v = 1 - v;
                if (i % 3 == 1) u = 0;
                if (i % 3 == 2) u = v = 0;
                const glm::dvec3 a(asset_.positions[t.x]), b(asset_.positions[t.y]), c(asset_.positions[t.z]);
                const double distance = other.distance(glm::vec3(a + u * (b - a) + v * (c - a)));
                if (std::isfinite(distance)) largest[p] = std::max(largest[p], distance);
            }
        }
    }

    void checkErrors(const State& state, uint32_t index, VerifyReport& report) const {
        Random random(options_.seed + index);
        sampleError(state, state.solid, state.solidFace, *base_, random, report);
        std::vector<uint32_t> all(expanded_.faces.size());
        for (uint32_t f = 0; f < all.size(); ++f) all[f] = f;
        sampleError(state, expanded_.faces, all, *surface(state.solid), random, report);
    }

    const AssetView& asset_;
    const VerifyOptions& options_;
    const Expanded expanded_;
    std::vector<glm::dvec3> baseNormals_;
    std::unique_ptr<Nearest> base_;
};

void add(VerifyReport& sum, const VerifyReport& r) {
    sum.states += r.states;
    sum.faces += r.faces;
    sum.mismatches += r.mismatches;
    sum.miscounted += r.miscounted;
    sum.degenerate += r.degenerate;
    sum.flips += r.flips;
    sum.oddEdges += r.oddEdges;
    sum.fourUseEdges += r.fourUseEdges;
    sum.errorSamples += r.errorSamples;
    sum.errorViolations += r.errorViolations;
    sum.worstErrorRatio = std::max(sum.worstErrorRatio, r.worstErrorRatio);
}

double medianTightness(const Checker& checker, uint32_t levelCount) {
    std::vector<std::vector<double>> ofLevel(levelCount);
    tbb::parallel_for(uint32_t(1), levelCount, [&](uint32_t level) { ofLevel[level] = checker.tightness(level); });
    std::vector<double> all;
    for (const std::vector<double>& ratios : ofLevel) all.insert(all.end(), ratios.begin(), ratios.end());
    if (all.empty()) return 0;
    const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
}

} // namespace

bool VerifyReport::ok() const {
    return mismatches == 0 && miscounted == 0 && degenerate == 0 && flips == 0 && oddEdges == 0 && fallingErrors == 0 &&
           sourceMismatches == 0 && errorViolations * 10000 <= errorSamples && worstErrorRatio <= kPromiseMargin;
}

void verifyAsset(const AssetView& asset, const VerifyOptions& options, VerifyReport& report) {
    Checker checker(asset, options);
    checker.checkMonotone(report);
    if (options.errorStates > 0 || options.tightnessSamples > 0) checker.prepareErrors();
    const uint32_t count = asset.levelCount() + options.states;
    tbb::enumerable_thread_specific<VerifyReport> partial;
    std::mutex mutex;
    uint32_t finished = 0;
    tbb::parallel_for(uint32_t(0), count, [&](uint32_t index) {
        checker.check(index, partial.local());
        if (!options.progress) return;
        const std::lock_guard lock(mutex);
        options.progress(double(++finished) / count);
    });
    for (const VerifyReport& r : partial) add(report, r);
    if (options.tightnessSamples > 0) report.errorTightness = medianTightness(checker, asset.levelCount());
}

void verifySource(const AssetView& asset, const Mesh& source, VerifyReport& report) {
    // Both meshes get point ids from one pool of positions.
    std::vector<glm::vec3> positions(asset.positions.begin(), asset.positions.end());
    positions.insert(positions.end(), source.positions.begin(), source.positions.end());
    const Expanded expanded(asset);
    const std::vector<uint32_t> ids = pointIds(positions);
    std::vector<glm::uvec3> ours, theirs;
    for (const glm::uvec3& f : expanded.faces) ours.emplace_back(ids[f.x], ids[f.y], ids[f.z]);
    const auto offset = uint32_t(asset.positions.size());
    for (uint32_t f = 0; f < source.faceCount(); ++f) {
        const glm::uvec3 p = source.facePositions(f) + offset;
        theirs.emplace_back(ids[p.x], ids[p.y], ids[p.z]);
    }
    sortTriangles(ours);
    sortTriangles(theirs);
    report.sourceMismatches += differing(ours, theirs);
}

} // namespace xgc::bake
