#include "gpu_test.h"

#include "meshes/posed_model.h"
#include "meshes/streamed_torus.h"

#include <xgc/vulkan/camera.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace xgc;
using namespace xgc::test;

const StreamedTorus& torus() {
    static const StreamedTorus made({.patches = 6, .levels = 4}, {.tiers = 4, .pageBytes = 4096});
    REQUIRE_MESSAGE(made.failure.empty(), made.failure);
    return made;
}

ResidencyConfig configFor(FakeReader& reader, const AssetView& tables, double share) {
    reader.file = tables.bytes;
    const PageLimits limits = pageLimits(tables);
    ResidencyConfig config;
    config.pageBytes = limits.bytes;
    config.pageRows = limits.rows;
    config.budgetBytes = uint64_t(share * double(tables.pages.size()) * (limits.bytes + limits.rows + 64.0));
    config.readBytes = 8ull * limits.bytes;
    config.installBytes = 3ull * limits.bytes;
    config.reader = reader.reader();
    return config;
}

vulkan::ViewDesc lookFrom(const glm::vec3& eye) {
    vulkan::ViewDesc view;
    view.camera.eye = eye;
    view.camera.target = {0, 0, 0};
    view.camera.up = {0.1f, 0.2f, 1};
    return view;
}

/// An asset streamed, and beside it the same in memory as a whole.
struct Pair {
    const AssetView& tables;
    FakeReader reader;
    Residency residency;
    uint32_t asset = 0;
    Stage streamed, whole;
    vulkan::InstanceHandle instance, other;

    static vulkan::OffscreenDesc target() { return singleSampled(200, 160); }
    vulkan::RendererConfig streamedConfig(double share) {
        XGC_REQUIRE_OK(residency.create(configFor(reader, tables, share)));
        XGC_REQUIRE_OK(residency.addAsset(tables, asset));
        vulkan::RendererConfig config = wholeConfig();
        config.residency = &residency;
        config.streamedJointSets = 1;
        return config;
    }
    static vulkan::RendererConfig wholeConfig() {
        vulkan::RendererConfig config;
        config.jointCapacity = 16;
        config.morphWeightCapacity = 16;
        return config;
    }

    Pair(const Gpu& gpu, double share) : Pair(gpu, torus().tables, torus().plain.view, share) {}
    Pair(const Gpu& gpu, const AssetView& cut, const AssetView& plain, double share)
        : tables(cut), streamed(gpu, streamedConfig(share), target()), whole(gpu, wholeConfig(), target()) {
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(streamed.renderer.addStreamedAsset(asset, handle));
        CHECK_FALSE(streamed.renderer.resident(handle));
        XGC_REQUIRE_OK(streamed.renderer.addInstance(handle, {}, instance));
        other = whole.place(plain, {}, {});
        for (int i = 0; i < 100 && !streamed.renderer.resident(handle); ++i) (void)frame({9, 0, 0}, 1e6f);
        REQUIRE(streamed.renderer.resident(handle));
    }

    /// What a frame draws that wants errors of so many pixels.
    Picture frame(const glm::vec3& eye, float pixels) {
        const vulkan::ViewDesc view = lookFrom(eye);
        SelectionDesc desc;
        desc.view = makeView(eye, view.camera.fovY, 160);
        desc.pixels = pixels;
        desc.wholeBeyond = 1000;
        vulkan::Renderer& renderer = streamed.renderer;
        residency.want(renderer.scene(), renderer.selection(), desc);
        XGC_REQUIRE_OK(renderer.beginFrame());
        reader.step(residency);
        renderer.select(0, desc);
        renderer.endFrame();
        REQUIRE(renderer.stats().deferredInstances == 0);
        return streamed.read(streamed.submit(view));
    }
    Levels levels() const { return streamed.renderer.drawList().levels(instance.index); }
    bool drawn() const { return streamed.renderer.drawList().kind(instance.index) == InstanceKind::mixed; }
};

/// Lists of the same faces may begin them at other corners, so what is interpolated is rounded differently.
constexpr int kRounding = 3;

} // namespace

TEST_CASE("along a flight, a streamed asset looks as one in memory does at the same levels, under any reader") {
    const Gpu gpu;
    if (!gpu.present) return;
    for (const uint32_t trouble : {0u, 15u}) {
        Pair pair(gpu, 0.5);
        pair.reader.latest = trouble / 3;
        pair.reader.failPercent = pair.reader.corruptPercent = trouble;
        uint32_t fine = 0, changes = 0;
        size_t wrong = 0;
        std::vector<uint8_t> before;
        for (int i = 0; i < 80; ++i) {
            const float a = 0.1f * float(i);
            const glm::vec3 eye(4.2f * std::cos(a), 4.2f * std::sin(a), 1.5f);
            const Picture picture = pair.frame(eye, 0.3f);
            REQUIRE(pair.drawn());
            const Levels levels = pair.levels();
            wrong += pixelsApart(picture, pair.whole.draw(pair.other, levels, lookFrom(eye)), kRounding);
            fine += std::ranges::min(levels) < torus().tables.tierLevels[0];
            changes += !std::ranges::equal(levels, before);
            before.assign(levels.begin(), levels.end());
        }
        CHECK(wrong == 0);
        CHECK(fine > 10);
        CHECK(changes > 10);
        CHECK(pair.residency.stats().evictions > 10);
        CHECK((pair.residency.stats().failures > 0) == (trouble > 0));
    }
}

