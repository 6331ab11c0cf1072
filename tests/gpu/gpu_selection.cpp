#include "gpu_test.h"

#include "meshes/baked_model.h"
#include "meshes/patched_torus.h"
#include "meshes/posed_model.h"
#include "random.h"

#include "barriers.h"
#include "gpu_view.h"

#include <xgc/draw_list.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cstring>

// The compute path beside the host's own: levels, places of instances, draws and index lists, bit for bit.

namespace {

using namespace xgc;
using namespace xgc::test;

/// A frame's commands and draws, as bytes that can be compared.
struct Draws {
    std::vector<uint32_t> ids;
    // A kind each.
    std::array<std::vector<DrawCommand>, shader::kDrawKinds> commands;
    std::array<std::vector<shader::DrawRecord>, shader::kDrawKinds> records;

    size_t commandCount() const {
        size_t count = 0;
        for (const auto& kind : commands) count += kind.size();
        return count;
    }
    std::vector<uint32_t> indices;
};

void append(const AssetView& asset, uint32_t patch, Levels levels, std::vector<uint32_t>& to) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), out(indexCapacity(asset, patch, levels));
    out.resize(buildIndices(asset, patch, levels, scratch, out));
    to.insert(to.end(), out.begin(), out.end());
}

/// What a selection draws, made here: by kind, then by material, whole states before mixed instances, each by its
/// number.
class HostDraws {
public:
    HostDraws(const Scene& scene, const Selection& selection, std::span<const std::vector<uint8_t>> partColors)
        : scene_(scene), selection_(selection), partColors_(partColors) {
        std::vector<uint32_t> states;
        for (uint32_t id = 0; id < scene.instanceEnd(); ++id) {
            if (!scene.hasInstance(id)) continue;
            if (selection.kind(id) == InstanceKind::whole) states.push_back(stateOf(id));
            if (selection.kind(id) == InstanceKind::mixed) mixed_.push_back(id);
        }
        std::sort(states.begin(), states.end());
        states.erase(std::unique(states.begin(), states.end()), states.end());
        for (const uint32_t state : states) placeState(state);
        firstMixed_ = uint32_t(out.ids.size());
        out.ids.insert(out.ids.end(), mixed_.begin(), mixed_.end());
        for (uint32_t i = 0; i < shader::kDrawKinds * kMaterials; ++i) {
            const Kind kind{i % kMaterials, i / kMaterials};
            for (size_t s = 0; s < states.size(); ++s) drawState(states[s], placed_[s], kind);
            for (size_t m = 0; m < mixed_.size(); ++m) drawMixed(mixed_[m], firstMixed_ + uint32_t(m), kind);
        }
    }

    Draws out;
    uint64_t triangles = 0;

private:
    static constexpr uint32_t kMaterials = 16;
    struct Kind {
        uint32_t material, number;
    };
    struct Placed {
        uint32_t first, count;
    };
    static bool isOf(const AssetDesc& desc, uint32_t patch, const Kind& kind) {
        const uint32_t own = desc.asset->patches[patch].material;
        const uint32_t masked = desc.asset->materials[own].flags & format::kAlphaMask ? shader::kDrawMasked : 0;
        const uint32_t posable = desc.asset->joints.empty() ? 0 : shader::kDrawPosable;
        return desc.firstMaterial + own == kind.material && (masked | posable) == kind.number;
    }

