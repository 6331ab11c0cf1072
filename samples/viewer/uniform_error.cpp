#include "uniform_error.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

// Triangles are counted by building them: beside finer neighbours a patch has more of them than at its level alone.
// Only those near a change are built again, so a frame that resembles the last one costs little. Far moves leap by
// what the patches have at their levels alone, which is nearly proportional, and walk the rest.

namespace xgc::viewer {
namespace {

constexpr int kMostLeaps = 6;
constexpr double kNear = 0.003; ///< of the triangles: from here on it walks

} // namespace

void UniformError::create(std::span<const DrawnAsset> assets) {
    *this = {};
    uint32_t scratch = 0;
    for (uint32_t m = 0; m < assets.size(); ++m) {
        const AssetView& asset = *assets[m].asset;
        const float scale = makePlacement(glm::mat4(assets[m].toWorld)).maxScale;
        const auto coarsest = uint8_t(asset.levelCount() - 1);
        Model& model = models_.emplace_back();
        model.asset = &asset;
        model.levels.assign(asset.patchCount(), coarsest);
        model.drawn = model.levels;
        model.patches.resize(asset.patchCount());
        scratch = std::max(scratch, scratchCapacity(asset));
        for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
            for (uint32_t level = 1; level <= coarsest; ++level)
                steps_.push_back({scale * asset.error(patch, level), m, patch, level});
        }
    }
    scratch_.resize(scratch);
    // The errors of a patch do not fall, so its levels come in order.
    std::sort(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) {
        return std::tie(a.error, a.model, a.patch, a.level) < std::tie(b.error, b.model, b.patch, b.level);
    });
    position_ = steps_.size();
}

void UniformError::hold(std::span<const DrawnAsset> assets, uint64_t triangles) {
    show(assets);
    count();
    leap(triangles);
    walk(triangles);
}

// The state -----------------------------------------------------------------------------------------------------------

void UniformError::touch(uint32_t model, uint32_t patch) {
    if (std::exchange(models_[model].patches[patch].changed, true)) return;
    changed_.emplace_back(model, patch);
}

void UniformError::draw(uint32_t m, uint32_t patch, uint32_t level) {
    Model& model = models_[m];
    if (model.drawn[patch] == level) return;
    model.drawn[patch] = uint8_t(level);
    touch(m, patch);
    for (const uint32_t domain : model.asset->domainsOf(patch)) {
        for (const uint32_t beside : model.asset->patchesOf(domain)) touch(m, beside);
    }
}

void UniformError::show(std::span<const DrawnAsset> assets) {
    for (uint32_t m = 0; m < models_.size(); ++m) {
        Model& model = models_[m];
        for (uint32_t p = 0; p < model.patches.size(); ++p) {
            const bool visible = assets[m].visible[p] != 0;
            if (std::exchange(model.patches[p].visible, visible) == visible) continue;
            touch(m, p);
            draw(m, p, visible ? model.levels[p] : model.asset->levelCount() - 1);
        }
    }
}

void UniformError::apply(const Step& step, uint32_t level) {
    Model& model = models_[step.model];
    model.levels[step.patch] = uint8_t(level);
    if (model.patches[step.patch].visible) draw(step.model, step.patch, level);
}

void UniformError::count() {
    for (const auto& [m, p] : changed_) {
        Model& model = models_[m];
        Patch& patch = model.patches[p];
        patch.changed = false;
        triangles_ -= std::exchange(patch.triangles, 0);
        if (!patch.visible) continue;
        const size_t capacity = indexCapacity(*model.asset, p, model.drawn);
        if (indices_.size() < capacity) indices_.resize(capacity);
        patch.triangles = buildIndices(*model.asset, p, model.drawn, scratch_, indices_) / 3;
        triangles_ += patch.triangles;
    }
    changed_.clear();
}

// The way ------------------------------------------------------------------------------------------------------------

/// Triangles that a step takes of what is visible, by its level alone.
double UniformError::saved(const Step& step) const {
    const Model& model = models_[step.model];
    if (!model.patches[step.patch].visible) return 0;
    return double(uniformTriangles(*model.asset, step.patch, step.level - 1)) -
           double(uniformTriangles(*model.asset, step.patch, step.level));
}

void UniformError::leap(uint64_t triangles) {
    for (int i = 0; i < kMostLeaps && triangles_ > 0; ++i) {
        if (std::abs(double(triangles_) - double(triangles)) <= kNear * double(triangles)) return;
        double alone = 0;
        for (const Model& model : models_) {
            for (uint32_t p = 0; p < model.patches.size(); ++p)
                alone += model.patches[p].visible ? uniformTriangles(*model.asset, p, model.levels[p]) : 0;
        }
        const double goal = alone * double(triangles) / double(triangles_);
        for (; alone > goal && position_ < steps_.size(); take()) alone -= saved(steps_[position_]);
        for (; alone < goal && position_ > 0; giveBack()) alone += saved(steps_[position_ - 1]);
        count();
    }
}

void UniformError::walk(uint64_t triangles) {
    while (triangles_ > triangles && position_ < steps_.size()) {
        take();
        count();
    }
    while (triangles_ <= triangles && position_ > 0) {
        giveBack();
        count();
    }
    if (triangles_ <= triangles || position_ == steps_.size()) return;
    take();
    count();
}

} // namespace xgc::viewer
