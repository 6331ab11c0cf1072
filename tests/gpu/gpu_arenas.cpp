#include "gpu_test.h"
#include "hand_asset.h"

#include "meshes/builders.h"

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace {

using namespace xgc;
using namespace xgc::test;

constexpr uint64_t kMiB = 1024 * 1024;

vulkan::ViewDesc viewOf(const AssetView& asset) {
    vulkan::ViewDesc view;
    vulkan::Framing framing;
    framing.towards = {0.5f, 0.4f, 1};
    view.camera = vulkan::frame(asset.positions, framing);
    return view;
}

std::vector<uint8_t> finest(const AssetView& asset) {
    return std::vector<uint8_t>(asset.patchCount(), 0);
}

/// A frame that draws nothing: its copies are made.
void sendFrame(Stage& stage, vulkan::InstanceHandle instance, Levels levels) {
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    XGC_REQUIRE_OK(stage.renderer.setLevels(instance, levels));
    stage.renderer.endFrame();
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    XGC_REQUIRE_OK(stage.offscreen.begin(cmd));
    stage.renderer.recordTransfers(cmd);
    stage.offscreen.beginRendering(cmd, kMagenta);
    stage.offscreen.endRendering(cmd);
    const std::array signals = {stage.renderer.frameDone()};
    uint64_t frame = 0;
    XGC_REQUIRE_OK(stage.offscreen.submit(signals, frame));
}

/// Counts what goes through a host's callbacks.
struct Counts {
    int64_t hostLive = 0, hostTotal = 0;
    int64_t deviceLive = 0, deviceTotal = 0;
    const vulkan::Context* own = nullptr; ///< does the work of the device hook
};

// A header in front of each block keeps what the block needs for its release.
struct Header {
    void* start;
    size_t bytes;
};

void* VKAPI_CALL hostAllocate(void* user, size_t bytes, size_t wanted, VkSystemAllocationScope) {
    const size_t alignment = std::max(wanted, alignof(std::max_align_t));
    const size_t room = std::max(alignment, sizeof(Header));
    void* start = std::malloc(bytes + 2 * room);
    if (!start) return nullptr;
    const auto address = (reinterpret_cast<uintptr_t>(start) + sizeof(Header) + alignment - 1) / alignment * alignment;
    reinterpret_cast<Header*>(address)[-1] = {start, bytes};
    auto& counts = *static_cast<Counts*>(user);
    ++counts.hostLive;
    ++counts.hostTotal;
    return reinterpret_cast<void*>(address);
}

void VKAPI_CALL hostFree(void* user, void* memory) {
    if (!memory) return;
    --static_cast<Counts*>(user)->hostLive;
    std::free(static_cast<Header*>(memory)[-1].start);
}

void* VKAPI_CALL hostReallocate(void* user, void* memory, size_t bytes, size_t alignment,
                                VkSystemAllocationScope scope) {
    void* next = bytes ? hostAllocate(user, bytes, alignment, scope) : nullptr;
    if (next && memory) std::memcpy(next, memory, std::min(bytes, static_cast<Header*>(memory)[-1].bytes));
    if (next || bytes == 0) hostFree(user, memory);
    return next;
}

VkResult deviceAllocate(void* user, const vulkan::MemoryRequest& request, vulkan::Memory& out) {
    auto& counts = *static_cast<Counts*>(user);
    const VkResult result = counts.own->allocate(request, out);
    if (result == VK_SUCCESS) {
        ++counts.deviceLive;
        ++counts.deviceTotal;
        out.token = user;
    }
    return result;
}

void deviceRelease(void* user, const vulkan::Memory& memory) {
    auto& counts = *static_cast<Counts*>(user);
    CHECK(memory.token == user);
    --counts.deviceLive;
    counts.own->release(memory);
}

} // namespace