    uint32_t stateOf(uint32_t id) const {
        return scene_.assetOf(id) * shader::kWholeStates + selection_.wholeState(id);
    }
    void placeState(uint32_t state) {
        Placed placed{uint32_t(out.ids.size()), 0};
        for (uint32_t id = 0; id < scene_.instanceEnd(); ++id) {
            if (!scene_.hasInstance(id) || selection_.kind(id) != InstanceKind::whole || stateOf(id) != state) continue;
            out.ids.push_back(id);
            ++placed.count;
        }
        placed_.push_back(placed);
    }
    void draw(uint32_t firstIndex, const Placed& placed, const Kind& kind, shader::DrawRecord record) {
        const auto count = uint32_t(out.indices.size()) - firstIndex;
        record.firstInstance = placed.first;
        record.indexBytes = 4;
        out.commands[kind.number].push_back({count, placed.count, firstIndex, 0, placed.first});
        out.records[kind.number].push_back(record);
        triangles += uint64_t(count / 3) * placed.count;
    }
    void drawState(uint32_t state, const Placed& placed, const Kind& kind) {
        const uint32_t id = state / shader::kWholeStates, number = state % shader::kWholeStates;
        const AssetDesc& desc = scene_.asset(id);
        std::vector<uint8_t> levels(desc.asset->patchCount());
        scene_.wholeLevels(id, number, levels);
        const auto first = uint32_t(out.indices.size());
        bool any = false;
        for (uint32_t p = 0; p < levels.size(); ++p) {
            if (!isOf(desc, p, kind)) continue;
            append(*desc.asset, p, levels, out.indices);
            any = true;
        }
        if (!any) return;
        shader::DrawRecord record{};
        record.material = kind.material;
        record.partColor = shader::kPartColorCount;
        record.levelFraction = fraction(*desc.asset, *std::min_element(levels.begin(), levels.end()));
        record.error = scene_.wholeError(id, number);
        record.part = shader::kNothing;
        draw(first, placed, kind, record);
    }
    void drawMixed(uint32_t id, uint32_t place, const Kind& kind) {
        const AssetDesc& desc = scene_.asset(scene_.assetOf(id));
        const Levels levels = selection_.levels(id);
        for (uint32_t p = 0; p < levels.size(); ++p) {
            const format::PatchRecord& patch = desc.asset->patches[p];
            if (!isOf(desc, p, kind) || !selection_.visible(id)[p]) continue;
            const auto first = uint32_t(out.indices.size());
            append(*desc.asset, p, levels, out.indices);
            shader::DrawRecord record{};
            record.material = kind.material;
            record.partColor = partColors_[scene_.assetOf(id)][patch.part];
            record.levelFraction = fraction(*desc.asset, levels[p]);
            record.error = desc.asset->error(p, levels[p]);
            record.part = patch.part;
            draw(first, {place, 1}, kind, record);
        }
    }
    static float fraction(const AssetView& asset, uint32_t level) {
        return float(level) / float(std::max(asset.levelCount(), 2u) - 1);
    }

    const Scene& scene_;
    const Selection& selection_;
    std::span<const std::vector<uint8_t>> partColors_;
    std::vector<uint32_t> mixed_;
    std::vector<Placed> placed_; ///< of the states
    uint32_t firstMixed_ = 0;
};

/// A scene, the host's selection of it and the device's.
class Twins {
public:
    vulkan::RendererConfig config;
    Scene scene;
    Selection selection;
    std::vector<std::vector<uint8_t>> partColors;

    explicit Twins(const Gpu& gpu) : gpu_(gpu) {
        config.assetCapacity = 5;
        config.instanceCapacity = 300;
        config.assetPatchCapacity = 4096;
        config.patchCapacity = 16384;
        config.steeredPartCapacity = 2048;
        config.morphWeightCapacity = 256;
        config.gpu = {.views = 1, .tableBytes = 8 << 20, .indexBytes = 8 << 20, .drawCapacity = 16384};
        sceneConfig_ = {config.assetCapacity, config.instanceCapacity,    config.assetPatchCapacity,
                        config.patchCapacity, config.steeredPartCapacity, config.morphWeightCapacity};
        REQUIRE(scene.create(sceneConfig_).ok());
        REQUIRE(selection.create(sceneConfig_).ok());
        XGC_REQUIRE_OK(pipelines_.create(gpu.context));
        XGC_REQUIRE_OK(gpuScene_.create(gpu.context, config));
        XGC_REQUIRE_OK(view_.create(gpu.context, config, gpuScene_.stateCapacity()));
        madeBytes_ = view_.lists().draws + shader::kDrawKinds * config.gpu.drawCapacity * sizeof(shader::DrawRecord);
        XGC_REQUIRE_OK(back_.create(gpu.context, madeBytes_ + config.gpu.indexBytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                    vulkan::Residence::download));
        XGC_REQUIRE_OK(offscreen_.create(gpu.context, gpu.device.queue(), singleSampled(4, 4)));
    }

