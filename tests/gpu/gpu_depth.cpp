#include "gpu_test.h"

#include "attachment.h"
#include "barriers.h"
#include "buffer.h"
#include "hand_asset.h"
#include "meshes/baked_model.h"
#include "meshes/posed_model.h"

#include <xgc/morph.h>
#include <xgc/vulkan/shadow_map.h>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cstring>

namespace {

using namespace xgc;
using namespace xgc::test;

constexpr uint32_t kSize = 192;

/// A depth map, and a picture with a depth to copy out: what the shaded pass leaves beside what the depth pass does.
class DepthStage {
public:
    explicit DepthStage(const Gpu& gpu, vulkan::RendererConfig config = {}) : vk_(gpu.context.vk()) {
        config.samples = VK_SAMPLE_COUNT_1_BIT;
        XGC_REQUIRE_OK(renderer.create(gpu.context, config));
        const VkExtent2D size{kSize, kSize};
        XGC_REQUIRE_OK(color_.create(gpu.context, size, config.colorFormat, VK_SAMPLE_COUNT_1_BIT,
                                     VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, VK_IMAGE_ASPECT_COLOR_BIT));
        for (vulkan::Attachment& depth : depths_) {
            XGC_REQUIRE_OK(depth.create(gpu.context, size, config.depthFormat, VK_SAMPLE_COUNT_1_BIT,
                                        VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                        VK_IMAGE_ASPECT_DEPTH_BIT));
        }
        for (vulkan::Buffer& buffer : read_) {
            XGC_REQUIRE_OK(buffer.create(gpu.context, kSize * kSize * sizeof(float), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                         vulkan::Residence::download));
        }
        vulkan::OffscreenDesc target = singleSampled(4, 4);
        target.framesInFlight = config.framesInFlight;
        XGC_REQUIRE_OK(offscreen_.create(gpu.context, gpu.device.queue(), target));
    }

    vulkan::InstanceHandle place(const AssetView& asset) {
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(renderer.addAsset(asset, handle));
        vulkan::InstanceHandle instance;
        XGC_REQUIRE_OK(renderer.addInstance(handle, {}, instance));
        while (!renderer.resident(handle)) {
            XGC_REQUIRE_OK(renderer.beginFrame());
            renderer.endFrame();
            submit([](VkCommandBuffer) {});
        }
        return instance;
    }

    struct Depths {
        std::vector<float> shaded, alone;
    };
    /// One frame with both passes; the levels were set.
    Depths draw(const vulkan::ViewDesc& view) {
        submit([&](VkCommandBuffer cmd) {
            pass(cmd, depths_[0], true, [&] { XGC_REQUIRE_OK(renderer.recordDraws(cmd, view)); });
            pass(cmd, depths_[1], false, [&] {
                XGC_REQUIRE_OK(renderer.recordDepth(cmd, {view.view, view.camera.worldToClip()}));
            });
            for (int i = 0; i < 2; ++i) copy(cmd, depths_[i], read_[i]);
        });
        const auto floats = [](const vulkan::Buffer& buffer) {
            std::vector<float> out(kSize * kSize);
            std::memcpy(out.data(), buffer.mapped().data(), out.size() * sizeof(float));
            return out;
        };
        return {floats(read_[0]), floats(read_[1])};
    }

    vulkan::Renderer renderer;

private:
    template <typename Record>
    void submit(Record record) {
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        XGC_REQUIRE_OK(offscreen_.begin(cmd));
        renderer.recordTransfers(cmd);
        record(cmd);
        offscreen_.beginRendering(cmd, kMagenta);
        offscreen_.endRendering(cmd);
        const std::array signals = {renderer.frameDone()};
        uint64_t frame = 0;
        XGC_REQUIRE_OK(offscreen_.submit(signals, frame));
        std::array<std::byte, 64> pixels;
        XGC_REQUIRE_OK(offscreen_.read(frame, pixels));
    }

