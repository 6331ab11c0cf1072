#pragma once

#include <xgc/draw_list.h>
#include <xgc/residency.h>
#include <xgc/vulkan/camera.h>
#include <xgc/vulkan/context.h>

#include <memory>
#include <optional>
#include <string_view>

namespace xgc::vulkan {

/// Names an asset whose streams lie in the vertex arena. Stale once removed: calls with it are refused.
struct AssetHandle {
    uint32_t index = 0;
    uint32_t generation = 0; ///< 0 names nothing
};

struct InstanceHandle {
    uint32_t index = 0; ///< id in the renderer's scene: drawInstances() names it
    uint32_t generation = 0;
};

/// The compute path: the device itself chooses levels, builds index lists and fills in the draws of a view, all of it
/// anew each frame. The same levels, index lists and draws as Selection and buildIndices make, bit for bit.
struct GpuPathConfig {
    uint32_t views = 0;                    ///< the first so many may be selected on the device
    VkDeviceSize tableBytes = 64ull << 20; ///< of all assets: about nine bytes a face at level 0
    uint32_t indexBytes = 64u << 20;       ///< a view: four a drawn index
    uint32_t drawCapacity = 65536;         ///< a view: patches of what is drawn, whole or mixed
    uint32_t runCapacity = 65536;          ///< an instance, or a whole state of an asset, a material each
    /// Pixels of the largest depth image of recordOcclusion; 0: no occlusion. With it a view takes twice the memory.
    uint32_t depthPixels = 0;
};

/// What the compute path made of a view, of the frame framesInFlight ago.
struct GpuStats {
    uint32_t draws = 0;
    uint32_t patches = 0;
    uint32_t indices = 0;
    uint64_t triangles = 0;   ///< of all instances; 2^32 and more a pass are counted wrongly
    uint32_t latePatches = 0; ///< of those: drawn by recordLateDraws
    /// GpuPathConfig::drawCapacity or indexBytes did not suffice, and what came last is not drawn.
    bool incomplete = false;
};

/// Fixed capacities: all memory is taken by `create`.
struct RendererConfig {
    uint32_t assetCapacity = 64;
    uint32_t instanceCapacity = 256;
    uint32_t assetPatchCapacity = 16384;          ///< sum of the patches of all assets
    uint32_t patchCapacity = 16384;               ///< sum of the patches of all instances
    uint32_t steeredPartCapacity = 4096;          ///< sum of the parts of all instances with a PartControl
    uint32_t materialCapacity = 256;              ///< sum of the materials of all assets
    uint32_t slotCapacity = 65536;                ///< largest xgc::scratchCapacity of the assets
    uint32_t domainCapacity = 65536;              ///< largest domain count of the assets
    uint32_t faceCapacity = 131072;               ///< largest AssetRecord::maxPatchFaces of the assets
    uint32_t viewCapacity = 1;                    ///< views with levels of their own: the camera's, shadows', ...
    uint32_t passCapacity = 4;                    ///< calls of recordDraws and recordDepth a frame
    uint32_t indexBytes = 64u << 20;              ///< of the index arena: twice what is drawn and more
    bool narrowIndices = true;                    ///< 16 bits where a patch allows
    VkDeviceSize vertexArenaBytes = 256ull << 20; ///< vertex streams of all assets
    VkDeviceSize stagingBytes = 32ull << 20;      ///< a frame in flight: new indices and streams; at least 64 KiB
    uint32_t framesInFlight = 2;
    uint64_t waitNanoseconds = 10'000'000'000; ///< after which a frame that does not finish is an error

    // The host's attachments.
    VkFormat colorFormat = VK_FORMAT_R8G8B8A8_SRGB;
    VkFormat depthFormat = VK_FORMAT_D32_SFLOAT;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_4_BIT;
    VkCompareOp depthCompare = VK_COMPARE_OP_GREATER; ///< Camera's depth is reversed
    /// Of the attachments of recordDepth, whose format is depthFormat too.
    VkSampleCountFlagBits depthOnlySamples = VK_SAMPLE_COUNT_1_BIT;

    /// Sum of the groups (groupCount of morph.h) of all instances that morph in a view. 0: none does, and no asset
    /// takes the 8 bytes a row that morphs need.
    uint32_t morphGroupCapacity = 0;
    // Poses.
    uint32_t jointCapacity = 0;       ///< sum of the joints of all instances with a pose
    uint32_t morphWeightCapacity = 0; ///< sum of the targets of all instances with a pose

    // Streamed assets.
    /// Whose assets can be drawn: created, not updated yet; outlives the renderer. Beside its pool it takes 16 bytes of
    /// device memory a row (ResidencyConfig::pageRows a slot), and what follows.
    Residency* residency = nullptr;
    bool streamedColors = true;     ///< 4 bytes a row
    uint32_t streamedJointSets = 0; ///< 24 bytes a row each, for assets with skins; at most 2

