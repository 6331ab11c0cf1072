#include "gpu_test.h"

#include "meshes/baked_model.h"
#include "meshes/patched_torus.h"

#include <xgc/morph.h>

#include <algorithm>
#include <limits>
#include <random>

namespace {

using namespace xgc;
using namespace xgc::test;

vulkan::RendererConfig morphingConfig(const AssetView& asset) {
    vulkan::RendererConfig config;
    config.morphGroupCapacity = groupCount(asset);
    return config;
}

struct State {
    std::vector<uint8_t> levels;
    std::vector<float> fractions;
};

State randomState(const AssetView& asset, std::mt19937& random) {
    State state;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        state.levels.push_back(uint8_t(random() % asset.levelCount()));
        const bool last = uint32_t(state.levels.back()) + 1 == asset.levelCount();
        state.fractions.push_back(last ? 0 : kMaxFraction * float(random() % 1001) / 1000);
    }
    return state;
}

Picture drawMorphed(Stage& stage, vulkan::InstanceHandle instance, const State& state, const vulkan::ViewDesc& view) {
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    XGC_REQUIRE_OK(stage.renderer.setLevels(instance, state.levels, state.fractions));
    stage.renderer.endFrame();
    REQUIRE(stage.renderer.stats().deferredInstances == 0);
    return stage.read(stage.submit(view));
}

struct Difference {
    double mean = 0;     ///< over pixels, of the largest channel
    uint32_t pixels = 0; ///< that differ by more than a twentieth
};

Difference differenceOf(const Picture& a, const Picture& b) {
    Difference out;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        int most = 0;
        for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(int(a.pixels[i][k]) - int(b.pixels[i][k])));
        out.mean += most;
        out.pixels += most > 12;
    }
    out.mean /= double(a.pixels.size());
    return out;
}

vulkan::ViewDesc viewOf(const AssetView& asset) {
    vulkan::ViewDesc view;
    vulkan::Framing framing;
    framing.towards = {0.4f, 0.5f, 0.9f};
    view.camera = vulkan::frame(asset.positions, framing);
    return view;
}

} // namespace

TEST_CASE("from inside a closed surface no morph lets the background through") {
    const Gpu gpu;
    if (!gpu.present) return;
    const OpenAsset torus = openBuilt(patchedTorus({}));
    REQUIRE(torus.failure == "");
    Stage stage(gpu, morphingConfig(torus.view), singleSampled(160, 160));
    vulkan::ViewDesc view;
    view.camera.eye = {2, 0, 0}; // in the middle of the tube, whatever the levels
    view.camera.fovY = 1.6f;
    view.camera.up = {0.3f, 0.5f, 0.7f};
    const vulkan::InstanceHandle instance = stage.place(torus.view, {}, view);
    std::mt19937 random(2);
    const glm::vec3 directions[] = {{1, 0.1f, 0.2f}, {-1, 0.2f, 0.1f}, {0.1f, 1, 0}, {0, -1, 0.1f}, {0.1f, 0, 1}};
    for (int i = 0; i < 6; ++i) {
        const State state = randomState(torus.view, random);
        for (const glm::vec3& direction : directions) {
            view.camera.target = view.camera.eye + direction;
            const Picture picture = drawMorphed(stage, instance, state, view);
            CHECK(std::count_if(picture.pixels.begin(), picture.pixels.end(), isMagenta) == 0);
        }
    }
}

TEST_CASE("at fraction zero the picture is that of the levels, and at the end all but that of the next ones") {
    const Gpu gpu;
    if (!gpu.present) return;
    const BakedModel model(bake::BundledModel::creature, 3000, 256);
    REQUIRE(model.failure == "");
    const AssetView& asset = model.view;
    const vulkan::ViewDesc view = viewOf(asset);
    Stage stage(gpu, morphingConfig(asset), singleSampled(200, 160));
    const vulkan::InstanceHandle instance = stage.place(asset, {}, view);
    const uint32_t first = asset.levelCount() - 9; // finer ones look alike
    for (uint32_t level = first; level + 1 < asset.levelCount(); level += 2) {
        const std::vector<uint8_t> levels(asset.patchCount(), uint8_t(level)),
            coarser(asset.patchCount(), uint8_t(level + 1));
        const Picture plain = stage.draw(instance, levels, view), next = stage.draw(instance, coarser, view);
        const auto at = [&](float fraction) {
            return drawMorphed(stage, instance, {levels, std::vector<float>(levels.size(), fraction)}, view);
        };
        CHECK(at(0).pixels == plain.pixels);
        const Difference apart = differenceOf(plain, next), end = differenceOf(at(kMaxFraction), next),
                         half = differenceOf(at(0.5f), next);
        INFO(level << ": apart " << apart.mean << ", half way " << half.mean << ", at the end " << end.mean);
        CHECK(apart.mean > 0.01);
        CHECK(end.mean < 0.1 * apart.mean);
        CHECK(half.mean < apart.mean);
        CHECK(half.mean > end.mean);
    }
}

