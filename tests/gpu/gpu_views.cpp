#include "gpu_test.h"

#include "meshes/patched_torus.h"

#include <glm/gtc/matrix_transform.hpp>

namespace {

using namespace xgc;
using namespace xgc::test;

/// A row of toruses that goes away from the eye, the last ones far enough to be drawn as wholes.
struct Row {
    OpenAsset torus = openBuilt(patchedTorus({.patches = 4, .levels = 4}));
    std::vector<vulkan::InstanceHandle> instances;
    vulkan::ViewDesc view;

    Row(Stage& stage) {
        REQUIRE(torus.failure == "");
        view.camera.eye = {0, 0, 9};
        view.camera.target = {0, 0, 0};
        view.camera.nearPlane = 0.1f;
        instances.push_back(stage.place(torus.view, placed(0), view));
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(stage.renderer.addAsset(torus.view, handle));
        for (int i = 1; i < 8; ++i) {
            XGC_REQUIRE_OK(stage.renderer.addInstance(handle, placed(i), instances.emplace_back()));
        }
        for (int i = 0; i < 10; ++i) frame(stage, true);
    }
    static Placement placed(int i) {
        return makePlacement(glm::translate(glm::mat4(1), glm::vec3(2.3f * float(i), float(i), -14.0f * float(i))));
    }
    SelectionDesc desc(float pixels) const {
        SelectionDesc out;
        out.view = makeView(view.camera.eye, view.camera.fovY, 160);
        out.pixels = pixels;
        out.frustum = makeFrustum(view.camera.worldToClip());
        return out;
    }
    /// By policy, or as they were chosen before.
    Picture frame(Stage& stage, bool byPolicy, float pixels = 1) {
        XGC_REQUIRE_OK(stage.renderer.beginFrame());
        if (byPolicy) stage.renderer.select(0, desc(pixels));
        stage.renderer.endFrame();
        return stage.read(stage.submit(view));
    }
};

} // namespace

TEST_CASE("instances that are drawn as wholes give the picture that their levels give by patches") {
    const Gpu gpu;
    if (!gpu.present) return;
    Stage stage(gpu, {}, singleSampled(240, 160));
    Row row(stage);
    const Picture policy = row.frame(stage, true);
    CHECK(stage.renderer.stats().deferredInstances == 0);
    const Selection& selection = stage.renderer.selection();
    const uint32_t wholes = selection.stats().wholeInstances, draws = stage.renderer.stats().draws;
    CHECK(wholes > 2);
    CHECK(selection.stats().visibleInstances > wholes);

    std::vector<std::vector<uint8_t>> levels;
    const Scene& scene = stage.renderer.scene();
    for (const vulkan::InstanceHandle& instance : row.instances) {
        std::vector<uint8_t>& own = levels.emplace_back(row.torus.view.patchCount());
        const InstanceKind kind = selection.kind(instance.index);
        if (kind == InstanceKind::whole) {
            scene.wholeLevels(scene.assetOf(instance.index), selection.wholeState(instance.index), own);
        } else if (kind == InstanceKind::mixed) {
            std::copy(selection.levels(instance.index).begin(), selection.levels(instance.index).end(), own.begin());
        }
    }
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    for (size_t i = 0; i < levels.size(); ++i) {
        XGC_REQUIRE_OK(stage.renderer.setLevels(row.instances[i], levels[i]));
    }
    stage.renderer.endFrame();
    const Picture patches = stage.read(stage.submit(row.view));
    CHECK(stage.renderer.stats().draws > draws);
    CHECK(patches.pixels == policy.pixels);
    CHECK(std::count_if(policy.pixels.begin(), policy.pixels.end(), isMagenta) < 240 * 160 * 19 / 20);
}

TEST_CASE("two views of a frame have levels of their own") {
    const Gpu gpu;
    if (!gpu.present) return;
    vulkan::RendererConfig config;
    config.viewCapacity = 2;
    Stage stage(gpu, config, singleSampled(240, 160));
    Row row(stage);
    const Picture fine = row.frame(stage, true, 0.25f);
    const Picture coarse = row.frame(stage, true, 20);
    CHECK(fine.pixels != coarse.pixels);
    for (const uint32_t shown : {0u, 1u, 0u}) {
        XGC_REQUIRE_OK(stage.renderer.beginFrame());
        stage.renderer.select(0, row.desc(0.25f));
        stage.renderer.select(1, row.desc(20));
        stage.renderer.endFrame();
        vulkan::ViewDesc view = row.view;
        view.view = shown;
        const Picture picture = stage.read(stage.submit(view));
        CHECK(picture.pixels == (shown == 0 ? fine.pixels : coarse.pixels));
    }
    vulkan::ViewDesc none = row.view;
    none.view = 2;
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    stage.renderer.endFrame();
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    XGC_REQUIRE_OK(stage.offscreen.begin(cmd));
    stage.renderer.recordTransfers(cmd);
    stage.offscreen.beginRendering(cmd, kMagenta);
    CHECK(stage.renderer.recordDraws(cmd, none).code == StatusCode::outOfCapacity);
    stage.offscreen.endRendering(cmd);
    uint64_t frame = 0;
    XGC_REQUIRE_OK(stage.offscreen.submit(std::array{stage.renderer.frameDone()}, frame));
    stage.read(frame);
}

TEST_CASE("hidden parts and invisible instances are not drawn, and come back") {
    const Gpu gpu;
    if (!gpu.present) return;
    Stage stage(gpu, {}, singleSampled(240, 160));
    Row row(stage);
    const Picture before = row.frame(stage, true);
    const auto background = [](const Picture& p) { return std::count_if(p.pixels.begin(), p.pixels.end(), isMagenta); };
    XGC_REQUIRE_OK(stage.renderer.setPart(row.instances[0], 3, {.hidden = true}));
    const Picture hidden = row.frame(stage, true);
    CHECK(background(hidden) > background(before));
    XGC_REQUIRE_OK(stage.renderer.clearParts(row.instances[0]));
    XGC_REQUIRE_OK(stage.renderer.setVisible(row.instances[0], false));
    CHECK(background(row.frame(stage, true)) > background(hidden));
    XGC_REQUIRE_OK(stage.renderer.setVisible(row.instances[0], true));
    CHECK(row.frame(stage, true).pixels == before.pixels);
    CHECK_FALSE(stage.renderer.setPart(row.instances[0], 99, {}).ok());
}
