#include "evaluate/ranks.h"
#include "picture/text.h"

#include <xgc/bake/evaluate.h>
#include <xgc/bake/evaluate_pictures.h>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

using namespace xgc;
using namespace xgc::bake;
using Json = nlohmann::json;

namespace {

/// A benchmark of strips of four squares (faces 2i and 2i + 1 make square i), made in a folder of its own.
class TinyBenchmark {
public:
    explicit TinyBenchmark(const std::string& name)
        : root_(std::filesystem::path(XGC_BINARY_DIR) / "tests" / fmt::format("{}-{}", name, getpid())) {
        std::filesystem::remove_all(root_);
    }
    ~TinyBenchmark() {
        std::error_code ignored;
        std::filesystem::remove_all(root_, ignored);
    }
    TinyBenchmark(const TinyBenchmark&) = delete;
    TinyBenchmark& operator=(const TinyBenchmark&) = delete;

    PsbFolders folders() const { return {root_ / "off", root_ / "seg"}; }
    std::filesystem::path path(const std::string& name) const { return root_ / name; }

    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories(path(name).parent_path());
        std::ofstream(path(name)) << text;
    }
    void labels(const std::string& name, const std::vector<uint32_t>& labels) const {
        write(name, fmt::format("{}\n", fmt::join(labels, "\n")));
    }
    /// Model and the labels of people.
    void model(uint32_t number, const std::vector<std::vector<uint32_t>>& people) const {
        std::string off = "OFF\n10 8 0\n";
        for (int x = 0; x < 5; ++x) off += fmt::format("{} 0 0\n{} 1 0\n", x, x);
        for (int b = 0; b < 8; b += 2) off += fmt::format("3 {} {} {}\n3 {} {} {}\n", b, b + 2, b + 3, b, b + 3, b + 1);
        write(fmt::format("off/{}.off", number), off);
        for (size_t i = 0; i < people.size(); ++i)
            labels(fmt::format("seg/{}/{}_{}.seg", number, number, i), people[i]);
    }

private:
    std::filesystem::path root_;
};

const std::vector<uint32_t> kHalves = {0, 0, 0, 0, 1, 1, 1, 1};
const std::vector<uint32_t> kFirstSquare = {0, 0, 1, 1, 1, 1, 1, 1};
const std::vector<uint32_t> kAllSquares = {0, 0, 1, 1, 2, 2, 3, 3};
const std::vector<uint32_t> kWhole(8, 0);

EvalMethod methodOf(const TinyBenchmark& psb, const std::string& name) {
    EvalMethod method;
    const Status status = labelsMethod(name, psb.path(name), method);
    REQUIRE_MESSAGE(status.ok(), status.message);
    return method;
}

/// Models 1 and 3 (Human) and 21 (Cup); "fine" has a part each square, "coarse" one part.
void makeThree(const TinyBenchmark& psb) {
    psb.model(1, {kHalves, kFirstSquare, kHalves});
    psb.model(3, {kAllSquares, kAllSquares});
    psb.model(21, {kHalves});
    for (const uint32_t n : {1, 3, 21}) {
        psb.labels(fmt::format("fine/{}.seg", n), kAllSquares);
        psb.labels(fmt::format("coarse/{}.seg", n), kWhole);
    }
}

Evaluation evaluated(const TinyBenchmark& psb, std::vector<EvalMethod> methods) {
    EvalOptions options;
    options.folders = psb.folders();
    options.methods = std::move(methods);
    REQUIRE(listPsbModels(options.folders.off, "", options.numbers).ok());
    Evaluation evaluation;
    const Status status = evaluate(options, evaluation);
    REQUIRE_MESSAGE(status.ok(), status.message);
    return evaluation;
}

std::vector<uint32_t> listed(const TinyBenchmark& psb, std::string_view list) {
    std::vector<uint32_t> numbers;
    const Status status = listPsbModels(psb.folders().off, list, numbers);
    CHECK_MESSAGE(status.ok(), status.message);
    return numbers;
}