    GpuPathConfig gpu;
};

/// Capacities that hold `instances` of each of the assets with every patch at its finest: RendererConfig's arenas,
/// staging and counts, grown from `base`; poses for all of them that can have one, and morphs where
/// base.morphGroupCapacity is not 0. For programs that know their assets; engines set budgets.
RendererConfig configFor(std::span<const AssetView* const> assets, uint32_t instances, const RendererConfig& base = {});

enum class ShadingMode : uint32_t {
    shaded,
    parts,
    levels,
    wire,
    error ///< how much of ViewDesc::errorPixels the errors of the drawn levels take as ViewDesc::measured sees them
};
/// By its name here; none for another word.
std::optional<ShadingMode> modeNamed(std::string_view name);

/// A sun, for mode shaded in place of the studio's lights. Without a shadow map nothing is in shadow.
struct Sun {
    glm::vec3 towards{0, 1, 0}; ///< unit, to the sun
    glm::vec3 color{1};         ///< linear
    // A shadow map, such as ShadowMap's.
    VkDeviceAddress depths = 0; ///< reversed, a float a texel, rows from the top
    uint32_t size = 0;          ///< texels a side
    glm::mat4 worldToClip{1};
    float texelUnits = 0; ///< world units that a texel covers
};

struct ViewDesc {
    uint32_t view = 0; ///< whose levels and draws
    Camera camera;
    glm::vec3 sky{0, 1, 0}; ///< unit, up in the world: where the ambient light comes from
    ShadingMode mode = ShadingMode::shaded;
    float linePixels = 1.1f; ///< of the target: width of the edges in mode wire
    // Of mode error.
    View measured;         ///< whose pixels count: the view that levels were selected for
    float errorPixels = 1; ///< end of the scale, 0 or more. What is past it is white
    /// A part of an instance that is drawn in a warm tone; none by default. Instances that are drawn whole show none.
    uint32_t highlightInstance = format::kNone;
    uint32_t highlightPart = format::kNone;
    std::optional<Sun> sun;
};

/// A pass that writes depth alone: a shadow map, a depth prepass.
struct DepthDesc {
    uint32_t view = 0; ///< whose levels and draws
    glm::mat4 worldToClip{1};
    // As vkCmdSetDepthBias.
    float constantBias = 0;
    float slopeBias = 0;
};

/// Sums over all views, but for what the views share.
struct FrameStats {
    uint64_t triangles = 0;
    uint32_t draws = 0;
    uint32_t patchesChanged = 0;     ///< got another level
    uint32_t patchesRebuilt = 0;     ///< index lists that were built, patches' or whole assets'
    uint32_t uploadBytes = 0;        ///< indices, vertex streams and rows of pages
    uint32_t deferredInstances = 0;  ///< are not drawn at the levels that were selected: staging or arena was full
    uint32_t unmorphedInstances = 0; ///< stand at their levels: RendererConfig::morphGroupCapacity is too small
};

/// What a host's own passes need, with shaders and pipelines of their own (shared.h has the records): valid from
/// endFrame to the next beginFrame.
struct FrameGeometry {
    VkBuffer indices = VK_NULL_HANDLE; ///< u16 or u32 as DrawBatch::indexBytes says
    VkDeviceAddress indicesAddress = 0;
    VkBuffer commands = VK_NULL_HANDLE; ///< a DrawCommand each draw
    VkDeviceSize commandsOffset = 0;
    VkDeviceAddress instances = 0;   ///< InstanceRecord, by id
    VkDeviceAddress instanceIds = 0; ///< ids, by firstInstance of a draw and up
    VkDeviceAddress draws = 0;       ///< DrawRecord, by number of the draw
    VkDeviceAddress materials = 0;   ///< MaterialRecord
    std::span<const DrawBatch> batches;
    VkDeviceAddress lambdaOffsets = 0; ///< a uint each instance, by id: of its lambdas; kNoLambdas: it does not morph
    VkDeviceAddress lambdas = 0;       ///< a float a group; 0, as is lambdaOffsets, where morphGroupCapacity is 0
};

/// Draws instances of assets at any mix of levels with the host's device, queue and attachments. A frame:
///
///     residency.want(..) for each view, where assets are streamed
///     renderer.beginFrame();                        // waits for the frame framesInFlight ago, for nothing else
///     for each view: renderer.select(view, desc);   // or setLevels, instance by instance
///     renderer.endFrame();
///     renderer.recordTransfers(cmd);                // outside rendering, before any draw
///     vkCmdBeginRendering(cmd, ...), viewport, scissor
///     renderer.recordDraws(cmd, view);
///     vkCmdEndRendering(cmd)
///     vkQueueSubmit2(queue, ... signal renderer.frameDone() ...);
///
/// Every frame that was begun must be recorded and submitted, in order, on one queue. Frames allocate nothing.
/// One thread at a time. Positions are float3 at any scale; draws are opaque or, where a material says so,
/// alpha-tested.
class Renderer {
public:
    Renderer();
    ~Renderer(); ///< the host has waited for its frames
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Takes all memory and makes the pipelines. `context` outlives the renderer.
    Status create(const Context& context, const RendererConfig& config);

