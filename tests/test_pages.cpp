#include <xgc/bake/pages.h>
#include <xgc/indices.h>
#include <xgc/load.h>
#include <xgc/pages.h>

#include "meshes/hostile.h"
#include "meshes/patched_torus.h"
#include "meshes/toy_asset.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

using namespace xgc;

namespace {

using Triangle = std::array<float, 9>;

std::vector<Triangle> drawn(const AssetView& asset, Levels levels) {
    std::vector<Triangle> all;
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        out.resize(indexCapacity(asset, p, levels));
        const uint32_t count = buildIndices(asset, p, levels, scratch, out);
        for (uint32_t i = 0; i < count; i += 3) {
            std::array<glm::vec3, 3> t{};
            for (int k = 0; k < 3; ++k) t[k] = asset.positions[out[i + k]];
            const auto less = [](const glm::vec3& a, const glm::vec3& b) {
                return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
            };
            std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
            all.push_back({t[0].x, t[0].y, t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z});
        }
    }
    std::sort(all.begin(), all.end());
    return all;
}

bake::AlignedBytes cut(std::span<const std::byte> image, const bake::PageOptions& options) {
    std::vector<std::byte> bytes;
    const bake::Status s = bake::cutIntoPages(image, options, bytes);
    REQUIRE_MESSAGE(s.ok(), s.message);
    return test::aligned(bytes);
}

const bake::AlignedBytes& cutTorus() {
    static const test::OpenAsset torus = test::openBuilt(test::patchedTorus({.patches = 4, .levels = 4}), 4);
    static const bake::AlignedBytes file = cut(torus.bytes.span(), {.tiers = 4, .pageBytes = 4096});
    return file;
}

} // namespace

TEST_CASE("an asset in tiers draws the same surface in every state as in one") {
    for (const bool thin : {false, true}) {
        const test::Patched built = test::patchedTorus({.patches = 4, .levels = thin ? 2u : 4u, .repeatedLevels = 1});
        const test::OpenAsset plain = test::openBuilt(built), tiered = test::openBuilt(built, 4);
        REQUIRE(plain.failure == "");
        REQUIRE(tiered.failure == "");
        CHECK(tiered.view.record->domainCount > plain.view.record->domainCount);
        std::mt19937 random(3);
        std::vector<uint8_t> levels(plain.view.patchCount());
        for (int i = 0; i < 30; ++i) {
            for (uint8_t& l : levels) l = uint8_t(random() % plain.view.levelCount());
            CHECK(drawn(plain.view, levels) == drawn(tiered.view, levels));
        }
    }
}

TEST_CASE("pages join to the image that was cut, bit for bit, compressed or not") {
    const test::OpenAsset torus = test::openBuilt(test::patchedTorus({.patches = 4, .levels = 4}), 3);
    REQUIRE(torus.failure == "");
    for (const bool compress : {false, true}) {
        for (const uint32_t pageBytes : {1u, 3000u, 1u << 30}) {
            const bake::AlignedBytes file =
                cut(torus.bytes.span(), {.tiers = 3, .pageBytes = pageBytes, .compress = compress});
            AssetView tables;
            const Status opened = openTables(file.span(), tables);
            REQUIRE_MESSAGE(opened.ok(), opened.message);
            CHECK(tables.tierCount() == 3);
            CHECK(tables.pages.size() >= 3);
            CHECK((pageBytes != 1 || tables.pages.size() > 3 * 8));
            bake::AlignedBytes image;
            REQUIRE(bake::decodeImage(test::aligned(file.span()), image).ok());
            CHECK(std::ranges::equal(image.span(), torus.bytes.span()));
            // In place there is no one array of anything.
            CHECK(openAll(file.span(), tables).code == StatusCode::unsupported);
        }
    }
}