void checkFails(const Status& status, Outcome outcome, std::string_view named) {
    CHECK(status.outcome == outcome);
    CHECK_MESSAGE(status.message.find(named) != std::string::npos, status.message);
}

} // namespace

TEST_CASE("categories have 20 models each, and 261 to 280 belong to none") {
    const auto name = [](uint32_t number) -> std::string_view {
        const uint32_t category = psbCategoryOf(number);
        return category == bake::kNone ? "none" : psbCategories()[category];
    };
    CHECK(psbCategories().size() == 19);
    CHECK(name(0) == "none");
    CHECK(name(1) == "Human");
    CHECK(name(20) == "Human");
    CHECK(name(21) == "Cup");
    CHECK(name(260) == "Bird");
    CHECK(name(261) == "none");
    CHECK(name(280) == "none");
    CHECK(name(281) == "Armadillo");
    CHECK(name(400) == "FourLeg");
    CHECK(name(401) == "none");
    CHECK(name(4294967295u) == "none");
}

TEST_CASE("models are picked by number, range and category") {
    const TinyBenchmark psb("eval-list");
    for (const uint32_t n : {100, 3, 21, 281, 22}) psb.model(n, {kHalves});
    psb.write("off/readme.txt", "");
    psb.write("off/7b.off", "");
    CHECK(listed(psb, "") == std::vector<uint32_t>{3, 21, 22, 100, 281});
    CHECK(listed(psb, "22,3") == std::vector<uint32_t>{3, 22});
    CHECK(listed(psb, "1-21") == std::vector<uint32_t>{3, 21});
    CHECK(listed(psb, "Cup,Armadillo,21") == std::vector<uint32_t>{21, 22, 281});

    std::vector<uint32_t> numbers = {77};
    const auto fails = [&](std::string_view list, Outcome outcome, std::string_view named) {
        checkFails(listPsbModels(psb.folders().off, list, numbers), outcome, named);
    };
    fails("4", Outcome::badInput, "'4'");
    fails("Ant-", Outcome::usage, "'Ant-'");
    fails("3,,21", Outcome::usage, "''");
    fails("9-3", Outcome::usage, "'9-3'");
    fails("99999999999", Outcome::usage, "a number, a range");
    checkFails(listPsbModels(psb.path("nowhere"), "", numbers), Outcome::badInput, "nowhere: no such folder");
    checkFails(listPsbModels(psb.folders().seg, "", numbers), Outcome::badInput, "holds no model");
    CHECK(numbers == std::vector<uint32_t>{77});
}

TEST_CASE("the ground truth's part count is the mode, the smaller of equals") {
    PsbModel model;
    model.people = {kHalves, kAllSquares, kFirstSquare, kWhole, kAllSquares};
    CHECK(mostFrequentPartCount(model) == 2);
    model.people = {kAllSquares, kWhole};
    CHECK(mostFrequentPartCount(model) == 1);
    model.people = {kWhole, kAllSquares, kHalves, kAllSquares};
    CHECK(mostFrequentPartCount(model) == 4);
}

TEST_CASE("presets get the number of parts that is asked for") {
    const TinyBenchmark psb("eval-count");
    psb.model(1, {kHalves, kAllSquares, kAllSquares});
    EvalOptions options;
    options.folders = psb.folders();
    options.numbers = {1};
    std::vector<uint32_t> asked;
    options.methods.push_back({"spy", [&](const PsbModel&, uint32_t count, std::vector<uint32_t>& labels, double&) {
                                   asked.push_back(count);
                                   labels = kHalves;
                                   return Status{};
                               }});
    Evaluation evaluation;
    CHECK(evaluate(options, evaluation).ok());
    options.partsCount = PartsCount::people;
    CHECK(evaluate(options, evaluation).ok());
    options.partsCount = PartsCount::fixed;
    options.fixedPartsCount = 7;
    CHECK(evaluate(options, evaluation).ok());
    CHECK(asked == std::vector<uint32_t>{0, 4, 7});
}

