#include "builder.h"
#include "sections.h"
#include "subjects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace xgc::bench {
namespace {

constexpr double kRest = 0.01; ///< of the faces

struct Share {
    double drawn = 0; ///< triangles over the ideal
    double fraction = 0;
};

/// Each part in turn at level 0 with all others at `level`: triangles over the part's faces plus what the uniform
/// level draws of the others.
std::vector<Share> sharesOf(const Subject& subject, const bake::Hierarchy& h, uint32_t level) {
    const auto part = [&](uint32_t face) { return h.patches[h.facePatch[face]].part; };
    std::vector<uint32_t> fine(subject.parts.partCount()), coarse(subject.parts.partCount());
    for (uint32_t f = 0; f < subject.mesh.faceCount(); ++f) ++fine[part(f)];
    std::vector<uint8_t> levels(h.patchCount(), uint8_t(level));
    const auto uniform = bake::drawSurface(subject.mesh, h, levels);
    for (const uint32_t f : uniform.face) ++coarse[part(f)];
    std::vector<Share> shares;
    for (uint32_t p = 0; p < fine.size(); ++p) {
        for (uint32_t i = 0; i < levels.size(); ++i) levels[i] = h.patches[i].part == p ? 0 : uint8_t(level);
        const double ideal = fine[p] + double(uniform.face.size()) - coarse[p];
        const double drawn = double(bake::drawSurface(subject.mesh, h, levels).triangles.size());
        shares.push_back({drawn / ideal, double(fine[p]) / subject.mesh.faceCount()});
    }
    return shares;
}

/// The level with the count nearest to a share of the faces.
uint32_t levelAt(const std::vector<uint32_t>& counts, double share) {
    uint32_t best = 0;
    const auto distance = [&](uint32_t l) { return std::abs(std::log(std::max(counts[l], 1u) / (share * counts[0]))); };
    for (uint32_t l = 1; l < counts.size(); ++l) {
        if (distance(l) < distance(best)) best = l;
    }
    return best;
}

} // namespace

int benchParts(const Flags& flags) {
    if (flags.data.empty()) return 0;
    Csv csv(flags, "parts", "model,part,part_share,level,rest_share,triangles_over_ideal");
    std::vector<double> all, means;
    const auto measure = [&](const Subject& subject) {
        const bake::Hierarchy h = build(subject, subject.parts);
        const std::vector<uint32_t> counts = uniformFaces(subject.mesh, h);
        const uint32_t level = levelAt(counts, kRest);
        const double rest = double(counts[level]) / counts[0];
        std::vector<double> ofModel;
        const std::vector<Share> shares = sharesOf(subject, h, level);
        for (uint32_t p = 0; p < shares.size(); ++p) {
            ofModel.push_back(shares[p].drawn);
            csv.row(fmt::format("{},{},{:.5f},{},{:.5f},{:.4f}", subject.name, p, shares[p].fraction, level, rest,
                                shares[p].drawn));
        }
        fmt::print("{:<8} {:>3} parts, the others at {:5.2f} %: {:.3f} in the mean, {:.3f} at worst\n", subject.name,
                   shares.size(), 100 * rest, mean(ofModel), std::ranges::max(ofModel));
        all.insert(all.end(), ofModel.begin(), ofModel.end());
        means.push_back(mean(ofModel));
    };
    if (const int failed = forSubjects(flags, princetonSample(flags.data), measure); failed != 0) return failed;
    if (all.empty()) return 0;
    fmt::print(
        "triangles over the ideal: {:.3f} in the mean of the models, {:.3f} in the median part, {:.3f} at worst\n",
        mean(means), median(all), std::ranges::max(all));
    return 0;
}

} // namespace xgc::bench
