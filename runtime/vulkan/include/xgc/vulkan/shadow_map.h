#pragma once

#include <xgc/select.h>
#include <xgc/vulkan/context.h>

#include <memory>

namespace xgc::vulkan {

/// How a sun sees a sphere of the world: orthographic, reversed depth.
struct SunView {
    View view; ///< for Selection: pixels are texels
    glm::mat4 worldToClip{1};
    float texelUnits = 0; ///< world units that a texel covers
};
/// `towards`: unit, to the sun. A sphere that moves keeps its texels in place in the world.
SunView sunView(const glm::vec3& towards, const glm::vec3& center, float radius, uint32_t texels);

/// A square depth map that shaders read by address, without a descriptor. A frame, outside rendering:
///
///     shadows.begin(cmd);
///     renderer.recordDepth(cmd, {.view = 1, .worldToClip = sun.worldToClip});
///     shadows.end(cmd);      // from here on fragment stages read it: Sun::depths = shadows.depths()
class ShadowMap {
public:
    ShadowMap();
    ~ShadowMap(); ///< the host has waited for its frames
    ShadowMap(ShadowMap&&) noexcept;
    ShadowMap& operator=(ShadowMap&&) noexcept;

    /// `texels` a side, of RendererConfig::depthFormat D32_SFLOAT and one depthOnlySample. `context` outlives it.
    Status create(const Context& context, uint32_t texels);

    /// Begins rendering with the map cleared to infinitely far; sets viewport and scissor.
    void begin(VkCommandBuffer cmd);
    void end(VkCommandBuffer cmd);

    uint32_t texels() const;
    /// A float a texel, rows from the top: of the latest `end` on the queue.
    VkDeviceAddress depths() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc::vulkan
