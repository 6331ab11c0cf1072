#include "counted_allocations.h"
#include "meshes/posed_model.h"
#include "meshes/streamed_torus.h"

#include <doctest/doctest.h>
#include <xxhash.h>

#include <chrono>
#include <cstring>
#include <thread>

using namespace xgc;
using test::FakeReader;
using test::StreamedTorus;
using test::Triangle;

namespace {

uint64_t hashOf(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), 0);
}

const StreamedTorus& torus() {
    static const StreamedTorus made({.patches = 6, .levels = 4}, {.tiers = 4, .pageBytes = 4096});
    REQUIRE_MESSAGE(made.failure.empty(), made.failure);
    return made;
}

ResidencyConfig configFor(FakeReader& reader, double share) {
    const PageLimits limits = pageLimits(torus().tables);
    ResidencyConfig config;
    config.pageBytes = limits.bytes;
    config.pageRows = limits.rows;
    config.budgetBytes = uint64_t(share * double(torus().tables.pages.size()) * (limits.bytes + limits.rows + 64.0));
    config.readBytes = 8ull * limits.bytes;
    config.installBytes = 3ull * limits.bytes;
    config.reader = reader.reader();
    return config;
}

/// A residency with the torus in it.
struct Stage {
    FakeReader reader;
    Residency residency;
    uint32_t asset = 0;

    explicit Stage(double share) {
        reader.file = torus().file.span();
        REQUIRE(residency.create(configFor(reader, share)).ok());
        const Status added = residency.addAsset(torus().tables, asset);
        REQUIRE_MESSAGE(added.ok(), added.message);
    }
    const AssetView& view() const { return residency.view(asset); }
    void update() {
        residency.update();
        reader.step(residency);
    }
    bool waitReady(int frames = 1000) {
        while (!residency.ready(asset) && frames-- > 0) update();
        return residency.ready(asset);
    }
    glm::vec3 position(uint32_t row) const {
        const std::byte* at = residency.row(asset, format::StreamKind::position, 0, row);
        glm::vec3 p(0);
        if (!at) FAIL_CHECK("row " << row << " is not there");
        if (at) std::memcpy(&p, at, sizeof p);
        return p;
    }
};

View lookFrom(const glm::vec3& eye) {
    return makeView(eye, 1, 1000);
}

/// Triangles of a patch, its rows' positions from wherever they are.
template <typename PositionOf>
void append(const AssetView& asset, uint32_t patch, Levels levels, const PositionOf& positionOf,
            std::vector<Triangle>& out) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices(indexCapacity(asset, patch, levels));
    const uint32_t count = buildIndices(asset, patch, levels, scratch, indices);
    for (uint32_t i = 0; i < count; i += 3) {
        out.push_back(
            test::triangleOf({positionOf(indices[i]), positionOf(indices[i + 1]), positionOf(indices[i + 2])}));
    }
}

std::vector<Triangle> plainSurface(Levels levels) {
    const AssetView& plain = torus().plain.view;
    std::vector<Triangle> out;
    for (uint32_t p = 0; p < plain.patchCount(); ++p) {
        append(
            plain, p, levels, [&](uint32_t row) { return plain.positions[row]; }, out);
    }
    std::sort(out.begin(), out.end());
    return out;
}

std::vector<Triangle> streamedSurface(const Stage& s, Levels levels) {
    std::vector<Triangle> out;
    for (uint32_t p = 0; p < s.view().patchCount(); ++p) {
        append(
            s.view(), p, levels, [&](uint32_t row) { return s.position(row); }, out);
    }
    std::sort(out.begin(), out.end());
    return out;
}

/// Any state that the residency allows draws what the whole asset would.
void checkAllowedStates(const Stage& s, std::mt19937& random, int states) {
    std::vector<uint8_t> levels(s.view().patchCount());
    for (int i = 0; i < states; ++i) {
        for (uint32_t p = 0; p < levels.size(); ++p) {
            // Often the finest that it may have, which is what must hold.
            const uint32_t finest = s.view().finestLevel(p);
            levels[p] =
                uint8_t(random() % 2 ? finest : std::max<uint32_t>(finest, uint32_t(random() % s.view().levelCount())));
        }
        CHECK(streamedSurface(s, levels) == plainSurface(levels));
    }
}

uint32_t finePatches(const Stage& s) {
    uint32_t count = 0;
    for (uint32_t p = 0; p < s.view().patchCount(); ++p) count += s.view().finestLevel(p) == 0;
    return count;
}

} // namespace

