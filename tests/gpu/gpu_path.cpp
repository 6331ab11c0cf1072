#include "gpu_test.h"

#include "meshes/patched_torus.h"
#include "meshes/posed_model.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cstring>
#include <random>

// The renderer with the compute path: the same pictures as without, with occlusion or not, and what it does where the
// path is not to be had.

namespace {

using namespace xgc;
using namespace xgc::test;

/// A torus with patches that an alpha test drops.
struct Sieve {
    OpenAsset torus = openBuilt(patchedTorus({.patches = 4, .levels = 4}));
    AssetView view = torus.view;
    std::vector<format::MaterialRecord> materials{view.materials.begin(), view.materials.end()};
    std::vector<float> cutoffs = std::vector<float>(materials.size(), 0.5f);

    Sieve() {
        materials[1].flags = format::kAlphaMask;
        materials[1].baseColor[3] = 0.25f;
        view.materials = materials;
        view.alphaCutoffs = cutoffs;
    }
};

/// Baked once.
const PosedModel& bakedTube() {
    static const PosedModel tube(tubeModel({24, 60}), 128);
    return tube;
}

/// Toruses near, and far ones behind a wall of two large flat ones. Tubes bend, and come from behind it and go there,
/// by their poses.
class Field {
public:
    explicit Field(Stage& stage) : stage_(stage) {
        REQUIRE(torus_.failure == "");
        view.camera.eye = {0, 0, 12};
        view.camera.nearPlane = 0.1f;
        stage.place(torus_.view, placed(0), view);
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(stage.renderer.addAsset(torus_.view, handle));
        vulkan::AssetHandle sieve;
        XGC_REQUIRE_OK(stage.renderer.addAsset(sieve_.view, sieve));
        for (int i = 1; i < 40; ++i) {
            XGC_REQUIRE_OK(
                stage.renderer.addInstance(i % 4 == 2 ? sieve : handle, placed(i), instances.emplace_back()));
        }
        for (const float x : {0.0f, 16.0f}) {
            glm::mat4 m = glm::translate(glm::mat4(1), glm::vec3(x, 0, -12));
            m = glm::scale(m, glm::vec3(8, 8, 0.5f));
            XGC_REQUIRE_OK(stage.renderer.addInstance(handle, makePlacement(m), instances.emplace_back()));
        }
        REQUIRE(tube_.failure == "");
        tubes_.push_back(stage.place(tube_.view, standing(0), view));
        XGC_REQUIRE_OK(stage.renderer.addAsset(tube_.view, handle));
        while (!stage.renderer.resident(handle)) frame(0);
        for (int i = 1; i < 6; ++i) {
            XGC_REQUIRE_OK(stage.renderer.addInstance(handle, standing(i), tubes_.emplace_back()));
        }
    }

    vulkan::ViewDesc view;
    SelectionDesc desc;
    std::vector<vulkan::InstanceHandle> instances;