TEST_CASE("with room for all pages a streamed asset becomes what is asked for, and nothing more is sent") {
    const Gpu gpu;
    if (!gpu.present) return;
    Pair pair(gpu, 1.3);
    const glm::vec3 eye(4, 1, 2);
    for (int i = 0; i < 100; ++i) (void)pair.frame(eye, 1e-4f);
    CHECK(std::ranges::max(pair.levels()) == 0);
    CHECK(pair.residency.stats().wantedPages == 0);
    const Picture picture = pair.frame(eye, 1e-4f);
    CHECK(pair.streamed.renderer.stats().uploadBytes == 0);
    CHECK(pixelsApart(picture, pair.whole.draw(pair.other, pair.levels(), lookFrom(eye)), kRounding) == 0);
}

TEST_CASE("a streamed asset has its colours, and moves by its joints") {
    const Gpu gpu;
    if (!gpu.present) return;
    bake::Model model = tubeModel({24, 60});
    for (const glm::vec3& p : model.positions) {
        model.attributes.colors[0].emplace_back(0.25f * p.y, 0.5f + 0.5f * p.x, 0.3f, 1);
    }
    const PosedModel tube(model, 128, {.tiers = 4, .pageBytes = 8192});
    REQUIRE(tube.failure == "");
    AssetView tables;
    XGC_REQUIRE_OK(openTables(tube.pages.span(), tables));
    Pair pair(gpu, tables, tube.view, 0.6);
    std::mt19937 random(5);
    std::vector<uint8_t> before;
    uint32_t changes = 0;
    for (int i = 0; i < 12; ++i) {
        const RandomPose pose(tube.view, random, 0.5f);
        XGC_REQUIRE_OK(pair.streamed.renderer.setPose(pair.instance, {pose.joints, {}}));
        XGC_REQUIRE_OK(pair.whole.renderer.setPose(pair.other, {pose.joints, {}}));
        CHECK(pair.streamed.renderer.setPose(pair.instance, pose.pose()).code == StatusCode::unsupported);
        const glm::vec3 eye(6, float(i % 4), 3);
        const Picture picture = pair.frame(eye, 0.3f);
        REQUIRE(pair.drawn());
        CHECK(pixelsApart(picture, pair.whole.draw(pair.other, pair.levels(), lookFrom(eye)), kRounding) <= 2);
        changes += !std::ranges::equal(pair.levels(), before);
        before.assign(pair.levels().begin(), pair.levels().end());
    }
    CHECK(changes > 1);
}

TEST_CASE("an asset can go and come again") {
    const Gpu gpu;
    if (!gpu.present) return;
    Pair pair(gpu, 0.6);
    vulkan::Renderer& renderer = pair.streamed.renderer;
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 20; ++i) (void)pair.frame({4, 1, 2}, 0.3f);
        XGC_REQUIRE_OK(renderer.removeInstance(pair.instance));
        XGC_REQUIRE_OK(renderer.removeAsset({0, 2 * uint32_t(round) + 1}));
        for (int i = 0; i < 2; ++i) (void)pair.frame({4, 1, 2}, 0.3f);
        pair.residency.removeAsset(pair.asset);
        XGC_REQUIRE_OK(pair.residency.addAsset(torus().tables, pair.asset));
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(renderer.addStreamedAsset(pair.asset, handle));
        XGC_REQUIRE_OK(renderer.addInstance(handle, {}, pair.instance));
        Picture picture;
        for (int i = 0; i < 100 && !(renderer.resident(handle) && pair.drawn()); ++i)
            picture = pair.frame({4, 1, 2}, 0.3f);
        REQUIRE(renderer.resident(handle));
        CHECK(pixelsApart(picture, pair.whole.draw(pair.other, pair.levels(), lookFrom({4, 1, 2})), kRounding) == 0);
    }
}

TEST_CASE("what does not fit together is refused by name") {
    const Gpu gpu;
    if (!gpu.present) return;
    FakeReader reader;
    const auto create = [&](auto change, bool updated = false) {
        ResidencyConfig pool = configFor(reader, torus().tables, 1.3);
        vulkan::RendererConfig config;
        change(pool, config);
        Residency residency;
        XGC_REQUIRE_OK(residency.create(pool));
        uint32_t asset = 0;
        XGC_REQUIRE_OK(residency.addAsset(torus().tables, asset));
        for (int i = 0; updated && i < 10; ++i) {
            residency.update();
            reader.step(residency);
        }
        config.residency = &residency;
        vulkan::Renderer renderer;
        return renderer.create(gpu.context, config);
    };
    CHECK(create([](auto&, auto&) {}).ok());
    Status s = create([](ResidencyConfig& pool, auto&) { pool.framesInFlight = 1; });
    CHECK(s.code == StatusCode::badArgument);
    CHECK(s.element == 2);
    s = create([](ResidencyConfig& pool, vulkan::RendererConfig& config) {
        config.stagingBytes = 1 << 20;
        pool.installBytes = 3 << 20;
    });
    CHECK(s.code == StatusCode::outOfCapacity);
    CHECK(s.element == 6 << 20);
    CHECK(create([](auto&, auto&) {}, true).code == StatusCode::badArgument);

    vulkan::Renderer renderer;
    XGC_REQUIRE_OK(renderer.create(gpu.context, {}));
    vulkan::AssetHandle handle;
    CHECK(renderer.addStreamedAsset(0, handle).code == StatusCode::badArgument);
    Residency residency;
    XGC_REQUIRE_OK(residency.create(configFor(reader, torus().tables, 1.3)));
    uint32_t asset = 0;
    XGC_REQUIRE_OK(residency.addAsset(torus().tables, asset));
    CHECK(renderer.addAsset(residency.view(asset), handle).code == StatusCode::badArgument);
}