TEST_CASE("an asset is ready once its first pages are there, and then draws its coarse levels") {
    Stage s(1.2);
    CHECK_FALSE(s.residency.ready(s.asset));
    REQUIRE(s.waitReady());
    CHECK(s.residency.stats().installs < torus().tables.pages.size() / 4);
    CHECK(finePatches(s) == 0);
    std::mt19937 random(1);
    checkAllowedStates(s, random, 3);
    // Nobody wants more: nothing more is read.
    const uint64_t reads = s.reader.reads;
    for (int i = 0; i < 20; ++i) s.update();
    CHECK(s.reader.reads == reads);
}

TEST_CASE("what a view wants comes, and the finest levels with it where the budget holds all") {
    Stage s(1.3);
    REQUIRE(s.waitReady());
    for (int i = 0; i < 200; ++i) {
        s.residency.want(s.asset, {}, lookFrom({0, 0, 1}), 1e-3f);
        s.update();
    }
    CHECK(finePatches(s) == s.view().patchCount());
    CHECK(s.residency.stats().wantedPages == 0);
    CHECK(s.residency.stats().residentPages == torus().tables.pages.size());
    std::mt19937 random(2);
    checkAllowedStates(s, random, 10);
}

TEST_CASE("under any reader, any state that is allowed is whole, and the budget holds") {
    struct Case {
        uint32_t latest, fail, corrupt, silent;
        double share;
    };
    for (const Case& c : {Case{0, 0, 0, 0, 0.4}, Case{9, 0, 0, 0, 0.4}, Case{4, 25, 0, 0, 0.5}, Case{4, 0, 25, 0, 0.5},
                          Case{6, 15, 15, 1, 0.6}}) {
        Stage s(c.share);
        s.reader.latest = c.latest;
        REQUIRE(s.waitReady());
        s.reader.failPercent = c.fail;
        s.reader.corruptPercent = c.corrupt;
        s.reader.silentPercent = c.silent;
        std::mt19937 random(c.latest + c.fail);
        uint32_t failures = 0;
        std::vector<uint8_t> drawn(s.view().patchCount(), uint8_t(s.view().levelCount() - 1)), before = drawn;
        for (int frame = 0; frame < 120; ++frame) {
            const float angle = 0.05f * float(frame);
            s.residency.want(s.asset, {}, lookFrom({1.3f * std::cos(angle), 1.3f * std::sin(angle), 0.2f}), 1.0f);
            s.update();
            // What was drawn and may still be in flight is where it was.
            CHECK(streamedSurface(s, drawn) == plainSurface(drawn));
            before = drawn;
            for (uint32_t p = 0; p < drawn.size(); ++p) drawn[p] = uint8_t(s.view().finestLevel(p));
            if (frame % 10 == 0) checkAllowedStates(s, random, 1);
            s.residency.drawn(s.asset, drawn);
            const ResidencyStats stats = s.residency.stats();
            CHECK(stats.residentPages + stats.readingPages <= stats.slots);
            CHECK(stats.residentBytes <= s.residency.stats().slots * uint64_t(pageLimits(torus().tables).bytes));
            failures += uint32_t(s.residency.errors().size());
        }
        CHECK((failures > 0) == (c.fail + c.corrupt > 0));
        CHECK(s.residency.stats().evictions > 0);
    }
}

TEST_CASE("a page that fails is asked again, later and later, then given up with a remedy, until one asks to retry") {
    Stage s(1.3);
    REQUIRE(s.waitReady());
    s.reader.failPercent = 100;
    uint32_t given = 0;
    for (int i = 0; i < 400; ++i) {
        s.residency.want(s.asset, {}, lookFrom({0, 0, 1}), 1e-3f);
        s.update();
        for (const PageError& e : s.residency.errors()) {
            CHECK(!e.status.ok());
            CHECK(e.status.element == e.page);
            CHECK(std::strchr(e.status.message, ':') != nullptr);
            CHECK(e.givenUp == (e.failures == 5)); // four retries
            given += e.givenUp;
        }
    }
    CHECK(given > 0);
    CHECK(s.residency.stats().givenUpPages == given);
    const uint64_t reads = s.reader.reads;
    for (int i = 0; i < 50; ++i) s.update();
    CHECK(s.reader.reads == reads);
    CHECK(finePatches(s) == 0);
    s.reader.failPercent = 0;
    s.residency.retry(s.asset);
    for (int i = 0; i < 200; ++i) {
        s.residency.want(s.asset, {}, lookFrom({0, 0, 1}), 1e-3f);
        s.update();
    }
    CHECK(s.residency.stats().givenUpPages == 0);
    CHECK(finePatches(s) == s.view().patchCount());
}