    /// Starts sending the asset's streams, some each frame. The view and its bytes outlive the asset here.
    Status addAsset(const AssetView& asset, AssetHandle& handle);
    /// An asset of RendererConfig::residency, which the renderer updates in `beginFrame` and tells in `endFrame` what
    /// its views draw: the host calls `want` alone. Its instances are drawn once it is ready. Selected on the host, it
    /// does not morph, and no morph target moves it.
    Status addStreamedAsset(uint32_t residencyAsset, AssetHandle& handle);
    /// True once a frame up to the current one has everything of the asset, or the first pages of a streamed one: its
    /// instances can be drawn.
    bool resident(AssetHandle asset) const;
    /// Its instances must be gone. Its memory is reused when no frame in flight reads it; the residency's asset may be
    /// removed framesInFlight frames later.
    Status removeAsset(AssetHandle asset);

    /// Drawn once its asset is resident and a view selects it.
    Status addInstance(AssetHandle asset, const Placement& placement, InstanceHandle& handle);
    Status setPlacement(InstanceHandle instance, const Placement& placement);
    Status setVisible(InstanceHandle instance, bool visible);
    /// As Scene::setPose: in all views from the next endFrame on, until it is told otherwise.
    Status setPose(InstanceHandle instance, const Pose& pose);
    Status clearPose(InstanceHandle instance);
    /// As Scene::setPart.
    Status setPart(InstanceHandle instance, uint32_t part, const PartControl& control);
    Status clearParts(InstanceHandle instance);
    Status removeInstance(InstanceHandle instance);

    Status beginFrame();
    /// Chooses the levels of all instances for a view; it keeps them until it is asked again. On the device, where
    /// GpuPathConfig::views says so and nothing speaks against it; else here.
    void select(uint32_t view, const SelectionDesc& desc);
    /// Why the view's latest selection was made here, by the name of what the device or the compute path lacks; null
    /// where it is made on the device.
    const char* hostReason(uint32_t view) const;
    const GpuStats& gpuStats(uint32_t view) const;
    /// The host's own choice for one instance, in view 0, and fractions where it is to morph. outOfCapacity while its
    /// asset is not resident.
    Status setLevels(InstanceHandle instance, Levels levels, std::span<const float> fractions = {});
    /// Brings the draws of all views up to their levels, as far as staging and arena allow.
    void endFrame();

    void recordTransfers(VkCommandBuffer cmd) const;
    /// A light grey gradient over the whole target; no depth. Optional.
    void recordBackground(VkCommandBuffer cmd) const;
    /// One vkCmdDrawIndexedIndirect a material and size of index, opaque materials before alpha-tested ones. Viewport
    /// and scissor are the host's.
    Status recordDraws(VkCommandBuffer cmd, const ViewDesc& view);
    /// Likewise to a depth attachment alone (RendererConfig::depthOnlySamples): opaque materials without a fragment
    /// stage. The same vertices at the same clip space get the same depths as in recordDraws, bit for bit.
    Status recordDepth(VkCommandBuffer cmd, const DepthDesc& pass);
    /// To be signalled by the host's submission of the frame.
    VkSemaphoreSubmitInfo frameDone() const;

    /// Occlusion, for views on the device: recordDraws draws what was seen in the last frame, recordOcclusion looks
    /// what its depth hides of the rest, and recordLateDraws draws what that does not. So nothing is missing that can
    /// be seen, and a view with occlusion takes all three in every frame, in one command buffer:
    ///
    ///     recordDraws(cmd, view); vkCmdEndRendering(cmd); depth to VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL
    ///     recordOcclusion(cmd, view, depth, size); depth back; vkCmdBeginRendering(cmd, ... loads ...)
    ///     recordLateDraws(cmd, view);
    ///
    /// `depth`: of the whole view, single-sampled D32_SFLOAT, reversed (near is 1). For what is selected on the host
    /// the two do nothing. From the view's next select on.
    void useOcclusion(uint32_t view, bool use);
    Status recordOcclusion(VkCommandBuffer cmd, const ViewDesc& view, VkImage depth, VkExtent2D size);
    Status recordLateDraws(VkCommandBuffer cmd, const ViewDesc& view);

    FrameGeometry geometry(uint32_t view = 0) const;
    /// Of the latest endFrame.
    const FrameStats& stats() const;
    const Scene& scene() const;
    const Selection& selection(uint32_t view = 0) const;
    const DrawList& drawList(uint32_t view = 0) const;
    const IndexCache& indexCache() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc::vulkan
