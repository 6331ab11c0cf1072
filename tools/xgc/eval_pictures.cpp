#include "eval_pictures.h"

#include <fmt/format.h>

#include <algorithm>

namespace xgc::tool {
namespace {

constexpr uint32_t kPeople = 2;
constexpr uint32_t kPictureSize = 400;      ///< pixels, in the file of a model
constexpr uint32_t kSheetPictureSize = 200; ///< pixels, on the sheet
constexpr uint32_t kSheetPictures = 9;      ///< side by side, some

size_t partCount(std::vector<uint32_t> labels) {
    std::sort(labels.begin(), labels.end());
    return size_t(std::unique(labels.begin(), labels.end()) - labels.begin());
}

std::string caption(const std::string& who, const std::vector<uint32_t>& labels) {
    const size_t parts = partCount(labels);
    return fmt::format("{}, {} {}", who, parts, parts == 1 ? "part" : "parts");
}

} // namespace

EvalPictures::EvalPictures(std::filesystem::path folder, const bake::EvalOptions& options)
    : folder_(std::move(folder)) {
    for (const bake::EvalMethod& method : options.methods) methods_.push_back(method.name);
    std::vector<bool> shown(bake::psbCategories().size(), false);
    for (const uint32_t number : options.numbers) {
        const uint32_t category = bake::psbCategoryOf(number);
        if (category == bake::kNone || shown[category]) continue;
        shown[category] = true;
        sheetNumbers_.push_back(number);
    }
    sheetImages_.resize(sheetNumbers_.size());
}

bake::Status EvalPictures::begin() const {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) return bake::systemError(fmt::format("{}: {}; name a folder", folder_.string(), error.message()));
    return {};
}

bake::Status EvalPictures::draw(const bake::PsbModel& model, std::span<const std::vector<uint32_t>> labels) {
    std::vector<bake::CaptionedLabels> labelings;
    for (size_t m = 0; m < labels.size(); ++m) labelings.push_back({caption(methods_[m], labels[m]), labels[m]});
    for (const uint32_t person : bake::typicalPeople(model, kPeople)) {
        labelings.push_back({caption("a person", model.people[person]), model.people[person]});
    }
    const uint32_t category = bake::psbCategoryOf(model.number);
    const std::string_view name = category == bake::kNone ? std::string_view("model") : bake::psbCategories()[category];
    const std::string title = fmt::format("{} {}", name, model.number);
    const auto onSheet = std::find(sheetNumbers_.begin(), sheetNumbers_.end(), model.number);
    if (onSheet != sheetNumbers_.end()) {
        sheetImages_[size_t(onSheet - sheetNumbers_.begin())] =
            bake::drawPartsRow(model, title, labelings, kSheetPictureSize);
    }
    return bake::writePng(bake::drawPartsRow(model, title, labelings, kPictureSize),
                          folder_ / fmt::format("{}.png", model.number));
}

bake::Status EvalPictures::finish() const {
    if (sheetImages_.empty()) return {};
    const auto columns = uint32_t(kSheetPictures / (methods_.size() + kPeople));
    return bake::writePng(bake::contactSheet(sheetImages_, columns), folder_ / "contact.png");
}

} // namespace xgc::tool