    /// Looks from a place that depends on the time.
    Picture frame(float t) {
        view.camera.eye = {9 * std::sin(t), 2 * std::sin(3 * t), 9 * std::cos(t)};
        view.camera.target = {2 * std::cos(5 * t), 0, -4};
        desc.view = makeView(view.camera.eye, view.camera.fovY, 160);
        desc.frustum = makeFrustum(view.camera.worldToClip());
        XGC_REQUIRE_OK(stage_.renderer.beginFrame());
        for (size_t i = 0; i < tubes_.size(); ++i) pose(i, t);
        stage_.renderer.select(0, desc);
        stage_.renderer.endFrame();
        return occludes ? drawInTwo() : stage_.read(stage_.submit(view));
    }
    bool occludes = false;

private:
    static Placement placed(int i) {
        std::mt19937 random(uint32_t(i) + 1);
        const auto next = [&] { return float(random() % 1000) / 1000; };
        const float away = i < 12 ? 4.0f : 60.0f;
        glm::mat4 m = glm::translate(glm::mat4(1), away * glm::vec3(next() - 0.5f, next() - 0.5f, -next()));
        return makePlacement(glm::rotate(m, 6 * next(), glm::normalize(glm::vec3(next(), next(), 1))));
    }
    static Placement standing(int i) {
        return makePlacement(glm::translate(glm::mat4(1), glm::vec3(4 * i - 8, -1, i % 2 ? -4 : -18)));
    }
    /// Every third stands unposed at times.
    void pose(size_t i, float t) {
        const float at = std::sin(9 * t + 2 * float(i));
        if (i % 3 == 0 && at < -0.5f) {
            XGC_REQUIRE_OK(stage_.renderer.clearPose(tubes_[i]));
            return;
        }
        std::mt19937 random(uint32_t(i) + 1);
        RandomPose pose(tube_.view, random, 0.7f * at);
        for (glm::mat4x3& m : pose.joints) m[3] += glm::vec3(0, 9 * at, 0);
        XGC_REQUIRE_OK(stage_.renderer.setPose(tubes_[i], pose.pose()));
    }
    Picture drawInTwo() {
        vulkan::Renderer& renderer = stage_.renderer;
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        XGC_REQUIRE_OK(stage_.offscreen.begin(cmd));
        renderer.recordTransfers(cmd);
        stage_.offscreen.beginRendering(cmd, kMagenta);
        XGC_REQUIRE_OK(renderer.recordDraws(cmd, view));
        const VkImage depth = stage_.offscreen.pauseRendering(cmd);
        XGC_REQUIRE_OK(renderer.recordOcclusion(cmd, view, depth, stage_.offscreen.desc().size));
        stage_.offscreen.resumeRendering(cmd);
        XGC_REQUIRE_OK(renderer.recordLateDraws(cmd, view));
        stage_.offscreen.endRendering(cmd);
        const std::array signals = {renderer.frameDone()};
        uint64_t frame = 0;
        XGC_REQUIRE_OK(stage_.offscreen.submit(signals, frame));
        return stage_.read(frame);
    }

    Stage& stage_;
    OpenAsset torus_ = openBuilt(patchedTorus({.patches = 4, .levels = 4}));
    const PosedModel& tube_ = bakedTube();
    Sieve sieve_;
    std::vector<vulkan::InstanceHandle> tubes_;
};

vulkan::OffscreenDesc target() {
    vulkan::OffscreenDesc desc = singleSampled(240, 160);
    desc.pauses = true;
    return desc;
}

vulkan::RendererConfig onHost() {
    vulkan::RendererConfig config;
    config.jointCapacity = config.morphWeightCapacity = 64;
    return config;
}

vulkan::RendererConfig onDevice() {
    vulkan::RendererConfig config = onHost();
    config.gpu.views = 1;
    config.gpu.tableBytes = config.gpu.indexBytes = 4 << 20;
    return config;
}

} // namespace

TEST_CASE("the device's draws give the host's pictures, in every mode") {
    const Gpu gpu;
    if (!gpu.present) return;
    Stage hostStage(gpu, onHost(), target()), stage(gpu, onDevice(), target());
    Field host(hostStage), device(stage);
    for (int i = 0; i < 5; ++i) {
        for (Field* field : {&host, &device}) {
            field->view.mode = vulkan::ShadingMode(i % 5 == 4 ? 3 : 0);
            field->desc.pixels = 0.5f + 0.25f * float(i);
        }
        const Picture expected = host.frame(0.1f * float(i)), picture = device.frame(0.1f * float(i));
        CHECK(hostStage.renderer.hostReason(0) == std::string_view("GpuPathConfig::views"));
        CHECK(stage.renderer.hostReason(0) == nullptr);
        // Another order of the draws: where two surfaces meet at one depth, the first one is seen.
        CHECK(pixelsApart(expected, picture, 0) < 8);
        CHECK(std::count_if(picture.pixels.begin(), picture.pixels.end(), isMagenta) < 38000);
    }
    CHECK(stage.renderer.gpuStats(0).indices > 0);
    CHECK_FALSE(stage.renderer.gpuStats(0).incomplete);
}