TEST_CASE("scores are means over people, then over models") {
    const TinyBenchmark psb("eval-means");
    makeThree(psb);
    const Evaluation e = evaluated(psb, {methodOf(psb, "fine"), methodOf(psb, "coarse")});
    REQUIRE(e.methods.size() == 2);
    const Evaluation::Row &fine = e.methods[0], &coarse = e.methods[1];

    // Model 1, "fine": 8/24 from the halves (test_segmentation_metrics), and from the first square 4 + 16 - 2 * 4 = 12
    // of 24: (1/3 + 1/2 + 1/3) / 3. Model 3: 0; model 21: 1/3.
    CHECK(fine.models[0].ri == doctest::Approx(7.0 / 18));
    CHECK(fine.models[1].ri == 0);
    CHECK(fine.models[1].cd == 0);
    const EvalScore total = meanScore(fine.models);
    CHECK(total.ri == doctest::Approx((7.0 / 18 + 0 + 1.0 / 3) / 3));
    CHECK(total.parts == 4);
    CHECK(total.models == 3);
    CHECK(total.cutModels == 3);
    CHECK(categoryScore(e, fine, 0).ri == doctest::Approx(7.0 / 36));
    CHECK(categoryScore(e, fine, 1).ri == doctest::Approx(1.0 / 3));
    CHECK(categoryScore(e, fine, 2).models == 0);

    // No cut, so no cut discrepancy: it is left out, and told.
    CHECK(meanScore(coarse.models).cutModels == 0);
    CHECK(meanScore(coarse.models).models == 3);

    // Pairs of people of model 1: 1/2, 0, 1/2; of model 3: 0; model 21 has one person and no pair.
    CHECK(e.human.models[0].ri == doctest::Approx(1.0 / 3));
    CHECK(e.human.models[0].parts == 2);
    const EvalScore human = meanScore(e.human.models);
    CHECK(human.models == 2);
    CHECK(human.ri == doctest::Approx(1.0 / 6));
    CHECK(human.parts == 3);
    CHECK(human.medianParts == 3);
}

TEST_CASE("a mean leaves models without a cut out of the cut discrepancy only") {
    const EvalScore cut = {
        .ri = 0.2, .cd = 0.4, .parts = 3, .medianParts = 3, .seconds = 1, .models = 1, .cutModels = 1};
    const EvalScore noCut = {.ri = 0.4, .parts = 1, .medianParts = 1, .seconds = 2, .models = 1, .cutModels = 0};
    const EvalScore mean = meanScore(std::array{cut, noCut, noCut, EvalScore{}});
    CHECK(mean.ri == doctest::Approx(1.0 / 3));
    CHECK(mean.cd == 0.4);
    CHECK(mean.parts == doctest::Approx(5.0 / 3));
    CHECK(mean.medianParts == 1);
    CHECK(mean.seconds == 5);
    CHECK(mean.models == 3);
    CHECK(mean.cutModels == 1);
}

TEST_CASE("ranks: 1 is best, equals share, what is unknown comes last") {
    const auto row = [](const std::string& name, double ri, uint32_t cutModels, double cd) {
        return Evaluation::Row{name, {{.ri = ri, .cd = cd, .models = 1, .cutModels = cutModels}}};
    };
    Evaluation e;
    e.numbers = {21};
    e.methods = {row("a", 0.3, 1, 0.5), row("b", 0.1, 0, 0), row("c", 0.3, 1, 0.2)};
    const std::span<const EvalMetric> metrics = evalMetrics();
    CHECK(rankMethods(e, metrics[0], 1) == std::vector<uint32_t>{2, 1, 2});
    CHECK(rankMethods(e, metrics[1], 1) == std::vector<uint32_t>{2, 3, 1});
    CHECK(rankMethods(e, metrics[0], bake::kNone) == std::vector<uint32_t>{2, 1, 2});
    CHECK(rankMethods(e, metrics[0], 0).empty());
}

