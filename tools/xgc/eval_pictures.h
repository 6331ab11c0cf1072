#pragma once

#include <xgc/bake/evaluate_pictures.h>

namespace xgc::tool {

/// Pictures of an evaluation: N.png for model N, its parts by each method beside those of two people, and contact.png
/// with the first model of every category.
class EvalPictures {
public:
    EvalPictures(std::filesystem::path folder, const bake::EvalOptions& options);

    /// Makes the folder.
    bake::Status begin() const;
    /// Draws a model; from several threads, each another model.
    bake::Status draw(const bake::PsbModel& model, std::span<const std::vector<uint32_t>> labels);
    bake::Status finish() const;

private:
    std::filesystem::path folder_;
    std::vector<std::string> methods_;
    std::vector<uint32_t> sheetNumbers_;   ///< models on the sheet
    std::vector<bake::Image> sheetImages_; ///< one each
};

} // namespace xgc::tool
