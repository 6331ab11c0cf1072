#pragma once

#include "culling.h"
#include "level_choice.h"
#include "scene.h"

#include <xgc/selection.h>

namespace xgc {

/// An instance as one view sees it.
struct ViewInstance {
    uint32_t generation = 0; ///< of the scene's instance that this was written for
    InstanceKind kind = InstanceKind::culled;
    bool whole = false;            ///< takes one level, whether culled or not
    bool fresh = true;             ///< its patches have no level yet
    uint8_t wholeState = kNoLevel; ///< kept while whole
    bool inBelt = false;           ///< mixed, but near where it would be whole
    bool morphs = false;           ///< has fractions, since it came into sight
    // What its patches' KeptLevels hold for.
    uint32_t keptEpoch = 0; ///< 0: nothing
    float keptScale = 0;
    bool keptInBelt = false;
};

/// Squared distances, from the first and below the second, at which a patch surely keeps its level.
struct KeptLevel {
    float from = 0, before = 0;
};

/// What a pass over some instances counted; cache lines of their own for threads.
struct alignas(64) ChunkCount {
    SelectionStats stats;
    uint64_t triangles = 0;
};

struct Selection::Impl : Allocated<Selection::Impl> {
    static constexpr uint32_t kChunk = 32; ///< instances a job

    SceneConfig config;
    FixedArray<ViewInstance> instances;
    FixedArray<uint8_t> wanted;             ///< by slot: the policy's own level, kNoLevel before the first
    FixedArray<uint8_t> levels;             ///< by slot: after controls, reference and culling
    FixedArray<uint8_t> visible;            ///< by slot
    FixedArray<float> fractions;            ///< by slot: of instances that morph
    FixedArray<float> keptFrom, keptBefore; ///< by slot: KeptLevel
    FixedArray<ChunkCount> chunks;
    SelectionStats stats;

    // The latest update's.
    const Scene::Impl* scene = nullptr;
    SelectionDesc desc;
    LevelPolicy policy;
    uint32_t epoch = 1;        ///< rises where the policy asks for something else than before, the eye aside
    bool steadyPolicy = false; ///< it does not, and KeptLevels know its kind

    bool allocate();

    /// One instance, as a pass works on it.
    struct Subject {
        const SceneInstance& instance;
        const SceneAsset& stored;
        const AssetView& asset;
        ViewInstance& own;
        std::span<const PatchBounds> patches;
        std::span<const PartControl> controls; ///< empty: not steered
        std::span<const PosedPatch> posed;     ///< empty: without a pose
        std::span<const float> morphWeights;
        std::span<uint8_t> wanted, levels, visible;
        std::span<float> fractions;
        // Of the reference.
        const Impl* reference = nullptr;
        const ViewInstance* referenceOwn = nullptr;

        /// In mesh space, posed where the instance is.
        Sphere bounds() const {
            const glm::vec4& s = instance.posedSphere;
            return posed.empty() ? sphereOf(*asset.record) : Sphere{glm::vec3(s), s.w};
        }
        Sphere patchBounds(uint32_t patch) const {
            const glm::vec4& s = posed.empty() ? patches[patch].sphere : posed[patch].sphere;
            return {glm::vec3(s), s.w};
        }
        /// Where cones are tested from; no cone holds in a pose.
        MeshEye eye(const SelectionDesc& by) const {
            const bool tests = by.cullBackfaces && posed.empty();
            return tests ? meshEye(by.view, instance.placement) : MeshEye{};
        }
        LevelTest wholeTest(const LevelPolicy& by, const Scene::Impl& in) const;
        LevelTest patchTest(const LevelPolicy& by, uint32_t patch) const;
        uint32_t controlled(uint32_t patch, uint32_t level) const;
        float lambda(uint32_t patch) const { return float(levels[patch]) + fractions[patch]; }
        bool hidden(uint32_t patch) const { return !controls.empty() && controls[patches[patch].part].hidden; }
    };
    Subject subject(uint32_t id);

