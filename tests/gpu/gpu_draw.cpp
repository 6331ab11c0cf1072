#include "gpu_test.h"
#include "hand_asset.h"

#include "meshes/builders.h"

#include "buffer.h"

namespace {

using namespace xgc;
using namespace xgc::test;

/// Twice the signed area of the triangle a b p.
double edge(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

using Projected = std::array<glm::dvec2, 3>; ///< pixels

enum class Cover { outside, edge, inside };

/// Whether a point is in a projected triangle; `edge` where the rasteriser's rounding may decide.
Cover coverOf(const Projected& t, const glm::dvec2& p) {
    const double turn = edge(t[0], t[1], t[2]) < 0 ? -1 : 1;
    double least = 1e30;
    for (size_t i = 0; i < 3; ++i) {
        const glm::dvec2 a = t[i], b = t[(i + 1) % 3];
        least = std::min(least, turn * edge(a, b, p) / glm::length(b - a));
    }
    if (std::abs(least) < 1.0 / 64) return Cover::edge;
    return least > 0 ? Cover::inside : Cover::outside;
}

std::vector<Projected> project(const bake::Model& model, const vulkan::Camera& camera, const glm::dvec2& size) {
    std::vector<Projected> out;
    const glm::dmat4 toClip(camera.worldToClip());
    for (const glm::uvec3& t : model.triangles) {
        Projected corners;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec4 clip = toClip * glm::dvec4(model.positions[t[i]], 1);
            corners[size_t(i)] = (glm::dvec2(clip) / clip.w + 1.0) * 0.5 * size;
        }
        out.push_back(corners);
    }
    return out;
}

/// Pixels whose colour contradicts the projection. On an edge between two triangles one of them covers the pixel, so
/// only the outline is unsure, and passed over.
struct Comparison {
    uint32_t covered = 0;
    uint32_t wrong = 0;
};
Comparison compare(const Picture& picture, const std::vector<Projected>& triangles) {
    Comparison result;
    for (uint32_t y = 0; y < picture.height; ++y) {
        for (uint32_t x = 0; x < picture.width; ++x) {
            bool inside = false, unsure = false;
            for (const Projected& t : triangles) {
                const Cover cover = coverOf(t, {x + 0.5, y + 0.5});
                inside |= cover == Cover::inside;
                unsure |= cover == Cover::edge;
            }
            result.covered += inside;
            if (inside || !unsure) result.wrong += inside == isMagenta(picture.at(x, y));
        }
    }
    return result;
}

} // namespace

TEST_CASE("the validation layer is on and sees a missing barrier") {
    Gpu gpu;
    if (!gpu.present) return;
    gpu.expectMessages = true;
    if (!std::getenv("VK_INSTANCE_LAYERS")) {
        MESSAGE("SKIPPED: VK_INSTANCE_LAYERS is not set (run it by ctest)");
        return;
    }
    vulkan::Buffer from, to;
    XGC_REQUIRE_OK(from.create(gpu.context, 256, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, vulkan::Residence::upload));
    XGC_REQUIRE_OK(to.create(gpu.context, 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT, vulkan::Residence::device));
    vulkan::Offscreen target;
    XGC_REQUIRE_OK(target.create(gpu.context, gpu.device.queue(), singleSampled(8, 8)));
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    XGC_REQUIRE_OK(target.begin(cmd));
    const VkBufferCopy copy{0, 0, 256};
    const vulkan::Functions& vk = gpu.context.vk();
    vk.vkCmdCopyBuffer(cmd, from.handle(), to.handle(), 1, &copy);
    CHECK(gpu.device.messages().empty());
    vk.vkCmdCopyBuffer(cmd, from.handle(), to.handle(), 1, &copy);
    CHECK_FALSE(gpu.device.messages().empty());
}

TEST_CASE("a picture covers the pixels that the projected triangles cover") {
    const Gpu gpu;
    if (!gpu.present) return;
    const bake::Model cube = test::cube(3);
    const HandAsset asset(cube.positions, cube.triangles, 10);
    vulkan::ViewDesc view;
    vulkan::Framing framing;
    framing.towards = {0.6f, 0.5f, 1};
    framing.aspect = 1.25f;
    view.camera = vulkan::frame(cube.positions, framing);
    Stage stage(gpu, {}, singleSampled(200, 160));
    const vulkan::InstanceHandle instance = stage.place(asset.view, {}, view);
    const std::vector<uint8_t> levels(asset.view.patchCount(), 0);
    const std::vector<Projected> projected = project(cube, view.camera, {200, 160});
    for (const auto mode : {vulkan::ShadingMode::shaded, vulkan::ShadingMode::wire}) {
        view.mode = mode;
        const Comparison result = compare(stage.draw(instance, levels, view), projected);
        CHECK(result.covered > 5000);
        CHECK(result.wrong == 0);
    }
}
