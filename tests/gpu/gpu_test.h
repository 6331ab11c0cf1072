#pragma once

#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>
#include <xgc/vulkan/renderer.h>

#include <doctest/doctest.h>
#include <glm/gtc/type_precision.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

/// What the GPU tests share: a device whose every validation message fails the test, and a way to a picture.
namespace xgc::test {

inline std::string text(const Status& status) {
    return std::string(status.message) + " (" + std::to_string(int64_t(status.element)) + ")";
}

#define XGC_REQUIRE_OK(call)                                                                                           \
    do {                                                                                                               \
        const xgc::Status xgcStatus = (call);                                                                          \
        INFO(xgc::test::text(xgcStatus));                                                                              \
        REQUIRE(xgcStatus.ok());                                                                                       \
    } while (false)

/// A device for one test. At its end, any message of the validation layer fails the test.
class Gpu {
public:
    explicit Gpu(const VkAllocationCallbacks* allocation = nullptr) {
        vulkan::HeadlessDeviceDesc desc;
        desc.collectMessages = true;
        desc.allocation = allocation;
        const Status status = device.create(desc);
        if (!status.ok()) {
            if (std::getenv("XGC_REQUIRE_DEVICE")) FAIL("no device, and XGC_REQUIRE_DEVICE is set: " << text(status));
            MESSAGE("SKIPPED: " << text(status));
            return;
        }
        XGC_REQUIRE_OK(context.create(device.contextDesc()));
        present = true;
    }
    ~Gpu() {
        if (!present || expectMessages) return;
        for (const std::string& message : device.messages()) FAIL_CHECK("validation: " << message);
    }
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    vulkan::HeadlessDevice device;
    vulkan::Context context;
    bool present = false;
    bool expectMessages = false;
};

struct Picture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<glm::u8vec4> pixels; ///< sRGB, rows from the top

    const glm::u8vec4& at(uint32_t x, uint32_t y) const { return pixels[size_t(y) * width + x]; }
};

/// Pixels of which a channel differs by more than `tolerance`.
inline size_t pixelsApart(const Picture& a, const Picture& b, int tolerance) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        int most = 0;
        for (int k = 0; k < 4; ++k) most = std::max(most, std::abs(int(a.pixels[i][k]) - int(b.pixels[i][k])));
        count += most > tolerance;
    }
    return count;
}

constexpr std::array<float, 4> kMagenta{1, 0, 1, 1};
inline bool isMagenta(const glm::u8vec4& p) {
    return p.r == 255 && p.g == 0 && p.b == 255;
}

/// A small target of one sample a pixel: what is drawn is exact.
inline vulkan::OffscreenDesc singleSampled(uint32_t width, uint32_t height) {
    vulkan::OffscreenDesc desc;
    desc.size = {width, height};
    desc.samples = VK_SAMPLE_COUNT_1_BIT;
    return desc;
}

/// A renderer with a target of its own.
class Stage {
public:
    Stage(const Gpu& gpu, vulkan::RendererConfig config, vulkan::OffscreenDesc target) {
        config.colorFormat = target.colorFormat;
        config.depthFormat = target.depthFormat;
        config.samples = target.samples;
        target.framesInFlight = config.framesInFlight;
        XGC_REQUIRE_OK(renderer.create(gpu.context, config));
        XGC_REQUIRE_OK(offscreen.create(gpu.context, gpu.device.queue(), target));
    }

    /// Records and submits the frame that the renderer has ended. Returns its number.
    uint64_t submit(const vulkan::ViewDesc& view) {
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        XGC_REQUIRE_OK(offscreen.begin(cmd));
        renderer.recordTransfers(cmd);
        offscreen.beginRendering(cmd, kMagenta);
        XGC_REQUIRE_OK(renderer.recordDraws(cmd, view));
        offscreen.endRendering(cmd);
        const std::array signals = {renderer.frameDone()};
        uint64_t frame = 0;
        XGC_REQUIRE_OK(offscreen.submit(signals, frame));
        return frame;
    }

    Picture read(uint64_t frame) {
        Picture picture;
        picture.width = offscreen.desc().size.width;
        picture.height = offscreen.desc().size.height;
        picture.pixels.resize(size_t(picture.width) * picture.height);
        XGC_REQUIRE_OK(offscreen.read(frame, std::as_writable_bytes(std::span(picture.pixels))));
        return picture;
    }

    /// An instance of an asset that is wholly on the device.
    vulkan::InstanceHandle place(const AssetView& asset, const Placement& placement, const vulkan::ViewDesc& view) {
        vulkan::AssetHandle handle;
        XGC_REQUIRE_OK(renderer.addAsset(asset, handle));
        for (int i = 0; i < 10000 && !renderer.resident(handle); ++i) {
            XGC_REQUIRE_OK(renderer.beginFrame());
            renderer.endFrame();
            submit(view);
        }
        REQUIRE(renderer.resident(handle));
        vulkan::InstanceHandle instance;
        XGC_REQUIRE_OK(renderer.addInstance(handle, placement, instance));
        return instance;
    }

    /// One frame with one instance set to the levels.
    Picture draw(vulkan::InstanceHandle instance, Levels levels, const vulkan::ViewDesc& view) {
        XGC_REQUIRE_OK(renderer.beginFrame());
        XGC_REQUIRE_OK(renderer.setLevels(instance, levels));
        renderer.endFrame();
        INFO(text(renderer.drawList().refusal()));
        REQUIRE(renderer.stats().deferredInstances == 0);
        return read(submit(view));
    }

    vulkan::Renderer renderer;
    vulkan::Offscreen offscreen; ///< destroyed first: it waits for the frames
};

} // namespace xgc::test
