#pragma once

#include <xgc/indices.h>
#include <xgc/jobs.h>
#include <xgc/scene.h>

#include <glm/vec4.hpp>

namespace xgc {

/// Half-spaces of world space, dot(plane.xyz, x) + plane.w >= 0 inside.
struct Frustum {
    std::array<glm::vec4, 6> planes{};
    uint32_t planeCount = 0; ///< 0: everything is inside
};

/// The planes of a clip space with -w <= x, y <= w and 0 <= z <= w (Vulkan, D3D), reversed or not, with a far plane or
/// without.
Frustum makeFrustum(const glm::mat4& worldToClip);

enum class Policy : uint32_t {
    errorPixels,   ///< the coarsest level whose error projects to at most `pixels`
    distanceBands, ///< the number of `bands` at or below the distance, in radii of the asset
};

class Selection;

/// What a view asks for.
struct SelectionDesc {
    View view;
    Policy policy = Policy::errorPixels;
    float pixels = 1;             ///< of errorPixels; not negative
    std::span<const float> bands; ///< of distanceBands, rising; read during `update` alone
    /// 0 to below 1. A patch that changed its level keeps it while its distance stays within a factor of 1 - hysteresis
    /// of where that was, either way.
    float hysteresis = 0;

    // Culling. What is culled takes its coarsest level (for faces turned away: the coarsest at which they surely are)
    // and is not drawn.
    Frustum frustum;
    bool cullBackfaces = false;   ///< by the patches' normal cones; double-sided materials are never culled
    float contributionPixels = 0; ///< culls what covers a smaller radius on screen

    /// Not 0: at most so many triangles over all instances (errorPixels only; three indices each). `pixels` is raised
    /// as far as needed, which minimises the largest weighted error but for a part in 128 and for what bounding the
    /// triangles of patches beside finer ones costs. Give View::nearest: else what the eye is inside of stays at level
    /// 0.
    uint32_t triangleBudget = 0;
    bool boundPixels = false; ///< also computes SelectionStats::pixelsBound, at the cost of as much work again

    /// Another selection of the same scene, updated before in this frame (a shadow's: the main view's). No patch gets a
    /// level more than `coarserThanReference` above what it has there; one that is culled there, above what it would
    /// have. Null: none.
    const Selection* reference = nullptr;
    uint32_t coarserThanReference = 0;

    /// From so many radii of an asset's bounds on, an instance whose parts nobody steers is in one of the states of
    /// Scene::wholeLevels, decided at once (errorPixels only). Infinite: never.
    float wholeBeyond = 6;

    JobSystem jobs;

    /// Levels that change continuously (morph.h): each patch also gets a fraction of the way to its next level. Without
    /// hysteresis and budget (asserted). No instance is whole; culled patches keep the levels that they would have in
    /// sight, and are not drawn.
    bool morph = false;
    /// Most levels by which a patch may change in an update. What comes into sight takes its levels at once.
    float morphRate = 0.125f;
};

struct SelectionStats {
    uint32_t visibleInstances = 0;
    uint32_t wholeInstances = 0;    ///< of those: decided at once
    uint32_t consideredPatches = 0; ///< of the others
    uint32_t culledPatches = 0;     ///< of those
    uint32_t changedPatches = 0;    ///< of those: other level than in the last update
    float pixels = 0;               ///< that the levels hold: desc.pixels, or more under a budget
    // Under a budget.
    uint32_t triangleBudget = 0; ///< the desc's
    uint64_t triangleBound = 0;  ///< the levels draw no more than this
    bool overBudget = false;     ///< even the coarsest levels, which were chosen then, exceed it
    float pixelsBound = 0;       ///< where asked for: no choice of levels (of a state, for whole instances) holds less
};

/// How an instance is drawn in a view.
enum class InstanceKind : uint32_t {
    culled, ///< not at all
    whole,  ///< in state `wholeState` of Scene::wholeLevels
    mixed,  ///< patches at `levels`, where `visible`
};

/// The levels of all instances of a scene for one view, and what it remembers of the last frame.
///
/// All memory is allocated by `create`; `update` allocates nothing. Decisions use +, -, * and comparisons of floats in
/// a fixed order, budgets excepted. One thread at a time; `update` itself runs on the host's jobs.
class Selection {
public:
    Selection();
    ~Selection();
    Selection(Selection&&) noexcept;
    Selection& operator=(Selection&&) noexcept;

    /// For scenes made with the same capacities, or smaller ones.
    Status create(const SceneConfig& config);

    /// Chooses the levels for all instances.
    ///
    /// Promise of errorPixels: no drawn patch lies farther than stats().pixels on screen from the input's surface,
    /// divided by its part's importance, but where a PartControl or a reference decides, or what a streamed asset
    /// (residency.h) has not got yet.
    ///
    /// With `morph`, a patch at level l and fraction f has errors of (1 - f) E(l) + f E(l + 1) within the pixels: where
    /// f is 0 that is the promise above; between two levels the drawn surface lies between theirs, and its error is
    /// measured, not proved, to follow. Errors that rise by less than an eighth from level to level are taken to rise
    /// by that, so a change of the distance to the patch's bounds by one part in n an update changes its level by no
    /// more than 9 / n: under 1/72 an update `morphRate`'s default never binds. Faster views lag behind, and what they
    /// near is coarser than asked for until it has caught up. Distances take a division and a square root here.
    void update(const Scene& scene, const SelectionDesc& desc);
    /// The host's own choice for an instance, in place of a policy's: `levels` of all its patches, and their fractions
    /// where it is to morph; no finer than is there of a streamed asset. Until the next update.
    void set(const Scene& scene, uint32_t instance, Levels levels, std::span<const float> fractions = {});

    InstanceKind kind(uint32_t instance) const;
    uint32_t wholeState(uint32_t instance) const;
    /// Of an instance of kind mixed: a level each patch, and 1 where it is drawn.
    Levels levels(uint32_t instance) const;
    std::span<const uint8_t> visible(uint32_t instance) const;
    /// Likewise, a fraction each patch, 0 to kMaxFraction of morph.h; empty where the instance does not morph.
    std::span<const float> fractions(uint32_t instance) const;
    const SelectionStats& stats() const;

    struct Impl; ///< private
    const Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
