#pragma once

#include <xgc/asset.h>
#include <xgc/select.h>
#include <xgc/skin.h>

#include <glm/vec4.hpp>

#include <memory>

namespace xgc {

/// What selection reads of a patch, without the rest of its record.
struct PatchBounds {
    glm::vec4 sphere; ///< mesh space
    glm::vec3 coneAxis;
    float coneSine;   ///< of the angle between the axis and its farthest normal; above 1: no cone
    float importance; ///< of its part
    uint32_t coneLevel;
    uint32_t part;
};

/// How a part of an instance is steered. Applied after the policy: bias first, then the limits.
struct PartControl {
    float importance = 1;                   ///< times the part's own: 2 asks for half the error; positive
    int32_t bias = 0;                       ///< levels added to the policy's choice: positive is coarser
    uint32_t finest = 0;                    ///< no level below (finer than) this
    uint32_t coarsest = format::kMaxLevels; ///< no level above this; wins over `finest`
    bool hidden = false;                    ///< not drawn; its neighbours stay as they are

    /// One level, whatever the view.
    static PartControl pinned(uint32_t level) { return {.finest = level, .coarsest = level}; }
};

/// An asset, and where a renderer keeps what belongs to it.
struct AssetDesc {
    const AssetView* asset = nullptr; ///< outlives its id in the scene
    int32_t vertexOffset = 0;         ///< of its row 0 in the renderer's vertex buffers
    uint32_t firstMaterial = 0;       ///< its material 0 in the renderer's list
};

struct SceneConfig {
    uint32_t assetCapacity = 64;
    uint32_t instanceCapacity = 256;
    uint32_t assetPatchCapacity = 65536; ///< sum of the patches of all assets
    uint32_t patchCapacity = 65536;      ///< sum of the patches of all instances
    uint32_t steeredPartCapacity = 4096; ///< sum of the parts of all instances with a PartControl
    uint32_t morphWeightCapacity = 1024; ///< sum of the targets of all instances with a pose that has weights
};

/// What stands where: assets, instances of them, and how their parts are steered. Knows no views: any number of
/// Selections and DrawLists read one scene. An id is reused after its removal; views notice.
///
/// All memory is allocated by `create`. Changes and readers exclude each other; any number of threads may read. A call
/// with an id of nothing is a programming error (asserted).
class Scene {
public:
    Scene();
    ~Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;

    Status create(const SceneConfig& config);
    const SceneConfig& config() const;

    /// On failure `id` is untouched, and the status' element is the value that would have sufficed.
    Status addAsset(const AssetDesc& desc, uint32_t& id);
    /// Its instances must be gone.
    void removeAsset(uint32_t asset);
    const AssetDesc& asset(uint32_t asset) const;
    std::span<const PatchBounds> patchBounds(uint32_t asset) const;

    Status addInstance(uint32_t asset, const Placement& placement, uint32_t& id);
    void removeInstance(uint32_t instance);
    void setPlacement(uint32_t instance, const Placement& placement);
    const Placement& placement(uint32_t instance) const;
    /// An instance that is not visible is culled in every view. They start visible.
    void setVisible(uint32_t instance, bool visible);
    bool visible(uint32_t instance) const;
    uint32_t assetOf(uint32_t instance) const;
    /// The patches of an instance have numbers of their own from here on, below patchCapacity, while it lives: for what
    /// a host keeps of each.
    uint32_t firstSlot(uint32_t instance) const;

    /// Moves an instance by joints and blend shapes, until it is told otherwise: selections cull by where its patches
    /// then are, and choose levels by their errors there. A posed instance is never whole, and no normal cone culls it.
    /// Copies what it needs. Fails only where morphWeightCapacity is taken.
    Status setPose(uint32_t instance, const Pose& pose);
    void clearPose(uint32_t instance);
    /// What the pose does to each patch; empty where it has none.
    std::span<const PosedPatch> posedPatches(uint32_t instance) const;
    /// Around them all, in mesh space, and the weights of targets; of an instance with a pose.
    glm::vec4 posedSphere(uint32_t instance) const;
    std::span<const float> posedWeights(uint32_t instance) const;

    /// Steers a part of one instance. Fails only where steeredPartCapacity is taken.
    Status setPart(uint32_t instance, uint32_t part, const PartControl& control);
    PartControl part(uint32_t instance, uint32_t part) const;
    /// True where a part of the instance was steered since it was added, or cleared.
    bool steered(uint32_t instance) const;
    /// Gives all parts of the instance back to the policies.
    void clearParts(uint32_t instance);

    /// States of an asset as a whole: in each, every patch is at the coarsest level whose error, times its part's
    /// importance, is at most the state's. These errors rise by a quarter of an octave, from 0 to the asset's largest.
    uint32_t wholeStateCount(uint32_t asset) const;
    float wholeError(uint32_t asset, uint32_t state) const;
    /// `levels`: patchCount entries.
    void wholeLevels(uint32_t asset, uint32_t state, std::span<uint8_t> levels) const;
    /// Triangles of the state, or somewhat more.
    uint32_t wholeTriangles(uint32_t asset, uint32_t state) const;

    /// Ids of instances lie below this; not all of them name one.
    uint32_t instanceEnd() const;
    bool hasInstance(uint32_t instance) const;

    struct Impl; ///< private
    const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
