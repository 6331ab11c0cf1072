#include "comparison.h"

#include "peers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace xgc::bench {
namespace {

constexpr uint32_t kAttributeSamples = 50'000;

/// The level with the count nearest to `faces`, or none within a third of it.
uint32_t nearestLevel(const std::vector<uint32_t>& counts, double faces) {
    constexpr double kFarthest = 1.34;
    const auto distance = [&](uint32_t level) { return std::abs(std::log(std::max(counts[level], 1u) / faces)); };
    uint32_t best = 0;
    for (uint32_t level = 1; level < counts.size(); ++level) {
        if (distance(level) < distance(best)) best = level;
    }
    return distance(best) < std::log(kFarthest) ? best : bake::kNone;
}

Quality qualityOf(const DistanceReference& reference, const Surface& surface, bool attributes) {
    const TwoSided d = reference.compare(surface);
    const double size = reference.diagonal();
    Quality q{surface.faceCount(), d.rms() / size, d.max() / size, {}};
    if (attributes) {
        q.attributes = compareAttributes(reference.surface(), surface, kAttributeSamples);
        q.attributes.uvRms /= size;
    }
    return q;
}

} // namespace

bool Comparison::equalFaces() const {
    const double difference = std::abs(double(ours.faces) - double(theirs.faces));
    return difference <= std::max(2.0, 0.01 * ours.faces);
}

std::vector<Comparison> compareLevels(const Flags& flags, const Subject& subject, const bake::HierarchyOptions& options,
                                      bool attributes) {
    const bake::Hierarchy hierarchy = build(subject, subject.parts, options);
    const std::vector<uint32_t> counts = uniformFaces(subject.mesh, hierarchy);
    const DistanceReference reference(surfaceOf(subject.mesh));
    const Peers peers(flags, subject.name, reference.surface());
    std::vector<Comparison> all;
    for (const double target : kTargets) {
        const uint32_t level = nearestLevel(counts, target / 100 * subject.mesh.faceCount());
        if (level == bake::kNone || level == 0) continue;
        const Quality ours = qualityOf(reference, surfaceAt(subject.mesh, hierarchy, level), attributes);
        for (const Peer& peer : peers.at(counts[level])) {
            const Quality theirs = qualityOf(reference, peer.surface, attributes);
            all.push_back({subject.name, target, level, ours, peer.program, theirs});
        }
    }
    return all;
}

Ratios ratiosOf(const std::vector<Comparison>& all, double (*figure)(const Quality&)) {
    Ratios ratios;
    for (const Comparison& c : all) {
        const double theirs = figure(c.theirs);
        if (c.equalFaces() && theirs > 0) ratios[c.program][c.target].push_back(figure(c.ours) / theirs);
    }
    return ratios;
}

void printRatios(const std::string& title, const Ratios& ratios) {
    fmt::print("\n{:<36}", title);
    for (const double target : kTargets) fmt::print("{:>8} %", target);
    fmt::print("\n");
    for (const auto& entry : ratios) {
        const std::map<double, std::vector<double>, std::greater<>>& byTarget = entry.second;
        const auto line = [&](const std::string& name, auto&& cell) {
            fmt::print("{:<36}", name);
            for (const double target : kTargets) {
                const auto found = byTarget.find(target);
                fmt::print("{:>10}", found == byTarget.end() ? "-" : cell(found->second));
            }
            fmt::print("\n");
        };
        line(entry.first, [](const std::vector<double>& v) { return fmt::format("{:.3f}", median(v)); });
        line("  worst", [](const std::vector<double>& v) { return fmt::format("{:.2f}", std::ranges::max(v)); });
        line("  models", [](const std::vector<double>& v) { return std::to_string(v.size()); });
    }
}

} // namespace xgc::bench
