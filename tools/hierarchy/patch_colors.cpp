#include "hierarchy/patch_colors.h"

namespace xgc::bake {

namespace {

/// For each of the patches, by their order in the list, those that share a representative with it; with repetitions.
std::vector<std::vector<uint32_t>> neighboursOf(const SurfaceState& state, std::span<const uint32_t> patches) {
    std::vector<uint32_t> indexOf(state.patches.size(), kNone);
    for (uint32_t i = 0; i < patches.size(); ++i) indexOf[patches[i]] = i;
    std::vector<std::vector<uint32_t>> neighbours(patches.size());
    std::vector<uint32_t> around;
    for (uint32_t r = 0; r < state.isBoundary.size(); ++r) {
        if (!state.isBoundary[r] || state.representative[r] != r) continue;
        around.clear();
        state.forGroup(r, [&](uint32_t m) {
            for (const SurfaceState::Occurrence& o : state.occurrencesOf(m)) {
                if (indexOf[o.patch] != kNone) around.push_back(indexOf[o.patch]);
            }
        });
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (const uint32_t a : around) {
            for (const uint32_t b : around) {
                if (a != b) neighbours[a].push_back(b);
            }
        }
    }
    return neighbours;
}

} // namespace

std::vector<std::vector<uint32_t>> colorPatches(const SurfaceState& state, std::span<const uint32_t> patches) {
    std::vector<std::vector<uint32_t>> colors;
    if (patches.size() == 1) return {{patches[0]}};
    const std::vector<std::vector<uint32_t>> neighbours = neighboursOf(state, patches);
    std::vector<uint32_t> colorOf(patches.size(), kNone), usedBy;
    for (uint32_t i = 0; i < patches.size(); ++i) {
        usedBy.resize(colors.size() + 1, kNone);
        for (const uint32_t n : neighbours[i]) {
            if (colorOf[n] != kNone) usedBy[colorOf[n]] = i;
        }
        uint32_t color = 0;
        while (usedBy[color] == i) ++color;
        if (color == colors.size()) colors.emplace_back();
        colors[color].push_back(patches[i]);
        colorOf[i] = color;
    }
    return colors;
}

} // namespace xgc::bake
