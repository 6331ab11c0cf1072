#include "gpu_test.h"
#include "hand_asset.h"

#include "meshes/patched_torus.h"

#include "barriers.h"
#include "buffer.h"

#include <xgc/indices.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#include <random>
#include <string>

// Counts allocations that code of this program makes in the thread that asks: drivers and layers allocate as they like.
// Those that compile shaders in threads of their own would seem to be this program where they take its instances of std
// templates, such as std::string's.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define XGC_NO_COUNT
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define XGC_NO_COUNT
#endif
#endif

namespace {
// Volatile, or a compiler that knows what `new` does may read it too early.
thread_local volatile size_t allocationCount = 0;
} // namespace

#ifndef XGC_NO_COUNT
extern "C" char __executable_start, etext;
// Not inlined: the return address is to be that of whoever allocates.
[[gnu::noinline]] void* operator new(size_t bytes) {
    const char* caller = static_cast<const char*>(__builtin_return_address(0));
    if (caller >= &__executable_start && caller < &etext) allocationCount = allocationCount + 1;
    if (void* memory = std::malloc(bytes)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}
#endif

namespace {

using namespace xgc;
using namespace xgc::test;

std::vector<uint8_t> randomLevels(const AssetView& asset, std::mt19937& random) {
    std::vector<uint8_t> levels(asset.patchCount());
    for (uint8_t& level : levels) level = uint8_t(random() % asset.levelCount());
    return levels;
}

/// Outside the torus, all of it in view.
vulkan::ViewDesc outside(const AssetView& asset) {
    vulkan::ViewDesc view;
    vulkan::Framing framing;
    framing.towards = {0.4f, -0.8f, 0.9f};
    view.camera = vulkan::frame(asset.positions, framing);
    return view;
}

/// Copies device memory back, after all that was submitted before.
std::vector<uint32_t> readBuffer(const Gpu& gpu, Stage& stage, VkBuffer source, size_t words) {
    vulkan::Buffer copy;
    XGC_REQUIRE_OK(copy.create(gpu.context, words * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT, vulkan::Residence::download));
    const vulkan::Functions& vk = gpu.context.vk();
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    XGC_REQUIRE_OK(stage.offscreen.begin(cmd));
    vulkan::memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                          {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT});
    const VkBufferCopy region{0, 0, words * 4};
    vk.vkCmdCopyBuffer(cmd, source, copy.handle(), 1, &region);
    vulkan::memoryBarrier(vk, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                          {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
    stage.offscreen.beginRendering(cmd, kMagenta);
    stage.offscreen.endRendering(cmd);
    uint64_t frame = 0;
    XGC_REQUIRE_OK(stage.offscreen.submit({}, frame));
    stage.read(frame);
    std::vector<uint32_t> out(words);
    std::memcpy(out.data(), copy.mapped().data(), words * 4);
    return out;
}

} // namespace

TEST_CASE("the index arena holds what buildIndices writes") {
    const Gpu gpu;
    if (!gpu.present) return;
    const OpenAsset torus = openBuilt(patchedTorus({}));
    REQUIRE(torus.failure == "");
    const AssetView& asset = torus.view;
    const vulkan::ViewDesc view = outside(asset);
    vulkan::RendererConfig config;
    config.indexBytes = 160 * asset.record->faceCount;
    Stage stage(gpu, config, singleSampled(32, 32));
    const vulkan::InstanceHandle instance = stage.place(asset, {}, view);
    std::mt19937 random(1);
    std::vector<uint32_t> scratch(scratchCapacity(asset)), expected(3 * asset.record->faceCount);
    for (int state = 0; state < 20; ++state) {
        const std::vector<uint8_t> levels = randomLevels(asset, random);
        stage.draw(instance, levels, view);
        const std::vector<uint32_t> arena =
            readBuffer(gpu, stage, stage.renderer.geometry().indices, config.indexBytes / 4);
        const DrawList& list = stage.renderer.drawList();
        uint32_t wrong = 0, triangles = 0;
        for (const DrawBatch& batch : list.batches()) {
            for (uint32_t i = batch.firstDraw; i < batch.firstDraw + batch.drawCount; ++i) {
                const DrawCommand& draw = list.draws()[i];
                const uint32_t count = buildIndices(asset, list.sources()[i].patch, levels, scratch, expected);
                std::vector<uint32_t> drawn(count);
                for (uint32_t k = 0; k < count && count == draw.indexCount; ++k) {
                    uint32_t index = 0;
                    const size_t at = size_t(draw.firstIndex + k) * batch.indexBytes;
                    std::memcpy(&index, reinterpret_cast<const char*>(arena.data()) + at, batch.indexBytes);
                    drawn[k] = index + uint32_t(draw.vertexOffset);
                }
                wrong += !std::equal(drawn.begin(), drawn.end(), expected.begin());
                triangles += count / 3;
            }
        }
        CHECK(wrong == 0);
        CHECK(triangles == stage.renderer.stats().triangles);
        CHECK(triangles > 0);
    }
}

TEST_CASE("from inside a closed surface no mix of levels lets the background through") {
    const Gpu gpu;
    if (!gpu.present) return;
    const OpenAsset torus = openBuilt(patchedTorus({}));
    REQUIRE(torus.failure == "");
    Stage stage(gpu, {}, singleSampled(160, 160));
    vulkan::ViewDesc view;
    view.camera.eye = {2, 0, 0}; // in the middle of the tube, whatever the levels
    view.camera.fovY = 1.6f;
    const vulkan::InstanceHandle instance = stage.place(torus.view, {}, view);
    std::mt19937 random(2);
    const glm::vec3 directions[] = {{1, 0.1f, 0.2f}, {-1, 0.2f, 0.1f}, {0.1f, 1, 0}, {0, -1, 0.1f}, {0.1f, 0, 1}};
    for (int state = 0; state < 12; ++state) {
        const std::vector<uint8_t> levels = randomLevels(torus.view, random);
        for (const glm::vec3& direction : directions) {
            view.camera.target = view.camera.eye + direction;
            view.camera.up = {0.3f, 0.5f, 0.7f};
            const Picture picture = stage.draw(instance, levels, view);
            CHECK(std::count_if(picture.pixels.begin(), picture.pixels.end(), isMagenta) == 0);
        }
    }
}

namespace {

/// Draws frames in flight with changing levels and views. Returns the allocations of the frames after the first ones.
size_t drawFrames(const Gpu& gpu) {
    const OpenAsset torus = openBuilt(patchedTorus({}));
    REQUIRE(torus.failure == "");
    const AssetView& asset = torus.view;
    vulkan::RendererConfig config;
    config.framesInFlight = 3;
    config.indexBytes = 240 * asset.record->faceCount;
    Stage stage(gpu, config, singleSampled(64, 48));
    vulkan::ViewDesc view = outside(asset);
    std::vector<vulkan::InstanceHandle> instances;
    for (int i = 0; i < 3; ++i) instances.push_back(stage.place(asset, {}, view));
    std::mt19937 random(3);
    size_t allocations = 0, changed = 0;
    for (int frame = 0; frame < 80; ++frame) {
        std::vector<std::vector<uint8_t>> levels;
        for (size_t i = 0; i < instances.size(); ++i) levels.push_back(randomLevels(asset, random));
        view.mode = vulkan::ShadingMode(frame % 4);
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        XGC_REQUIRE_OK(stage.offscreen.begin(cmd));
        const size_t before = allocationCount;
        Status status = stage.renderer.beginFrame();
        for (size_t i = 0; i < instances.size() && status.ok(); ++i) {
            status = stage.renderer.setLevels(instances[i], levels[i]);
        }
        stage.renderer.endFrame();
        stage.renderer.recordTransfers(cmd);
        stage.offscreen.beginRendering(cmd, kMagenta);
        stage.renderer.recordBackground(cmd);
        if (status.ok()) status = stage.renderer.recordDraws(cmd, view);
        stage.offscreen.endRendering(cmd);
        uint64_t ticket = 0;
        const std::array signals = {stage.renderer.frameDone()};
        const Status submitted = stage.offscreen.submit(signals, ticket);
        if (frame >= 3) allocations += allocationCount - before;
        XGC_REQUIRE_OK(status);
        XGC_REQUIRE_OK(submitted);
        changed += stage.renderer.stats().patchesChanged;
    }
    CHECK(changed > 1000);
    return allocations;
}

/// Keeps layers away while it lives: they share instances of std templates with this program and so would seem to be
/// it.
class WithoutLayers {
public:
    WithoutLayers() {
        if (const char* layers = std::getenv(kName)) saved_ = layers;
        unsetenv(kName);
    }
    ~WithoutLayers() { setenv(kName, saved_.c_str(), 1); }
    WithoutLayers(const WithoutLayers&) = delete;
    WithoutLayers& operator=(const WithoutLayers&) = delete;

private:
    static constexpr const char* kName = "VK_INSTANCE_LAYERS";
    std::string saved_;
};

} // namespace

TEST_CASE("frames in flight with changing levels and views are clean") {
    const Gpu gpu;
    if (gpu.present) drawFrames(gpu);
}

TEST_CASE("frames allocate nothing") {
#ifdef XGC_NO_COUNT
    MESSAGE("SKIPPED: allocations are not counted under sanitizers");
#else
    const WithoutLayers guard;
    const Gpu gpu;
    if (gpu.present) CHECK(drawFrames(gpu) == 0);
#endif
}

TEST_CASE("wire mode draws the picture that shaded mode draws, but for its colours") {
    const Gpu gpu;
    if (!gpu.present) return;
    const OpenAsset torus = openBuilt(patchedTorus({}));
    Stage stage(gpu, {}, singleSampled(128, 128));
    vulkan::ViewDesc view = outside(torus.view);
    const vulkan::InstanceHandle instance = stage.place(torus.view, {}, view);
    std::mt19937 random(4);
    const std::vector<uint8_t> levels = randomLevels(torus.view, random);
    const Picture shaded = stage.draw(instance, levels, view);
    view.mode = vulkan::ShadingMode::wire;
    const Picture wire = stage.draw(instance, levels, view);
    uint32_t different = 0;
    for (size_t i = 0; i < shaded.pixels.size(); ++i) {
        different += isMagenta(shaded.pixels[i]) != isMagenta(wire.pixels[i]);
    }
    CHECK(different == 0);
}
