#pragma once

#include <xgc/bake/image.h>
#include <xgc/bake/status.h>
#include <xgc/vulkan/camera.h>
#include <xgc/vulkan/headless_device.h>
#include <xgc/vulkan/offscreen.h>
#include <xgc/vulkan/renderer.h>

#include <memory>
#include <vector>

namespace xgc::bench {

/// An asset at a place, at levels.
struct Posed {
    const AssetView* asset = nullptr;
    Placement placement;
    std::vector<uint8_t> levels;
};

/// Takes pictures of scenes of baked assets, shaded, without a window.
class Photographer {
public:
    /// deviceRefused where no device is there.
    Status create(uint32_t width, uint32_t height);
    /// `assets`: all that the scene may show, of which the largest is drawn `copies` times at most.
    Status begin(std::span<const AssetView* const> assets, uint32_t copies);
    Status take(const std::vector<Posed>& scene, const vulkan::Camera& camera, bake::Image& out);

private:
    Status drawFrame(const vulkan::Camera& camera, uint64_t& ticket);

    // Destroyed from the last up: the target waits for its frames before anything that they use goes.
    vulkan::HeadlessDevice device_;
    vulkan::Context context_;
    std::unique_ptr<vulkan::Renderer> renderer_;
    vulkan::Offscreen target_;
};

} // namespace xgc::bench