TEST_CASE("occlusion hides nothing that is visible") {
    const Gpu gpu;
    if (!gpu.present) return;
    vulkan::RendererConfig config = onDevice();
    config.gpu.depthPixels = 240 * 160;
    Stage plainStage(gpu, onDevice(), target()), stage(gpu, config, target());
    Field plain(plainStage), field(stage);
    stage.renderer.useOcclusion(0, true);
    field.occludes = true;
    uint64_t all = 0, drawn = 0, late = 0;
    for (int i = 0; i < 32; ++i) {
        // Slowly, then in leaps.
        const float t = i < 16 ? 0.02f * float(i) : 0.7f * float(i);
        if (i % 8 == 7) {
            const Placement there = makePlacement(glm::translate(glm::mat4(1), glm::vec3(0, 0, i % 16 == 7 ? 6 : -30)));
            for (const auto& [f, s] : {std::pair(&plain, &plainStage), std::pair(&field, &stage)}) {
                XGC_REQUIRE_OK(s->renderer.setPlacement(f->instances[3], there));
            }
        }
        const Picture expected = plain.frame(t), picture = field.frame(t);
        CHECK(pixelsApart(expected, picture, 0) == 0);
        all += plainStage.renderer.gpuStats(0).patches;
        drawn += stage.renderer.gpuStats(0).patches;
        late += stage.renderer.gpuStats(0).latePatches;
    }
    MESSAGE("patches drawn: " << drawn << " of " << all << ", late: " << late);
    CHECK(drawn < all * 9 / 10);
    CHECK(late > 0);
}

TEST_CASE("what the compute path cannot do is done on the host, by name") {
    const Gpu gpu;
    if (!gpu.present) return;
    vulkan::ContextDesc bare = gpu.device.contextDesc();
    bare.drawIndirectCount = false;
    vulkan::Context context;
    XGC_REQUIRE_OK(context.create(bare));

    Stage hostStage(gpu, onHost(), target()), stage(gpu, onDevice(), target());
    Field host(hostStage), field(stage);
    const auto both = [&](const char* reason) {
        const Picture expected = host.frame(0.4f);
        CHECK(pixelsApart(expected, field.frame(0.4f), 0) < 8); // where depths tie, the order of draws decides
        const char* said = stage.renderer.hostReason(0);
        CHECK(std::string_view(said ? said : "") == reason);
    };
    both("");
    host.desc.triangleBudget = field.desc.triangleBudget = 100000;
    both("SelectionDesc::triangleBudget");
    host.desc.triangleBudget = field.desc.triangleBudget = 0;
    both("");

    // Without the feature no shader is made, and the frames are the host's.
    vulkan::RendererConfig config = onDevice();
    config.samples = VK_SAMPLE_COUNT_1_BIT;
    vulkan::Renderer renderer;
    XGC_REQUIRE_OK(renderer.create(context, config));
    XGC_REQUIRE_OK(renderer.beginFrame());
    renderer.select(0, field.desc);
    renderer.endFrame();
    CHECK(renderer.hostReason(0) == std::string_view("drawIndirectCount"));
}

TEST_CASE("memory of the compute path that does not suffice is said, and nothing else is harmed") {
    const Gpu gpu;
    if (!gpu.present) return;
    for (const bool fewDraws : {false, true}) {
        vulkan::RendererConfig config = onDevice();
        (fewDraws ? config.gpu.drawCapacity : config.gpu.indexBytes) = fewDraws ? 40 : 20000;
        Stage stage(gpu, config, target());
        Field field(stage);
        field.desc.pixels = 0.01f;
        for (int i = 0; i < 5; ++i) field.frame(0.3f);
        CHECK(stage.renderer.gpuStats(0).incomplete);
        CHECK(stage.renderer.gpuStats(0).draws > 0);
        CHECK(stage.renderer.gpuStats(0).indices <= 5000 + (fewDraws ? 1u << 30 : 0));
    }
}