    uint32_t add(const AssetView& asset, uint32_t firstMaterial) {
        uint32_t id = 0;
        REQUIRE(scene.addAsset({.asset = &asset, .firstMaterial = firstMaterial}, id).ok());
        partColors.resize(std::max<size_t>(partColors.size(), id + 1));
        for (size_t part = 0; part < asset.parts.size(); ++part) partColors[id].push_back(uint8_t(part % 7));
        XGC_REQUIRE_OK(gpuScene_.addAsset(scene, id, partColors[id]));
        return id;
    }
    void place(uint32_t asset, const Placement& placement) {
        uint32_t id = 0;
        REQUIRE(scene.addInstance(asset, placement, id).ok());
        XGC_REQUIRE_OK(gpuScene_.addInstance(scene, id, ++generation_));
    }
    void move(uint32_t id, const Placement& placement) {
        scene.setPlacement(id, placement);
        gpuScene_.setPlacement(id, placement);
    }
    void remove(uint32_t id) {
        gpuScene_.removeInstance(scene, id);
        scene.removeInstance(id);
    }

    /// Both choose; the device's draws come back.
    void frame(const SelectionDesc& desc) {
        selection.update(scene, desc);
        REQUIRE(vulkan::GpuView::lacks(desc) == nullptr);
        view_.ask(desc);
        VkCommandBuffer cmd = VK_NULL_HANDLE;
        XGC_REQUIRE_OK(offscreen_.begin(cmd));
        gpuScene_.write(scene, ++frame_);
        view_.write(gpuScene_, frame_);
        view_.record(cmd, pipelines_);
        const VkBufferCopy made{0, 0, madeBytes_}, indices{0, madeBytes_, config.gpu.indexBytes};
        gpu_.context.vk().vkCmdCopyBuffer(cmd, view_.buffer(), back_.handle(), 1, &made);
        gpu_.context.vk().vkCmdCopyBuffer(cmd, view_.indices().handle(), back_.handle(), 1, &indices);
        vulkan::memoryBarrier(gpu_.context.vk(), cmd, {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                              {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
        offscreen_.beginRendering(cmd, kMagenta);
        offscreen_.endRendering(cmd);
        uint64_t number = 0;
        XGC_REQUIRE_OK(offscreen_.submit({}, number));
        std::array<std::byte, 64> pixels;
        XGC_REQUIRE_OK(offscreen_.read(number, pixels));
    }

    /// What the device keeps, beside what the host's selection says.
    void compareLevels() {
        const auto* states = at<shader::GpuInstanceState>(0);
        const auto* slots = at<uint32_t>(view_.slotsOffset());
        uint32_t otherKinds = 0, otherStates = 0, otherLevels = 0, otherVisible = 0;
        for (uint32_t id = 0; id < scene.instanceEnd(); ++id) {
            if (!scene.hasInstance(id)) continue;
            const InstanceKind kind = selection.kind(id);
            otherKinds += states[id].kind != uint32_t(kind);
            if (kind == InstanceKind::whole) otherStates += states[id].wholeState != selection.wholeState(id);
            if (kind != InstanceKind::mixed) continue;
            const uint32_t first = scene.firstSlot(id);
            for (uint32_t p = 0; p < selection.levels(id).size(); ++p) {
                otherLevels += ((slots[first + p] >> 8) & 255) != selection.levels(id)[p];
                otherVisible += ((slots[first + p] & shader::kSlotVisible) != 0) != (selection.visible(id)[p] != 0);
            }
        }
        CHECK(otherKinds == 0);
        CHECK(otherStates == 0);
        CHECK(otherLevels == 0);
        CHECK(otherVisible == 0);
    }

    void compareDraws(const Draws& expected) {
        const auto& totals = *at<shader::GpuTotals>(view_.lists().totals);
        CHECK(totals.missingItems == 0);
        CHECK(totals.missingIndices == 0);
        REQUIRE(totals.drawCount == expected.commandCount());
        REQUIRE(totals.indexCount == expected.indices.size());
        CHECK(same(expected.ids, view_.lists().ids));
        CHECK(same(expected.indices, madeBytes_));
        for (uint32_t kind = 0; kind < shader::kDrawKinds; ++kind) {
            const vulkan::GpuView::DrawRange range = view_.drawRange(false, kind);
            REQUIRE(*at<uint32_t>(range.count) == expected.commands[kind].size());
            CHECK(same(expected.commands[kind], range.command));
            CHECK(same(expected.records[kind], view_.lists().draws + range.first * sizeof(shader::DrawRecord)));
        }
    }
    template <typename T>
    const T* at(VkDeviceSize offset) {
        return reinterpret_cast<const T*>(back_.mapped().data() + offset);
    }
    const SceneConfig& sceneConfig() const { return sceneConfig_; }

private:
    template <typename T>
    bool same(const std::vector<T>& expected, VkDeviceSize offset) {
        return expected.empty() ||
               std::memcmp(expected.data(), back_.mapped().data() + offset, expected.size() * sizeof(T)) == 0;
    }

    const Gpu& gpu_;
    SceneConfig sceneConfig_;
    vulkan::GpuPipelines pipelines_;
    vulkan::GpuScene gpuScene_;
    vulkan::GpuView view_;
    vulkan::Buffer back_;
    VkDeviceSize madeBytes_ = 0; ///< of what is compared but for the indices, which follow in back_
    vulkan::Offscreen offscreen_;
    uint32_t generation_ = 0;
    uint64_t frame_ = 0;
};

/// Views of all kinds, from near and far.
SelectionDesc randomDesc(Random& random, int i, std::span<const float> bands) {
    SelectionDesc desc;
    const glm::vec3 eye = random.direction() * std::exp(random.between(0, 5.5f));
    desc.view = makeView(eye, 1, 512);
    desc.view.nearest = i % 3 ? 0.1f : 0.0f;
    if (i % 7 == 3) {
        const glm::vec3 forward = random.direction();
        desc.view = makeOrthographicView(-20.0f * forward, forward, random.between(2, 60), 512);
    }
    if (i % 4 != 1) {
        const glm::mat4 toView = glm::lookAt(eye, random.point(12), glm::vec3(0.1f, 1, 0));
        desc.frustum = makeFrustum(glm::perspectiveRH_ZO(1.0f, 1.5f, 0.1f, 400.0f) * toView);
    }
    desc.pixels = i % 11 == 5 ? 0.0f : random.between(0.05f, 6);
    desc.hysteresis = i % 5 ? 0.1f : 0.0f;
    desc.cullBackfaces = i % 2;
    desc.contributionPixels = i % 6 == 2 ? random.between(1, 40) : 0.0f;
    if (i % 9 == 4) {
        desc.policy = Policy::distanceBands;
        desc.bands = bands;
    }
    return desc;
}

struct Assets {
    OpenAsset small = openBuilt(patchedTorus({.patches = 3, .levels = 2}));
    OpenAsset large = openBuilt(patchedTorus({.patches = 4, .levels = 3, .materials = 3, .repeatedLevels = 1}));
    BakedModel baked{bake::BundledModel::creature, 6000, 150};
    PosedModel tube{tubeModel({24, 60}), 128};
    std::vector<format::MaterialRecord> materials, tubeMaterials;
    AssetView maskedTube = tube.view;
    Assets() {
        REQUIRE(small.failure == "");
        REQUIRE(large.failure == "");
        REQUIRE(baked.failure == "");
        REQUIRE(tube.failure == "");
        materials.assign(large.view.materials.begin(), large.view.materials.end());
        materials[1].flags = format::kAlphaMask;
        large.view.materials = materials;
        tubeMaterials = {tube.view.materials[0]};
        tubeMaterials[0].flags = format::kAlphaMask;
        maskedTube.materials = tubeMaterials;
    }
};

/// Another pose, of what the asset has: joints, targets, both or an empty one; or none.
void repose(Twins& twins, Random& random, uint32_t id) {
    if (random.below(4) == 0) return twins.scene.clearPose(id);
    const AssetView& asset = *twins.scene.asset(twins.scene.assetOf(id)).asset;
    std::mt19937 engine(random.below(1u << 30));
    const RandomPose pose(asset, engine, random.between(0, 1), random.between(0.7f, 1.5f));
    Pose given = pose.pose();
    if (random.below(4) == 0) given.joints = {};
    if (random.below(4) == 0) given.morphWeights = {};
    REQUIRE(twins.scene.setPose(id, given).ok());
}

void steer(Twins& twins, Random& random, uint32_t id) {
    const auto parts = uint32_t(twins.scene.asset(twins.scene.assetOf(id)).asset->parts.size());
    PartControl control;
    control.importance = random.between(0.2f, 4);
    control.bias = int32_t(random.below(5)) - 2;
    control.finest = random.below(3);
    control.coarsest = random.below(3) ? format::kMaxLevels : random.below(6);
    control.hidden = random.below(8) == 0;
    REQUIRE(twins.scene.setPart(id, random.below(parts), control).ok());
}

} // namespace

TEST_CASE("the device chooses, builds and lists what the host does, bit for bit, through random scenes and flights") {
    const Gpu gpu;
    if (!gpu.present) return;
    const Assets assets;
    Twins twins(gpu);
    const uint32_t ids[] = {twins.add(assets.small.view, 1), twins.add(assets.large.view, 0),
                            twins.add(assets.baked.view, 5), twins.add(assets.tube.view, 4),
                            twins.add(assets.maskedTube, 8)};
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        twins.place(ids[i % 5], random.placement(i < 50 ? 6.0f : 90.0f));
        if (i % 5 > 2 && i % 2 == 0) repose(twins, random, uint32_t(i));
    }
    const std::vector<float> bands = {0.5f, 1, 2, 4, 8, 9, 10, 11, 12};
    uint64_t wholes = 0, mixed = 0, culled = 0, posed = 0;
    std::array<uint64_t, shader::kDrawKinds> draws{};
    for (int i = 0; i < 40; ++i) {
        for (int change = 0; change < 9; ++change) {
            const uint32_t id = random.below(200);
            if (!twins.scene.hasInstance(id)) {
                twins.place(ids[random.below(5)], random.placement(20));
            } else if (change == 0) {
                twins.remove(id);
            } else if (change == 1) {
                twins.scene.setVisible(id, random.below(4) != 0);
            } else if (change == 2) {
                random.below(3) ? steer(twins, random, id) : twins.scene.clearParts(id);
            } else if (change < 6) {
                repose(twins, random, id);
            } else {
                twins.move(id, random.placement(30));
            }
        }
        for (uint32_t id = 0; id < twins.scene.instanceEnd(); ++id) {
            posed += twins.scene.hasInstance(id) && !twins.scene.posedPatches(id).empty();
        }
        CAPTURE(i);
        twins.frame(randomDesc(random, i, bands));
        twins.compareLevels();
        const HostDraws host(twins.scene, twins.selection, twins.partColors);
        twins.compareDraws(host.out);
        wholes += twins.selection.stats().wholeInstances;
        mixed += twins.selection.stats().consideredPatches;
        culled += twins.selection.stats().culledPatches;
        for (size_t kind = 0; kind < draws.size(); ++kind) draws[kind] += host.out.commands[kind].size();
    }
    CHECK(wholes > 500);
    CHECK(mixed > 10000);
    CHECK(culled > 2000);
    CHECK(posed > 500);
    for (const uint64_t count : draws) CHECK(count > 500);
}

TEST_CASE("the device draws the triangles that the cached draw list draws") {
    const Gpu gpu;
    if (!gpu.present) return;
    const Assets assets;
    Twins twins(gpu);
    const uint32_t id = twins.add(assets.baked.view, 0);
    Random random(2);
    for (int i = 0; i < 40; ++i) twins.place(id, random.placement(40));
    IndexCache cache;
    DrawList list;
    REQUIRE(cache.create({.assetCapacity = 4}).ok());
    REQUIRE(cache.addAsset(id, assets.baked.view).ok());
    REQUIRE(list.create({.scene = twins.sceneConfig()}).ok());
    std::vector<std::byte> staging(32 << 20);
    for (int i = 0; i < 8; ++i) {
        SelectionDesc desc;
        desc.view = makeView(random.direction() * random.between(5, 80), 1, 512);
        twins.frame(desc);
        cache.beginFrame(staging);
        list.update(twins.scene, twins.selection, cache);
        cache.endFrame();
        REQUIRE(list.stats().deferredInstances == 0);
        const HostDraws host(twins.scene, twins.selection, twins.partColors);
        twins.compareDraws(host.out);
        CHECK(host.triangles == list.stats().triangles);
    }
}
