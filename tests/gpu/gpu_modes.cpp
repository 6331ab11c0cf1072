// What the colouring modes promise: the error that is seen against the error that is allowed, and a part that stands
// out.
#include "gpu_test.h"

#include "meshes/baked_model.h"

#include <algorithm>

namespace {

using namespace xgc;
using namespace xgc::test;

constexpr uint32_t kSide = 160;

const BakedModel& creature() {
    static const BakedModel model(bake::BundledModel::creature, 2000, 200);
    return model;
}

/// A view of the whole creature that measures what it sees itself.
vulkan::ViewDesc viewOf(const AssetView& asset, vulkan::ShadingMode mode, float errorPixels) {
    vulkan::ViewDesc view;
    vulkan::Framing framing;
    framing.towards = {0.4f, 0.5f, 0.9f};
    view.camera = vulkan::frame(asset.positions, framing);
    view.mode = mode;
    view.measured = makeView(view.camera.eye, view.camera.fovY, kSide);
    view.errorPixels = errorPixels;
    return view;
}

struct Counts {
    uint32_t drawn = 0;
    uint32_t neutral = 0; ///< grey to white, as the light tints it
    uint32_t bluish = 0, reddish = 0;
};
Counts countsOf(const Picture& picture) {
    Counts out;
    for (const glm::u8vec4& p : picture.pixels) {
        if (isMagenta(p)) continue;
        ++out.drawn;
        out.neutral += 5 * (std::max({p.r, p.g, p.b}) - std::min({p.r, p.g, p.b})) < std::max({p.r, p.g, p.b});
        out.bluish += p.b > p.r;
        out.reddish += p.r > p.b;
    }
    return out;
}

} // namespace

TEST_CASE("mode error is indigo without error, warm near what is allowed, and white past it") {
    Gpu gpu;
    if (!gpu.present) return;
    REQUIRE(creature().failure.empty());
    const AssetView& asset = creature().view;
    Stage stage(gpu, {}, singleSampled(kSide, kSide));
    const auto errorMode = [&](float pixels) { return viewOf(asset, vulkan::ShadingMode::error, pixels); };
    const vulkan::InstanceHandle instance = stage.place(asset, makePlacement(glm::mat4(1)), errorMode(1));

    const std::vector<uint8_t> finest(asset.patchCount(), 0),
        coarse(asset.patchCount(), uint8_t(asset.levelCount() - 3));
    const Counts none = countsOf(stage.draw(instance, finest, errorMode(1)));
    REQUIRE(none.drawn > 2000);
    CHECK(none.bluish == none.drawn);
    CHECK(none.neutral == 0);

    const float worst = projectedError(asset, {}, errorMode(1).measured, coarse);
    REQUIRE(worst > 0);
    const Counts allowed = countsOf(stage.draw(instance, coarse, errorMode(1.01f * worst)));
    CHECK(allowed.neutral == 0);
    CHECK(allowed.reddish > 0);
    const Counts past = countsOf(stage.draw(instance, coarse, errorMode(worst / 1000)));
    CHECK(past.neutral > 9 * past.drawn / 10); // a patch may have no error at this level
}

TEST_CASE("the part that is pointed at stands out, in its instance alone") {
    Gpu gpu;
    if (!gpu.present) return;
    const AssetView& asset = creature().view;
    Stage stage(gpu, {}, singleSampled(kSide, kSide));
    vulkan::ViewDesc view = viewOf(asset, vulkan::ShadingMode::shaded, 1);
    const vulkan::InstanceHandle instance = stage.place(asset, makePlacement(glm::mat4(1)), view);
    const std::vector<uint8_t> levels(asset.patchCount(), 3);
    const Picture plain = stage.draw(instance, levels, view);
    view.highlightPart = 0;
    view.highlightInstance = instance.index + 1;
    CHECK(stage.draw(instance, levels, view).pixels == plain.pixels);
    view.highlightInstance = instance.index;
    const Picture lit = stage.draw(instance, levels, view);
    uint32_t changed = 0, warmer = 0;
    for (size_t i = 0; i < lit.pixels.size(); ++i) {
        if (lit.pixels[i] == plain.pixels[i]) continue;
        ++changed;
        warmer += lit.pixels[i].r - lit.pixels[i].b > plain.pixels[i].r - plain.pixels[i].b;
    }
    CHECK(changed > 50);
    CHECK(changed < countsOf(plain).drawn); // the other parts stay
    CHECK(warmer == changed);
}