TEST_CASE("what has no room for its lambdas is drawn at its levels, and is counted") {
    const Gpu gpu;
    if (!gpu.present) return;
    const OpenAsset torus = openBuilt(patchedTorus({}));
    const vulkan::ViewDesc view = viewOf(torus.view);
    std::mt19937 random(3);
    const State state = randomState(torus.view, random);
    vulkan::RendererConfig config = morphingConfig(torus.view);
    Stage enough(gpu, config, singleSampled(64, 64));
    const vulkan::InstanceHandle one = enough.place(torus.view, {}, view);
    const Picture morphed = drawMorphed(enough, one, state, view), plain = enough.draw(one, state.levels, view);
    CHECK(morphed.pixels != plain.pixels);
    for (const uint32_t capacity : {config.morphGroupCapacity - 1, 0u}) {
        config.morphGroupCapacity = capacity;
        Stage stage(gpu, config, singleSampled(64, 64));
        const vulkan::InstanceHandle instance = stage.place(torus.view, {}, view);
        CHECK(drawMorphed(stage, instance, state, view).pixels == plain.pixels);
        CHECK(stage.renderer.stats().unmorphedInstances == (capacity > 0 ? 1 : 0));
    }
}

namespace {

/// Differences of consecutive frames of a slow flight, in order, the largest last.
struct Flight {
    std::vector<double> means;
    std::vector<uint32_t> pixels;
};

/// Turns the camera back to where it was: the difference is what the levels do, not the camera. Every frame chooses
/// levels for its own distance and is drawn from one place.
Flight flySlowly(const Gpu& gpu, const AssetView& asset, bool morphs) {
    Stage stage(gpu, morphingConfig(asset), singleSampled(320, 240));
    vulkan::ViewDesc view = viewOf(asset);
    stage.place(asset, {}, view);
    Flight flight;
    Picture before;
    const glm::vec3 eye = view.camera.eye, target = view.camera.target;
    for (int i = 0; i < 20; ++i) {
        SelectionDesc desc;
        desc.view = makeView(target + (eye - target) * (8 * std::pow(0.992f, float(i))), view.camera.fovY, 240);
        desc.pixels = 1;
        desc.morph = morphs;
        desc.wholeBeyond = std::numeric_limits<float>::infinity();
        XGC_REQUIRE_OK(stage.renderer.beginFrame());
        stage.renderer.select(0, desc);
        stage.renderer.endFrame();
        REQUIRE(stage.renderer.stats().deferredInstances == 0);
        const Picture picture = stage.read(stage.submit(view));
        if (i > 0) {
            const Difference difference = differenceOf(before, picture);
            flight.means.push_back(difference.mean);
            flight.pixels.push_back(difference.pixels);
        }
        before = picture;
    }
    std::sort(flight.means.begin(), flight.means.end());
    std::sort(flight.pixels.begin(), flight.pixels.end());
    return flight;
}

} // namespace

TEST_CASE("along a slow flight consecutive frames differ little, and without morphs they jump") {
    const Gpu gpu;
    if (!gpu.present) return;
    const BakedModel model(bake::BundledModel::creature, 6000, 256);
    REQUIRE(model.failure == "");
    const Flight with = flySlowly(gpu, model.view, true), without = flySlowly(gpu, model.view, false);
    INFO("largest mean difference of 255: with " << with.means.back() << ", without " << without.means.back());
    INFO("most pixels that jump: with " << with.pixels.back() << ", without " << without.pixels.back());
    MESSAGE("consecutive frames");
    CHECK(with.means.back() < 0.6 * without.means.back());
    CHECK(with.pixels.back() < without.pixels.back() / 2);
    CHECK(with.means.front() >= 0);
}