TEST_CASE("vertex streams past the largest storage buffer range are drawn alike") {
    const Gpu gpu;
    if (!gpu.present) return;
    const bake::Model cube = test::cube(4);
    const HandAsset asset(cube.positions, cube.triangles, 50);
    const vulkan::ViewDesc view = viewOf(asset.view);
    Stage small(gpu, {}, singleSampled(96, 96));
    const Picture expected = small.draw(small.place(asset.view, {}, view), finest(asset.view), view);

    // A stream of 160 MiB lies before the asset's in the arena.
    HandAsset filler(cube.positions, cube.triangles, 50);
    std::vector<std::byte> bytes(160 * kMiB);
    filler.view.vertexStreams[0].bytes = bytes;
    vulkan::RendererConfig config;
    config.vertexArenaBytes = 200 * kMiB;
    Stage large(gpu, config, singleSampled(96, 96));
    vulkan::AssetHandle fillerHandle;
    XGC_REQUIRE_OK(large.renderer.addAsset(filler.view, fillerHandle));
    const Picture drawn = large.draw(large.place(asset.view, {}, view), finest(asset.view), view);
    CHECK(drawn.pixels == expected.pixels);
    CHECK(std::count_if(drawn.pixels.begin(), drawn.pixels.end(), isMagenta) < 96 * 96 * 3 / 4);
}