TEST_CASE("a reader that never answers is reported, and others go on") {
    Stage s(1.3);
    REQUIRE(s.waitReady());
    s.reader.silentPercent = 100;
    uint32_t late = 0;
    for (int i = 0; i < 700; ++i) {
        s.residency.want(s.asset, {}, lookFrom({0, 0, 1}), 1e-3f);
        s.update();
        late += uint32_t(s.residency.errors().size());
        if (i == 10) s.reader.silentPercent = 0;
    }
    CHECK(late > 0);
    CHECK(s.residency.stats().readingPages == late);
    // All that could come has come.
    CHECK(s.residency.stats().residentPages + late == torus().tables.pages.size());
}

TEST_CASE("a page of wrong contents is refused, though its checksum fits, and nothing is drawn of it") {
    const StreamedTorus& t = torus();
    std::mt19937 random(23);
    uint32_t refused = 0;
    for (int i = 0; i < 60; ++i) {
        bake::AlignedBytes file = bake::alignedCopy(t.file.span());
        const format::PageRecord& page = t.tables.pages[random() % t.tables.pages.size()];
        for (int n = 0; n < 3; ++n) {
            const uint16_t value = uint16_t(random() % 3 ? random() % 700 : random());
            std::memcpy(file.writable().data() + page.offset + random() % (page.rawBytes / 2) * 2, &value, 2);
        }
        // The page table is a section before the pages: its checksums are made right by hand.
        auto* record = reinterpret_cast<format::PageRecord*>(
            file.writable().data() + (reinterpret_cast<const std::byte*>(&page) - t.file.span().data()));
        record->checksum = hashOf(file.span().subspan(page.offset, page.storedBytes));
        AssetView tables = t.tables;
        tables.bytes = file.span();
        tables.pages = {record - (&page - t.tables.pages.data()), t.tables.pages.size()};
        FakeReader reader;
        reader.file = file.span();
        Residency residency;
        REQUIRE(residency.create(configFor(reader, 1.3)).ok());
        uint32_t asset = 0;
        REQUIRE(residency.addAsset(tables, asset).ok());
        for (int frame = 0; frame < 60; ++frame) {
            residency.want(asset, {}, lookFrom({0, 0, 1}), 1e-3f);
            residency.update();
            reader.step(residency);
            for (const PageError& e : residency.errors()) refused += e.givenUp;
        }
        if (!residency.ready(asset)) continue;
        const AssetView& view = residency.view(asset);
        std::vector<uint8_t> levels(view.patchCount());
        for (uint32_t p = 0; p < levels.size(); ++p) levels[p] = uint8_t(view.finestLevel(p));
        std::vector<uint32_t> scratch(scratchCapacity(view)), out;
        for (uint32_t p = 0; p < levels.size(); ++p) {
            out.resize(indexCapacity(view, p, levels));
            const uint32_t count = buildIndices(view, p, levels, scratch, out);
            const auto isThere = [&](uint32_t row) {
                return residency.row(asset, format::StreamKind::position, 0, row) != nullptr;
            };
            CHECK(std::all_of(out.begin(), out.begin() + count, isThere));
        }
    }
    CHECK(refused > 10);
}

TEST_CASE("a page whose rows name joints that are not there is refused") {
    const test::PosedModel tube(test::tubeModel({16, 40}), 128, {.tiers = 3, .pageBytes = 8192});
    REQUIRE(tube.failure == "");
    bake::AlignedBytes file = bake::alignedCopy(tube.pages.span());
    AssetView tables;
    REQUIRE(openTables(file.span(), tables).ok());
    for (const bool altered : {false, true}) {
        for (const format::PageRecord& page : tables.pages) {
            if (!altered || page.tier != 2) continue;
            for (const format::StreamRecord& s : tables.streams.subspan(page.firstStream, page.streamCount)) {
                if (s.kind != format::StreamKind::joints) continue;
                std::memset(file.writable().data() + page.offset + s.offset, 0x7f, 2);
            }
            // Its record lies in the same bytes.
            const_cast<format::PageRecord&>(page).checksum = hashOf(file.span().subspan(page.offset, page.storedBytes));
        }
        FakeReader reader;
        reader.file = file.span();
        const PageLimits limits = pageLimits(tables);
        Residency residency;
        REQUIRE(residency.create({.pageBytes = limits.bytes, .pageRows = limits.rows, .reader = reader.reader()}).ok());
        uint32_t asset = 0, refused = 0;
        REQUIRE(residency.addAsset(tables, asset).ok());
        for (int frame = 0; frame < 40; ++frame) {
            residency.want(asset, {}, lookFrom({0, 0, 1}), 1e-3f);
            residency.update();
            reader.step(residency);
            for (const PageError& e : residency.errors())
                refused += e.givenUp && std::strstr(e.status.message, "joint");
        }
        CHECK(residency.ready(asset));
        CHECK((refused > 0) == altered);
        CHECK((residency.stats().residentPages == tables.pages.size()) != altered);
    }
}