    void begin(const Scene& scene, const SelectionDesc& desc);
    void enter(uint32_t id);
    void decideWhole(const Subject& s);
    void cull(const Subject& s);
    uint32_t levelThere(const Subject& s, uint32_t patch, uint32_t hint) const;
    uint32_t withReference(const Subject& s, uint32_t patch, uint32_t level) const;
    float continuousWithReference(const Subject& s, uint32_t patch, float lambda) const;
    float nextLambda(const Subject& s, uint32_t patch, bool glides) const;
    void chooseWhole(const Subject& s, ChunkCount& count);
    void chooseMixed(const Subject& s, ChunkCount& count);
    void chooseContinuous(const Subject& s, ChunkCount& count);
    bool isSteady(const Subject& s) const;
    KeptLevel keptLevel(const LevelTest& test, uint32_t level, bool mayCoarsen) const;
    struct Block;
    void forgetKept(const Subject& s);
    void chooseAnew(const Subject& s, const Block& block);
    void takeLevels(const Subject& s, const Block& block, const MeshEye& eye, ChunkCount& count);
    void chooseSteady(const Subject& s, ChunkCount& count);
    void choose(uint32_t id, ChunkCount& count);

    // Budgets (budget.cpp).
    enum class Count : uint32_t { most, least };
    /// Triangles of all that is visible with each patch at the coarsest level that fits: a bound from above, or what no
    /// choice within the pixels can be below.
    uint64_t countAt(float pixels, Count which);
    uint64_t countInstance(uint32_t id, const LevelPolicy& at, Count which);
    /// Triangles that the chosen levels draw at most.
    uint64_t countChosen();
    uint64_t boundOf(const Subject& s) const;
    float pixelsWithin(uint64_t budget, float least, Count which);
    void meetBudget();

    /// work(id, count) for each instance that is there, on the host's jobs; the counts are left in `chunks`.
    template <typename Work>
    void forInstances(Work work);
};

// In the innermost loop.
inline LevelTest Selection::Impl::Subject::patchTest(const LevelPolicy& by, uint32_t patch) const {
    const PatchBounds& bounds = patches[patch];
    const Sphere sphere = patchBounds(patch);
    const float steering = controls.empty() ? 1 : controls[bounds.part].importance;
    const size_t count = asset.levelCount();
    LevelTest test{by, asset.patchErrors.subspan(patch * count, count), bounds.importance * steering,
                   asset.record->sphereRadius, standingFor(by, instance.placement, sphere)};
    if (posed.empty()) return test;
    test.posedAsset = &asset;
    test.posed = &posed[patch];
    test.patch = patch;
    test.morphWeights = morphWeights;
    return test;
}

inline uint32_t Selection::Impl::Subject::controlled(uint32_t patch, uint32_t level) const {
    return controls.empty() ? level : steered(controls[patches[patch].part], level, asset.levelCount());
}

template <typename Work>
void Selection::Impl::forInstances(Work work) {
    struct Pass {
        Impl& self;
        Work& work;
        static void run(void* data, uint32_t chunk) {
            Pass& pass = *static_cast<Pass*>(data);
            ChunkCount& count = pass.self.chunks[chunk] = {};
            const uint32_t end = std::min(pass.self.scene->instanceEnd, (chunk + 1) * kChunk);
            for (uint32_t id = chunk * kChunk; id < end; ++id) {
                if (pass.self.scene->instances[id].generation % 2 == 1) pass.work(id, count);
            }
        }
    } pass{*this, work};
    const uint32_t count = (scene->instanceEnd + kChunk - 1) / kChunk;
    if (desc.jobs.run && count > 1) return desc.jobs.run(desc.jobs.user, count, &Pass::run, &pass);
    for (uint32_t chunk = 0; chunk < count; ++chunk) Pass::run(&pass, chunk);
}

} // namespace xgc