TEST_CASE("toy assets with made vertices and wide patches are cut, too") {
    for (const bool make : {false, true}) {
        test::ToyOptions options;
        options.levelCount = 8;
        options.makeVertices = make;
        const test::ToyAsset toy = test::toyAsset(test::sphere(8), 5, options);
        REQUIRE(toy.error == "");
        std::vector<std::byte> image;
        REQUIRE(
            bake::layOutAsset(toy.mesh, toy.parts, toy.hierarchy, test::toyErrors(toy.hierarchy), true, "", image, 4)
                .ok());
        const bake::AlignedBytes file = cut(image, {.tiers = 4, .pageBytes = 2000});
        AssetView tables;
        CHECK(openTables(file.span(), tables).ok());
        bake::AlignedBytes joined;
        REQUIRE(bake::decodeImage(test::aligned(file.span()), joined).ok());
        AssetView view;
        REQUIRE(openAll(joined.span(), view).ok());
        std::mt19937 random(5);
        std::vector<uint8_t> levels(view.patchCount());
        for (int i = 0; i < 20; ++i) {
            for (uint8_t& l : levels) l = uint8_t(random() % view.levelCount());
            CHECK(drawn(toy.asset, levels) == drawn(view, levels));
        }
    }
}

TEST_CASE("what a coarse page does not hold is not named from the first level of its tier on") {
    AssetView tables;
    REQUIRE(openTables(cutTorus().span(), tables).ok());
    REQUIRE(tables.tierCount() == 4);
    std::vector<PageContents> pages(tables.pages.size());
    std::vector<uint32_t> rangePages(tables.vertexRanges.size()), rangeRows(rangePages);
    std::vector<PatchTier> tiers(tables.patchPages.size());
    mapPages(tables, {pages, rangePages, rangeRows, tiers});
    CHECK(checkPageContents(tables, {pages, rangePages, rangeRows, tiers}).ok());
    // The finest tier has most: about four times the next.
    std::array<uint64_t, 4> rows{};
    for (size_t i = 0; i < pages.size(); ++i) rows[tables.pages[i].tier] += pages[i].rows;
    for (int t = 0; t < 3; ++t) CHECK(rows[t + 1] > 2 * rows[t]);
    for (uint32_t level = 0; level < tables.levelCount(); ++level) {
        const uint32_t t = tables.tierOf(level);
        CHECK(level >= tables.tierLevels[t]);
        CHECK((t == 0 || level < tables.tierLevels[t - 1]));
    }
}

TEST_CASE("a cut file with any bit altered, or cut short, is refused") {
    const std::span<const std::byte> file = cutTorus().span();
    test::ExactBytes bytes(file);
    std::mt19937 random(9);
    AssetView view;
    const uint64_t tableBytes = test::load<format::FileHeader>(file, 0).tableBytes;
    for (int i = 0; i < 400; ++i) {
        const size_t at = random() % file.size();
        bytes.span()[at] ^= std::byte(1u << random() % 8);
        bake::AlignedBytes out;
        CHECK((at < tableBytes ? !openTables(bytes.span(), view).ok() : openTables(bytes.span(), view).ok()));
        CHECK(!bake::decodeImage(test::aligned(bytes.span()), out).ok());
        bytes.span()[at] = file[at];
    }
    for (int i = 0; i < 100; ++i) {
        test::ExactBytes prefix(file.first(random() % file.size()));
        DecodedSize size;
        CHECK(!decodedSize(prefix.span(), size).ok());
    }
}

TEST_CASE("hostile tables and pages of a cut file never reach past it") {
    const std::span<const std::byte> file = cutTorus().span();
    std::mt19937 random(17);
    uint32_t opened = 0;
    for (int i = 0; i < 3000; ++i) {
        test::ExactBytes bytes(file);
        const uint64_t tableBytes = test::load<format::FileHeader>(file, 0).tableBytes;
        for (uint32_t n = uint32_t(1 + random() % 3); n-- > 0;) {
            const size_t at = 64 + random() % ((random() % 2 ? tableBytes : file.size()) - 68);
            const uint32_t values[] = {0, 1, uint32_t(random()), 0xffffffffu, uint32_t(random() % 256)};
            test::store(bytes.span(), at / 4 * 4, values[random() % 5]);
        }
        test::fixChecksums(bytes.span());
        AssetView view;
        DecodedSize size;
        opened += openTables(bytes.span(), view).ok();
        if (!decodedSize(bytes.span(), size).ok() || size.imageBytes > (1u << 24)) continue;
        bake::AlignedBytes image = bake::alignedBytes(size.imageBytes), scratch = bake::alignedBytes(size.scratchBytes);
        if (decode(bytes.span(), scratch.writable(), image.writable()).ok()) (void)openAll(image.span(), view);
    }
    CHECK(opened > 0);
}
