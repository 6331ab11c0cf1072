#pragma once

#include <xgc/bake/evaluate.h>
#include <xgc/bake/image.h>

namespace xgc::bake {

/// Labels of the input's faces, and what to write below their picture.
struct CaptionedLabels {
    std::string caption;
    std::span<const uint32_t> labels;
};

/// A model's parts side by side, each picture `size` pixels square. The first labeling has the palette's colours by
/// area; in the others the parts that correspond have the same ones: greedily, the largest common area first. `title`
/// is written into the upper left corner (ASCII).
Image drawPartsRow(const PsbModel& model, const std::string& title, std::span<const CaptionedLabels> labelings,
                   uint32_t size);

/// The `count` people whose labels differ least from all others', by Rand index error, the most typical first: indices
/// into model.people.
std::vector<uint32_t> typicalPeople(const PsbModel& model, uint32_t count);

/// Pictures in a grid, by rows, each in a cell of the largest one's size.
Image contactSheet(std::span<const Image> images, uint32_t columns);

} // namespace xgc::bake