TEST_CASE("answers may come from other threads, twice or to nobody") {
    FakeReader unused;
    ResidencyConfig config = configFor(unused, 1.3);
    struct Threads {
        Residency* residency = nullptr;
        std::vector<std::thread> all;
        static void read(void* user, const PageRequest& request) {
            auto& self = *static_cast<Threads*>(user);
            self.all.emplace_back([r = self.residency, request] {
                std::copy_n(torus().file.span().data() + request.offset, request.storedBytes, request.out.data());
                r->complete(request.ticket, true);
                r->complete(request.ticket, false);
                r->complete(request.ticket + (7ull << 32), false);
                r->complete(0xffffffffull, true);
            });
        }
    } threads;
    config.reader = {&Threads::read, &threads};
    config.patienceFrames = UINT32_MAX; // frames pass in no time here
    Residency residency;
    threads.residency = &residency;
    REQUIRE(residency.create(config).ok());
    uint32_t asset = 0;
    REQUIRE(residency.addAsset(torus().tables, asset).ok());
    for (int i = 0; i < 50000 && (i < 10 || residency.stats().wantedPages > 0 || !residency.ready(asset)); ++i) {
        residency.want(asset, {}, lookFrom({0, 0, 1}), 1e-3f);
        residency.update();
        CHECK(residency.errors().empty());
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    for (std::thread& t : threads.all) t.join();
    CHECK(residency.stats().residentPages == torus().tables.pages.size());
}

TEST_CASE("capacities are refused by name, with what would have sufficed") {
    FakeReader reader;
    const auto tryWith = [&](auto change) {
        ResidencyConfig config = configFor(reader, 1.0);
        change(config);
        Residency residency;
        Status s = residency.create(config);
        uint32_t id = 0;
        return s.ok() ? residency.addAsset(torus().tables, id) : s;
    };
    const auto says = [](const Status& s, const char* what) {
        return s.code == StatusCode::outOfCapacity && std::strstr(s.message, what) != nullptr;
    };
    CHECK(says(tryWith([](auto& c) { c.budgetBytes = 1; }), "budgetBytes"));
    CHECK(says(tryWith([](auto& c) { c.budgetBytes = 3 * c.pageBytes; }), "budgetBytes"));
    CHECK(says(tryWith([](auto& c) { c.pageBytes = 1000; }), "pageBytes"));
    CHECK(says(tryWith([](auto& c) { c.pageRows -= 1; }), "pageRows"));
    CHECK(says(tryWith([](auto& c) { c.pageCapacity = 3; }), "pageCapacity"));
    CHECK(tryWith([](auto& c) { c.reader = {}; }).code == StatusCode::badArgument);
    Residency residency;
    REQUIRE(residency.create(configFor(reader, 1.0)).ok());
    uint32_t id = 0;
    CHECK(residency.addAsset(torus().plain.view, id).code == StatusCode::badArgument);
    // Removed while pages are on their way, and added again.
    for (int i = 0; i < 5; ++i) {
        reader.file = torus().file.span();
        reader.latest = 3;
        REQUIRE(residency.addAsset(torus().tables, id).ok());
        for (int frame = 0; frame < 2 + 4 * i; ++frame) {
            residency.update();
            reader.step(residency);
        }
        residency.removeAsset(id);
    }
}

namespace {

/// What a frame of a renderer does, up to the GPU.
struct DrawnStage : Stage {
    static constexpr uint32_t kArena = 1u << 20;
    Scene scene;
    Selection selection;
    IndexCache cache;
    DrawList draws;
    std::vector<std::byte> staging = std::vector<std::byte>(48 * 1024), arena = std::vector<std::byte>(kArena);
    uint32_t instance = 0, far = 0;
    SelectionDesc desc;

    explicit DrawnStage(double share) : Stage(share) {
        REQUIRE(waitReady());
        DrawListConfig config;
        REQUIRE(scene.create(config.scene).ok());
        REQUIRE(selection.create(config.scene).ok());
        REQUIRE(draws.create(config).ok());
        REQUIRE(cache.create({.arenaBytes = kArena}).ok());
        uint32_t id = 0;
        REQUIRE(scene.addAsset({&view()}, id).ok());
        REQUIRE(cache.addAsset(id, view()).ok());
        REQUIRE(scene.addInstance(id, {}, instance).ok());
        glm::mat4 away(1);
        away[3] = {60, 0, 0, 1};
        REQUIRE(scene.addInstance(id, makePlacement(away), far).ok());
    }
    void frame(const glm::vec3& eye) {
        desc.view = lookFrom(eye);
        desc.pixels = 1;
        residency.want(scene, selection, desc);
        update();
        selection.update(scene, desc);
        cache.beginFrame(staging);
        draws.update(scene, selection, cache);
        cache.endFrame();
        residency.drawn(scene, draws);
        for (const CopyRange& c : cache.copies()) std::memcpy(&arena[c.arena], &staging[c.staging], c.bytes);
    }
    /// What the commands of the latest frame draw of the near instance.
    std::vector<Triangle> surface() const {
        std::vector<Triangle> out;
        for (const DrawBatch& batch : draws.batches()) {
            for (uint32_t d = batch.firstDraw; d < batch.firstDraw + batch.drawCount; ++d) {
                const DrawCommand& command = draws.draws()[d];
                const auto ids = draws.drawInstances().subspan(command.firstInstance, command.instanceCount);
                if (std::find(ids.begin(), ids.end(), instance) == ids.end()) continue;
                std::vector<uint32_t> rows;
                for (uint32_t i = command.firstIndex; i < command.firstIndex + command.indexCount; ++i) {
                    uint32_t row = 0;
                    std::memcpy(&row, &arena[size_t(i) * batch.indexBytes], batch.indexBytes);
                    rows.push_back(row + uint32_t(command.vertexOffset));
                }
                for (size_t i = 0; i < rows.size(); i += 3) {
                    out.push_back(test::triangleOf({position(rows[i]), position(rows[i + 1]), position(rows[i + 2])}));
                }
            }
        }
        std::sort(out.begin(), out.end());
        return out;
    }
    std::vector<Triangle> expected() const {
        std::vector<uint8_t> levels(view().patchCount());
        if (draws.kind(instance) == InstanceKind::whole) {
            scene.wholeLevels(scene.assetOf(instance), draws.wholeState(instance), levels);
        } else {
            const Levels drawn = draws.levels(instance);
            std::copy(drawn.begin(), drawn.end(), levels.begin());
        }
        return plainSurface(levels);
    }
};

} // namespace

TEST_CASE("along a flight each frame draws the whole surface at the levels that it has, with any reader and cache") {
    for (const uint32_t trouble : {0u, 20u}) {
        DrawnStage s(0.45);
        s.reader.latest = 5;
        s.reader.failPercent = s.reader.corruptPercent = trouble;
        std::mt19937 random(4);
        uint32_t fine = 0, whole = 0;
        for (int frame = 0; frame < 250; ++frame) {
            const float a = 0.04f * float(frame), r = frame % 100 < 70 ? 1.4f : 90.0f;
            s.frame({r * std::cos(a), r * std::sin(a), 0.3f});
            const std::vector<Triangle> surface = s.surface();
            CHECK(surface == s.expected());
            fine += s.draws.kind(s.instance) == InstanceKind::mixed &&
                    std::ranges::min(s.draws.levels(s.instance)) < torus().tables.tierLevels[1];
            whole += s.draws.kind(s.instance) == InstanceKind::whole;
            // The GPU may still read it while the next update runs.
            s.residency.update();
            CHECK(s.surface() == surface);
            s.residency.drawn(s.scene, s.draws);
        }
        CHECK(fine > 20);
        CHECK(whole > 0);
        CHECK(s.residency.stats().evictions > 0);
    }
}

TEST_CASE("no frame allocates") {
    DrawnStage s(0.45);
    s.reader.latest = 2;
    s.reader.failPercent = 5;
    uint64_t before = test::allocations;
    for (int frame = 0; frame < 60; ++frame) {
        const float a = 0.1f * float(frame);
        s.frame({1.4f * std::cos(a), 1.4f * std::sin(a), 0.3f});
    }
    CHECK(test::allocations == before);
    CHECK(s.residency.stats().evictions > 0);
}
