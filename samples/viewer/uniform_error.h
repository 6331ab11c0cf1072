#pragma once

#include "drawn_asset.h"

#include <vector>

namespace xgc::viewer {

/// One error for all patches of all models, in world units, whatever the view: what parts are compared with. Each patch
/// is at the coarsest level whose error is at most `error()`; of the patches that change level at just that error, the
/// first few, so that triangles change by one patch's at a time.
///
///     error  0 --- e1 --- e2 === e2 --- e3 --->    each mark is one patch's step to its next level
///                          ^ position: all before it are taken
class UniformError {
public:
    /// Models as they stand, at their coarsest. Their views outlive this.
    void create(std::span<const DrawnAsset> assets);

    /// The finest that draws at most so many triangles of what is visible; the coarsest where none does. What is not
    /// visible counts as its coarsest level, as selections draw it. The same models; their `levels` are not read.
    void hold(std::span<const DrawnAsset> assets, uint64_t triangles);

    /// Of all patches, visible or not.
    Levels levels(uint32_t asset) const { return models_[asset].levels; }
    float error() const { return position_ > 0 ? steps_[position_ - 1].error : 0; }
    uint64_t triangles() const { return triangles_; } ///< of what was visible
    size_t modelCount() const { return models_.size(); }

private:
    /// A patch gets a level, one coarser than before.
    struct Step {
        float error = 0;
        uint32_t model = 0, patch = 0, level = 0;
    };
    struct Patch {
        uint32_t triangles = 0;
        bool visible = false;
        bool changed = false; ///< its triangles are to be counted again
    };
    struct Model {
        const AssetView* asset = nullptr;
        std::vector<uint8_t> levels, drawn; ///< drawn: the coarsest where it is not visible
        std::vector<Patch> patches;
    };

    void show(std::span<const DrawnAsset> assets);
    void touch(uint32_t model, uint32_t patch);
    void draw(uint32_t model, uint32_t patch, uint32_t level);
    void apply(const Step& step, uint32_t level);
    void take() { apply(steps_[position_], steps_[position_].level), ++position_; }
    void giveBack() { --position_, apply(steps_[position_], steps_[position_].level - 1); }
    void count();
    double saved(const Step& step) const;
    void leap(uint64_t triangles);
    void walk(uint64_t triangles);

    std::vector<Model> models_;
    std::vector<Step> steps_; ///< in order of their errors
    size_t position_ = 0;     ///< of the steps, so many are taken
    uint64_t triangles_ = 0;
    std::vector<std::pair<uint32_t, uint32_t>> changed_; ///< models and patches
    std::vector<uint32_t> scratch_, indices_;
};

} // namespace xgc::viewer