TEST_CASE("JSON: one method at the top, several by name with ranks; what is unknown is null") {
    const TinyBenchmark psb("eval-json");
    makeThree(psb);
    const EvalMethod fine = methodOf(psb, "fine"), coarse = methodOf(psb, "coarse");
    const Json one = Json::parse(evaluationJson(evaluated(psb, {coarse})));
    for (const char* key : {"ri", "cd", "hd", "gce", "lce", "parts", "medianParts", "seconds", "modelCount", "noCut"}) {
        CHECK_MESSAGE(one["total"].contains(key), key);
    }
    CHECK(one["total"]["cd"].is_null());
    CHECK(one["total"]["noCut"] == 3);
    CHECK(one["models"].size() == 3);
    CHECK(one["categories"]["Human"]["modelCount"] == 2);
    CHECK_FALSE(one["categories"].contains("Ant"));
    CHECK(one["human"]["ri"].get<double>() == doctest::Approx(1.0 / 6));
    CHECK(one["human"]["models"].size() == 2);
    CHECK_FALSE(one.contains("ranks"));

    const Json two = Json::parse(evaluationJson(evaluated(psb, {fine, coarse})));
    CHECK(two["methods"]["coarse"] ==
          Json{{"total", one["total"]}, {"categories", one["categories"]}, {"models", one["models"]}});
    CHECK(two["human"] == one["human"]);
    CHECK(two["ranks"]["ri"]["Average"] == Json{{"fine", 1}, {"coarse", 2}});
    CHECK(two["ranks"]["cd"]["Cup"] == Json{{"fine", 1}, {"coarse", 2}});
}

TEST_CASE("the same bytes for one thread and for several") {
    const TinyBenchmark psb("eval-threads");
    for (uint32_t n = 1; n <= 40; ++n) {
        psb.model(n, {kHalves, n % 2 ? kFirstSquare : kAllSquares, n % 3 ? kHalves : kWhole});
        psb.labels(fmt::format("fine/{}.seg", n), n % 5 ? kAllSquares : kFirstSquare);
    }
    const Evaluation several = evaluated(psb, {methodOf(psb, "fine")});
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const Evaluation single = evaluated(psb, {methodOf(psb, "fine")});
    CHECK(evaluationJson(several) == evaluationJson(single));
    CHECK(evaluationTable(several) == evaluationTable(single));
}

TEST_CASE("seconds of labels made elsewhere come from a file beside them") {
    const TinyBenchmark psb("eval-seconds");
    makeThree(psb);
    psb.write("fine/seconds.txt", "1 0.5\n21 2\n");
    const Evaluation e = evaluated(psb, {methodOf(psb, "fine")});
    CHECK(e.methods[0].models[0].seconds == 0.5);
    CHECK(e.methods[0].models[1].seconds == 0);
    CHECK(meanScore(e.methods[0].models).seconds == 2.5);
    EvalMethod method;
    for (const char* line : {"1", "one 1", "1 x", "1 -1", ""}) {
        psb.write("fine/seconds.txt", std::string("3 0.5\n") + line + "\n");
        checkFails(labelsMethod("fine", psb.path("fine"), method), Outcome::badInput, "seconds.txt: line 2");
    }
}

TEST_CASE("what is missing or does not fit is named, the first model first") {
    const TinyBenchmark psb("eval-bad");
    makeThree(psb);
    EvalOptions options;
    options.folders = psb.folders();
    options.numbers = {1, 3, 21};
    options.methods = {methodOf(psb, "fine")};
    Evaluation evaluation;
    const auto fails = [&](std::string_view named) {
        checkFails(evaluate(options, evaluation), Outcome::badInput, named);
        CHECK(evaluation.numbers.empty());
    };
    psb.labels("fine/21.seg", {0, 0, 0});
    fails("fine/21.seg: 3 lines for a model of 8 faces");
    std::filesystem::remove(psb.path("fine/3.seg"));
    fails("fine/3.seg: no such file");
    psb.write("seg/3/3_0.seg", "0\nnot a number\n");
    fails("3_0.seg: line 2");
    std::filesystem::remove(psb.path("seg/3/3_0.seg"));
    std::filesystem::remove(psb.path("seg/3/3_1.seg"));
    fails("seg/3: holds no person's labels of model 3");
    std::filesystem::remove(psb.path("seg/3"));
    fails("seg/3: no such folder");
    psb.write("off/1.off", "OFF\n1 1 0\n");
    fails("1.off");
    EvalMethod method;
    checkFails(labelsMethod("gone", psb.path("gone"), method), Outcome::badInput, "gone: no such folder");
}