    template <typename Draw>
    void pass(VkCommandBuffer cmd, const vulkan::Attachment& target, bool shaded, Draw draw) {
        const vulkan::Access all{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
        vulkan::imageBarrier(vk_, cmd,
                             {target.image(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL},
                             all, all);
        vulkan::imageBarrier(vk_, cmd,
                             {color_.image(), VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                              VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL},
                             all, all);
        VkRenderingAttachmentInfo depth{}, color{};
        depth.sType = color.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
        depth.imageView = target.view();
        depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
        depth.loadOp = color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        color.imageView = color_.view();
        color.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        VkRenderingInfo info{};
        info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
        info.renderArea = {{0, 0}, {kSize, kSize}};
        info.layerCount = 1;
        info.colorAttachmentCount = shaded ? 1 : 0;
        info.pColorAttachments = shaded ? &color : nullptr;
        info.pDepthAttachment = &depth;
        vk_.vkCmdBeginRendering(cmd, &info);
        const VkViewport viewport{0, 0, kSize, kSize, 0, 1};
        vk_.vkCmdSetViewport(cmd, 0, 1, &viewport);
        vk_.vkCmdSetScissor(cmd, 0, 1, &info.renderArea);
        draw();
        vk_.vkCmdEndRendering(cmd);
        vulkan::imageBarrier(vk_, cmd,
                             {target.image(), VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
                              VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                             all, all);
    }

    void copy(VkCommandBuffer cmd, const vulkan::Attachment& from, const vulkan::Buffer& to) {
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 0, 1};
        region.imageExtent = {kSize, kSize, 1};
        vk_.vkCmdCopyImageToBuffer(cmd, from.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.handle(), 1, &region);
        vulkan::memoryBarrier(vk_, cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                              {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
    }

    const vulkan::Functions& vk_;
    vulkan::Attachment color_;
    std::array<vulkan::Attachment, 2> depths_;
    std::array<vulkan::Buffer, 2> read_;
    vulkan::Offscreen offscreen_; ///< destroyed first: it waits for the frames
};

vulkan::ViewDesc viewOf(const AssetView& asset) {
    vulkan::ViewDesc view;
    view.camera = vulkan::frame(asset.positions, {.towards = {0.4f, 0.5f, 0.9f}});
    return view;
}

size_t drawn(const std::vector<float>& depths) {
    return size_t(std::count_if(depths.begin(), depths.end(), [](float d) { return d > 0; }));
}

} // namespace

TEST_CASE("a depth-only pass leaves the depths of the shaded one, bit for bit, at mixed levels and between them") {
    const Gpu gpu;
    if (!gpu.present) return;
    const BakedModel model(bake::BundledModel::creature, 3000, 256);
    REQUIRE(model.failure == "");
    vulkan::RendererConfig config;
    config.morphGroupCapacity = groupCount(model.view);
    DepthStage stage(gpu, config);
    const vulkan::InstanceHandle instance = stage.place(model.view);
    std::vector<uint8_t> levels;
    std::vector<float> fractions;
    for (uint32_t p = 0; p < model.view.patchCount(); ++p) {
        levels.push_back(uint8_t((p * 7) % (model.view.levelCount() - 1)));
        fractions.push_back(0.9f * float(p % 5) / 4);
    }
    for (const bool morphs : {false, true}) {
        XGC_REQUIRE_OK(stage.renderer.beginFrame());
        XGC_REQUIRE_OK(stage.renderer.setLevels(instance, levels,
                                                morphs ? std::span<const float>(fractions) : std::span<const float>()));
        stage.renderer.endFrame();
        const DepthStage::Depths depths = stage.draw(viewOf(model.view));
        CHECK(drawn(depths.shaded) > kSize * kSize / 8);
        CHECK(depths.shaded == depths.alone);
    }
}

TEST_CASE("so it does of a posed asset, between levels too") {
    const Gpu gpu;
    if (!gpu.present) return;
    const PosedModel tube(tubeModel({24, 60}));
    REQUIRE(tube.failure == "");
    vulkan::RendererConfig config;
    config.morphGroupCapacity = groupCount(tube.view);
    config.jointCapacity = config.morphWeightCapacity = 8;
    DepthStage stage(gpu, config);
    const vulkan::InstanceHandle instance = stage.place(tube.view);
    std::mt19937 random(1);
    const RandomPose pose(tube.view, random, 0.6f);
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    XGC_REQUIRE_OK(stage.renderer.setPose(instance, pose.pose()));
    const std::vector<uint8_t> levels(tube.view.patchCount(), 2);
    const std::vector<float> fractions(tube.view.patchCount(), 0.4f);
    XGC_REQUIRE_OK(stage.renderer.setLevels(instance, levels, fractions));
    stage.renderer.endFrame();
    const DepthStage::Depths depths = stage.draw(viewOf(tube.view));
    CHECK(drawn(depths.shaded) > kSize * kSize / 30);
    CHECK(depths.shaded == depths.alone);
}

namespace {

/// Two squares, one behind the other; the front one's material is alpha-tested, and its alpha given.
struct Squares {
    explicit Squares(float alpha)
        : front({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, 2),
          record(front.view.materials[0]) {
        record.baseColor[0] = 0;
        record.baseColor[3] = alpha;
        record.flags = format::kAlphaMask;
        front.view.materials = {&record, 1};
        front.view.alphaCutoffs = {&cutoff, 1};
    }
    HandAsset front;
    format::MaterialRecord record;
    float cutoff = 0.25f;
};

} // namespace

TEST_CASE("what an alpha test drops leaves neither colour nor depth, and what it keeps both") {
    const Gpu gpu;
    if (!gpu.present) return;
    vulkan::ViewDesc view;
    view.camera.eye = {0, 0, 4};
    const std::array<uint8_t, 1> levels{0};
    for (const float alpha : {0.2f, 0.3f}) {
        const Squares squares(alpha);
        const bool kept = alpha >= squares.cutoff;
        DepthStage depthStage(gpu);
        const vulkan::InstanceHandle instance = depthStage.place(squares.front.view);
        XGC_REQUIRE_OK(depthStage.renderer.beginFrame());
        XGC_REQUIRE_OK(depthStage.renderer.setLevels(instance, levels));
        depthStage.renderer.endFrame();
        const DepthStage::Depths depths = depthStage.draw(view);
        CHECK((drawn(depths.shaded) > 0) == kept);
        CHECK(depths.shaded == depths.alone);

        Stage stage(gpu, {}, singleSampled(64, 64));
        const Picture picture = stage.draw(stage.place(squares.front.view, {}, view), levels, view);
        CHECK(isMagenta(picture.at(32, 32)) != kept);
    }
}

TEST_CASE("draws of the compute path leave the host's depths, of posed assets and alpha-tested ones") {
    const Gpu gpu;
    if (!gpu.present) return;
    const PosedModel tube(tubeModel({24, 60}), 128);
    REQUIRE(tube.failure == "");
    const Squares kept(0.3f), dropped(0.2f);
    std::mt19937 random(5);
    const RandomPose pose(tube.view, random, 0.6f);
    std::array<DepthStage::Depths, 2> depths;
    for (const bool device : {false, true}) {
        vulkan::RendererConfig config;
        config.jointCapacity = config.morphWeightCapacity = 8;
        config.gpu.views = device;
        DepthStage stage(gpu, config);
        const vulkan::InstanceHandle posed = stage.place(tube.view);
        for (const auto& [squares, x] : {std::pair(&kept, -1.5f), std::pair(&dropped, 1.5f)}) {
            const glm::mat4 there = glm::translate(glm::mat4(1), glm::vec3(x, 2, -1));
            XGC_REQUIRE_OK(stage.renderer.setPlacement(stage.place(squares->front.view), makePlacement(there)));
        }
        const vulkan::ViewDesc view = viewOf(tube.view);
        SelectionDesc desc;
        desc.view = makeView(view.camera.eye, view.camera.fovY, kSize);
        XGC_REQUIRE_OK(stage.renderer.beginFrame());
        XGC_REQUIRE_OK(stage.renderer.setPose(posed, pose.pose()));
        stage.renderer.select(0, desc);
        stage.renderer.endFrame();
        CHECK((stage.renderer.hostReason(0) == nullptr) == device);
        depths[device] = stage.draw(view);
        CHECK(depths[device].shaded == depths[device].alone);
    }
    CHECK(drawn(depths[0].shaded) > kSize * kSize / 30);
    CHECK(depths[0].shaded == depths[1].shaded);
}

TEST_CASE("the sun's shadow lies where something is between, and nowhere else") {
    const Gpu gpu;
    if (!gpu.present) return;
    // A floor, and a square one unit above its middle.
    const HandAsset asset(
        {{-3, 0, -3}, {3, 0, -3}, {3, 0, 3}, {-3, 0, 3}, {-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}},
        {{0, 2, 1}, {0, 3, 2}, {4, 6, 5}, {4, 7, 6}}, 4);
    vulkan::RendererConfig config;
    config.viewCapacity = 2;
    Stage stage(gpu, config, singleSampled(128, 128));
    vulkan::ViewDesc view;
    view.camera.eye = {0, 3, 11};
    view.camera.target = {0, 0, 0};
    stage.place(asset.view, {}, view);
    vulkan::ShadowMap shadows;
    XGC_REQUIRE_OK(shadows.create(gpu.context, 256));
    const glm::vec3 towards = glm::normalize(glm::vec3(0.0f, 1, 0.2f));
    const vulkan::SunView sun = vulkan::sunView(towards, {0, 0, 0}, 5, 256);
    view.sun = vulkan::Sun{towards, glm::vec3(1), shadows.depths(), 256, sun.worldToClip, sun.texelUnits};
    XGC_REQUIRE_OK(stage.renderer.beginFrame());
    SelectionDesc desc;
    desc.view = makeView(view.camera.eye, view.camera.fovY, 128);
    stage.renderer.select(0, desc);
    desc.view = sun.view;
    desc.reference = &stage.renderer.selection(0);
    stage.renderer.select(1, desc);
    stage.renderer.endFrame();
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    XGC_REQUIRE_OK(stage.offscreen.begin(cmd));
    stage.renderer.recordTransfers(cmd);
    shadows.begin(cmd);
    XGC_REQUIRE_OK(stage.renderer.recordDepth(cmd, {1, sun.worldToClip}));
    shadows.end(cmd);
    stage.offscreen.beginRendering(cmd, kMagenta);
    XGC_REQUIRE_OK(stage.renderer.recordDraws(cmd, view));
    stage.offscreen.endRendering(cmd);
    const std::array signals = {stage.renderer.frameDone()};
    uint64_t frame = 0;
    XGC_REQUIRE_OK(stage.offscreen.submit(signals, frame));
    const Picture picture = stage.read(frame);
    // Where a point of the floor is in the picture.
    const auto at = [&](const glm::vec3& p) {
        const glm::vec4 clip = view.camera.worldToClip() * glm::vec4(p, 1);
        return picture.at(uint32_t((clip.x / clip.w * 0.5f + 0.5f) * 128),
                          uint32_t((clip.y / clip.w * 0.5f + 0.5f) * 128));
    };
    const glm::u8vec4 shade = at({0, 0, 0.3f}), lit = at({2.5f, 0, 0.3f});
    CHECK(int(shade.g) + 40 < int(lit.g));
    // The same on all of the lit floor: nothing shadows itself.
    for (const glm::vec3& p :
         {glm::vec3(-2.5f, 0, 0.3f), glm::vec3(-2, 0, 2.5f), glm::vec3(0, 0, 2.7f), glm::vec3(2, 0, 1.5f)}) {
        INFO(p.x << " " << p.z);
        CHECK(std::abs(int(at(p).g) - int(lit.g)) < 12);
    }
}
