#include "gpu_test.h"

#include "meshes/builders.h"
#include "meshes/posed_model.h"

#include <xgc/morph.h>

#include <algorithm>
#include <cstdio>

namespace {

using namespace xgc;
using namespace xgc::test;

/// A view whose rows stand where a pose puts them on the CPU, without joints and targets; and the posed one. Neither
/// has normals: the picture is that of the positions.
struct Reference {
    Reference(const AssetView& asset, const Pose& pose) : posed(asset), moved(asset) {
        for (uint32_t row = 0; row < asset.record->vertexCount; ++row) {
            positions.push_back(posedPosition(asset, pose, row));
        }
        dropNormals(posed);
        dropNormals(moved);
        moved.joints = {};
        moved.morphTargets = {};
        moved.morphRows = {};
        moved.morphDeltas = {};
        moved.positions = positions;
        moved.vertexStreams[0].bytes = std::as_bytes(std::span(positions));
    }
    AssetView posed, moved;
    std::vector<glm::vec3> positions;

private:
    static void dropNormals(AssetView& view) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < view.vertexStreamCount; ++i) {
            if (view.vertexStreams[i].kind != format::StreamKind::normal) {
                view.vertexStreams[kept++] = view.vertexStreams[i];
            }
        }
        view.vertexStreamCount = kept;
    }
};

struct State {
    std::vector<uint8_t> levels;
    std::vector<float> fractions;
};

State randomState(const AssetView& asset, std::mt19937& random) {
    State state;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        state.levels.push_back(uint8_t(random() % (asset.levelCount() - 1)));
        state.fractions.push_back(float(random() % 1000) / 1000);
    }
    return state;
}

Picture draw(Stage& stage, vulkan::InstanceHandle instance, const State& state, bool morphs,
             const vulkan::ViewDesc& view) {
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    XGC_REQUIRE_OK(stage.renderer.setLevels(
        instance, state.levels, morphs ? std::span<const float>(state.fractions) : std::span<const float>()));
    stage.renderer.endFrame();
    REQUIRE(stage.renderer.stats().deferredInstances == 0);
    return stage.read(stage.submit(view));
}

constexpr int kApart = 8;

vulkan::RendererConfig configOf(const AssetView& asset) {
    const AssetView* one = &asset;
    vulkan::RendererConfig base;
    base.morphGroupCapacity = 1;
    return vulkan::configFor({&one, 1}, 1, base);
}

/// The posed asset on the device against its posed positions from the CPU, at mixed levels and between them.
void comparePoses(const Gpu& gpu, const AssetView& asset, uint32_t seed, float bend) {
    std::mt19937 random(seed);
    for (int i = 0; i < 2; ++i) {
        const RandomPose pose(asset, random, bend);
        const Reference reference(asset, pose.pose());
        vulkan::ViewDesc view;
        view.camera = vulkan::frame(reference.positions, {.towards = {0.4f, 0.5f, 0.9f}});
        const State state = randomState(asset, random);
        Stage device(gpu, configOf(asset), singleSampled(160, 160)),
            host(gpu, configOf(asset), singleSampled(160, 160));
        const vulkan::InstanceHandle posed = device.place(reference.posed, {}, view),
                                     moved = host.place(reference.moved, {}, view);
        const Picture rest = draw(device, posed, state, false, view);
        XGC_REQUIRE_OK(device.renderer.setPose(posed, pose.pose()));
        for (const bool morphs : {false, true}) {
            const Picture a = draw(device, posed, state, morphs, view), b = draw(host, moved, state, morphs, view);
            const auto seen = size_t(
                std::count_if(b.pixels.begin(), b.pixels.end(), [](const glm::u8vec4& p) { return !isMagenta(p); }));
            CHECK(seen > b.pixels.size() / 40);
            CHECK(pixelsApart(a, b, kApart) <= seen / 60); // edges, and where it goes through itself
            CHECK(pixelsApart(a, rest, kApart) > seen / 10);
        }
        XGC_REQUIRE_OK(device.renderer.clearPose(posed));
        CHECK(draw(device, posed, state, false, view).pixels == rest.pixels);
    }
}

} // namespace

TEST_CASE("the device puts posed rows where the CPU does, at mixed levels and between them") {
    const Gpu gpu;
    if (!gpu.present) return;
    const PosedModel tube(tubeModel({24, 60}));
    REQUIRE(tube.failure == "");
    comparePoses(gpu, tube.view, 1, 0.8f);
}

TEST_CASE("a fox is drawn as its pose says") {
    const Gpu gpu;
    if (!gpu.present) return;
    const std::filesystem::path data = dataDir(XGC_SOURCE_DIR);
    if (data.empty()) {
        std::puts("SKIPPED: the fox (no XGC_DATA)");
        return;
    }
    const PosedModel fox(data / "gltf/Fox.glb");
    REQUIRE(fox.failure == "");
    comparePoses(gpu, fox.view, 2, 0.3f);
}

TEST_CASE("from inside a posed tube no levels let the background through") {
    const Gpu gpu;
    if (!gpu.present) return;
    const PosedModel tube(tubeModel({24, 60}));
    REQUIRE(tube.failure == "");
    vulkan::RendererConfig config;
    config.jointCapacity = 4;
    config.morphGroupCapacity = groupCount(tube.view);
    Stage stage(gpu, config, singleSampled(96, 96));
    vulkan::ViewDesc view;
    view.camera.fovY = 1.7f;
    const vulkan::InstanceHandle instance = stage.place(tube.view, {}, view);
    std::mt19937 random(3);
    for (int i = 0; i < 3; ++i) {
        const RandomPose pose(tube.view, random, 0.35f);
        XGC_REQUIRE_OK(stage.renderer.setPose(instance, {pose.joints, {}}));
        // Where the pose takes the middle of the axis.
        const glm::vec3 eye = pose.joints[1] * glm::vec4(0, 1, 0, 1);
        view.camera.eye = eye;
        State state = randomState(tube.view, random);
        for (uint8_t& level : state.levels) level = uint8_t(level % 12);
        for (const glm::vec3 direction :
             {glm::vec3(1, 0.1f, 0.2f), glm::vec3(-0.3f, 0.2f, -1), glm::vec3(0, 1, 0.1f)}) {
            view.camera.target = eye + direction;
            const Picture picture = draw(stage, instance, state, true, view);
            CHECK(std::count_if(picture.pixels.begin(), picture.pixels.end(), isMagenta) == 0);
        }
    }
}

TEST_CASE("a pose that does not fit is refused with the setting's name") {
    const Gpu gpu;
    if (!gpu.present) return;
    const PosedModel tube(tubeModel({24, 60}));
    std::mt19937 random(4);
    const RandomPose pose(tube.view, random, 1);
    vulkan::RendererConfig config;
    config.jointCapacity = 3;
    Stage stage(gpu, config, singleSampled(16, 16));
    const vulkan::InstanceHandle instance = stage.place(tube.view, {}, {});
    const Status joints = stage.renderer.setPose(instance, {pose.joints, {}});
    CHECK(joints.code == StatusCode::outOfCapacity);
    CHECK(std::string(joints.message).find("jointCapacity") != std::string::npos);
    const Status targets = stage.renderer.setPose(instance, {{}, pose.weights});
    CHECK(std::string(targets.message).find("morphWeightCapacity") != std::string::npos);
    const Status wrong = stage.renderer.setPose(instance, {{pose.joints.data(), 2}, {}});
    CHECK(wrong.code == StatusCode::badArgument);
}