TEST_CASE("people are typical by their distance to all others") {
    const TinyBenchmark psb("eval-typical");
    psb.model(1, {kWhole, kFirstSquare, kHalves, kHalves, kAllSquares});
    PsbModel model;
    REQUIRE(readPsbModel(psb.folders(), 1, model).ok());
    CHECK(typicalPeople(model, 2) == std::vector<uint32_t>{2, 3});
    CHECK(typicalPeople(model, 9).size() == 5);
}

TEST_CASE("corresponding parts have the same colours in a row of pictures") {
    const TinyBenchmark psb("eval-pictures");
    psb.model(1, {kHalves});
    PsbModel model;
    REQUIRE(readPsbModel(psb.folders(), 1, model).ok());
    const std::vector<uint32_t> renamed = {9, 9, 9, 9, 4, 4, 4, 4};
    constexpr uint32_t kSize = 100;
    const auto row = [&](const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
        return drawPartsRow(model, "", std::array{CaptionedLabels{"same", a}, CaptionedLabels{"same", b}}, kSize);
    };
    const auto halvesAreAlike = [](const Image& image) {
        for (uint32_t y = 0; y < image.height; ++y) {
            const auto left = image.pixels.begin() + std::ptrdiff_t(size_t(y) * image.width);
            if (!std::equal(left, left + kSize, left + kSize)) return false;
        }
        return true;
    };
    const Image alike = row(kHalves, renamed);
    CHECK(alike.width == 2 * kSize);
    CHECK(halvesAreAlike(alike));
    CHECK_FALSE(halvesAreAlike(row(kHalves, kFirstSquare)));
    CHECK(row(kHalves, kFirstSquare).pixels == row(kHalves, kFirstSquare).pixels);
}

TEST_CASE("a contact sheet keeps its pictures whole and in order") {
    std::vector<Image> images;
    for (uint32_t i = 0; i < 3; ++i) {
        images.push_back({2, 1, std::vector<glm::u8vec4>(2, glm::u8vec4(uint8_t(i + 1), 0, 0, 255))});
    }
    const Image sheet = contactSheet(images, 2);
    CHECK(sheet.width == 4);
    CHECK(sheet.height == 2);
    CHECK(sheet.pixels[0].x == 1);
    CHECK(sheet.pixels[2].x == 2);
    CHECK(sheet.pixels[4].x == 3);
    CHECK(contactSheet({}, 3).pixels.empty());
}

TEST_CASE("text stays inside the image, whatever it says") {
    const auto inked = [](const std::string& text, uint32_t x, uint32_t scale) {
        Image image{40, 20, std::vector<glm::u8vec4>(800, glm::u8vec4(0))};
        drawText(image, x, 2, text, glm::u8vec4(255), scale);
        return std::count(image.pixels.begin(), image.pixels.end(), glm::u8vec4(255));
    };
    CHECK(inked("Cup", 2, 1) > 20);
    CHECK(inked("I", 2, 2) == 4 * inked("I", 2, 1));
    CHECK(inked("", 2, 1) == 0);
    CHECK(inked("Cup", 100, 1) == 0);
    CHECK(inked("\xc3\xa9\n\x01", 2, 1) == inked("????", 2, 1));
    CHECK(textWidth("ab", 2) == 2 * textWidth("ab", 1));
}