TEST_CASE("index ranges past 128 MiB are drawn alike") {
    const Gpu gpu;
    if (!gpu.present) return;
    const bake::Model cube = test::cube(4);
    const HandAsset asset(cube.positions, cube.triangles, 50);
    const vulkan::ViewDesc view = viewOf(asset.view);
    Stage small(gpu, {}, singleSampled(96, 96));
    const Picture expected = small.draw(small.place(asset.view, {}, view), finest(asset.view), view);

    // Eight assets of a million triangles are built before the asset's indices, and never drawn.
    const std::vector<glm::uvec3> many(1'000'000, glm::uvec3(0, 1, 2));
    const HandAsset filler(cube.positions, many, 100'000);
    vulkan::RendererConfig config;
    config.slotCapacity = 300'000;
    config.indexBytes = 240u << 20;
    config.vertexArenaBytes = 320 * kMiB;
    config.stagingBytes = 96 * kMiB;
    config.narrowIndices = false;
    Stage large(gpu, config, singleSampled(96, 96));
    const vulkan::InstanceHandle instance = large.place(asset.view, {}, view);
    std::vector<vulkan::InstanceHandle> fillers(8);
    for (vulkan::InstanceHandle& one : fillers) one = large.place(filler.view, {}, view);
    for (const vulkan::InstanceHandle& one : fillers) {
        sendFrame(large, one, finest(filler.view));
        REQUIRE(large.renderer.stats().deferredInstances == 0);
    }
    sendFrame(large, instance, finest(asset.view));
    for (const vulkan::InstanceHandle& one : fillers) XGC_REQUIRE_OK(large.renderer.removeInstance(one));
    const Picture drawn = large.draw(instance, finest(asset.view), view);
    CHECK(large.renderer.drawList().draws()[0].firstIndex > 32u << 20);
    CHECK(drawn.pixels == expected.pixels);
}

TEST_CASE("the arena takes assets again and again while frames are in flight") {
    const Gpu gpu;
    if (!gpu.present) return;
    const bake::Model cube = test::cube(4);
    const HandAsset asset(cube.positions, cube.triangles, 50);
    const vulkan::ViewDesc view = viewOf(asset.view);
    const uint64_t bytes = (asset.view.vertexStreams[0].bytes.size() + 63) / 64 * 64;
    vulkan::RendererConfig config;
    config.vertexArenaBytes = 4 * bytes; // the one that is drawn and those that frames in flight still read
    config.indexBytes = 80 * asset.view.record->faceCount;
    config.stagingBytes = 128 * 1024;
    Stage stage(gpu, config, singleSampled(32, 32));
    Picture first;
    for (int round = 0; round < 12; ++round) {
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(stage.renderer.addAsset(asset.view, handle));
        vulkan::InstanceHandle instance;
        XGC_REQUIRE_OK(stage.renderer.addInstance(handle, {}, instance));
        const Picture picture = stage.draw(instance, finest(asset.view), view);
        if (round == 0) first = picture;
        CHECK(picture.pixels == first.pixels);
        CHECK_FALSE(stage.renderer.removeAsset(handle).ok()); // its instance is there
        XGC_REQUIRE_OK(stage.renderer.removeInstance(instance));
        XGC_REQUIRE_OK(stage.renderer.removeAsset(handle));
        CHECK_FALSE(stage.renderer.removeAsset(handle).ok());
        CHECK_FALSE(stage.renderer.removeInstance(instance).ok());
        CHECK_FALSE(stage.renderer.setLevels(instance, finest(asset.view)).ok());
    }
}

TEST_CASE("what does not fit is refused with the setting to raise") {
    const Gpu gpu;
    if (!gpu.present) return;
    const bake::Model cube = test::cube(4);
    const HandAsset asset(cube.positions, cube.triangles, 50);
    vulkan::RendererConfig config;
    config.vertexArenaBytes = 1024;
    config.viewCapacity = 1;
    Stage stage(gpu, config, singleSampled(16, 16));
    vulkan::AssetHandle handle;
    const Status full = stage.renderer.addAsset(asset.view, handle);
    CHECK(full.code == StatusCode::outOfCapacity);
    CHECK(std::string(full.message).find("vertexArenaBytes") != std::string::npos);
    config.stagingBytes = 1;
    vulkan::Renderer other;
    CHECK(other.create(gpu.context, config).code == StatusCode::badArgument);
}

TEST_CASE("a host's callbacks get every allocation back") {
    Counts counts;
    const VkAllocationCallbacks callbacks{&counts, hostAllocate, hostReallocate, hostFree, nullptr, nullptr};
    {
        const Gpu gpu;
        if (!gpu.present) return;
        counts.own = &gpu.context;
        vulkan::ContextDesc desc = gpu.device.contextDesc();
        desc.allocation = &callbacks;
        desc.memory = {deviceAllocate, deviceRelease, &counts};
        vulkan::Context context;
        XGC_REQUIRE_OK(context.create(desc));
        vulkan::Renderer renderer;
        vulkan::Offscreen offscreen;
        XGC_REQUIRE_OK(renderer.create(context, {}));
        XGC_REQUIRE_OK(offscreen.create(context, gpu.device.queue(), {}));
        CHECK(counts.hostLive > 0);
        CHECK(counts.deviceLive > 5);
    }
    CHECK(counts.hostTotal > 0);
    CHECK(counts.hostLive == 0);
    CHECK(counts.deviceTotal > 5);
    CHECK(counts.deviceLive == 0);
}

TEST_CASE("a framing camera sees every point, and no nearer one does") {
    const bake::Model sphere = test::sphere(6);
    for (const glm::vec3& towards : {glm::vec3(0, 0, 1), glm::vec3(1, 2, -0.5f), glm::vec3(0, 1, 0)}) {
        for (const float aspect : {0.5f, 1.0f, 2.0f}) {
            std::vector<glm::vec3> points = sphere.positions;
            for (glm::vec3& p : points) p = p * glm::vec3(3, 1, 0.5f) + glm::vec3(10, 0, -4);
            vulkan::Framing framing;
            framing.towards = towards;
            framing.aspect = aspect;
            framing.margin = 1;
            const glm::mat4 toClip = vulkan::frame(points, framing).worldToClip();
            glm::vec2 most(0);
            for (const glm::vec3& p : points) {
                const glm::vec4 clip = toClip * glm::vec4(p, 1);
                CHECK(clip.w > 0);
                most = glm::max(most, glm::abs(glm::vec2(clip) / clip.w));
            }
            CHECK(std::max(most.x, most.y) < 1.01f);
            CHECK(std::max(most.x, most.y) > 0.99f);
        }
    }
}
