#pragma once

#include "asset_store.h"
#include "gpu_shared.h"

#include <xgc/scene.h>

#include <array>
#include <vector>

namespace xgc::vulkan {

/// What compute shaders know of a scene: the tables of its assets, and what the host says of its instances each frame.
///
/// Tables lie in one buffer that the host writes where no frame reads. Of a frame there is a part a frame in flight:
///
///     [ assets | instances | controls | runs | posed patches | weights of poses ]
class GpuScene {
public:
    Status create(const Context& context, const RendererConfig& config);

    /// Writes the tables of an asset of the scene. `unsupported` where shaders cannot draw it; on failure nothing
    /// changes.
    Status addAsset(const Scene& scene, uint32_t asset, std::span<const uint8_t> partColors);
    /// Its instances must be gone.
    void removeAsset(uint32_t asset, uint64_t frame);

    Status addInstance(const Scene& scene, uint32_t instance, uint32_t generation);
    void setPlacement(uint32_t instance, const Placement& placement);
    void removeInstance(const Scene& scene, uint32_t instance);

    /// Begins a frame's part and writes it. Frees what no frame in flight reads.
    void write(const Scene& scene, uint64_t frame);

    /// Fills in where the frame's part lies.
    void address(shader::GpuFrame& frame) const;
    uint32_t stateCapacity() const { return assetCapacity_ * shader::kWholeStates; }

private:
    /// Patches of a material, as runs of an asset's order.
    struct Group {
        uint32_t rank; ///< in the order of draws: kDraw... in the highest bits, then the material's number
        uint32_t first, count;
    };
    static constexpr uint32_t kKindBit = 30;
    struct Asset {
        shader::GpuAsset record{};
        RangeList::Range bytes;
        std::vector<Group> groups;
        uint32_t instances = 0;
    };
    struct Retired {
        uint64_t frame;
        RangeList::Range bytes;
    };

    void orderPatches(const Scene& scene, uint32_t asset, std::vector<uint32_t>& order);
    void listRuns(const Scene& scene);
    void writePose(const Scene& scene, uint32_t instance, std::byte* to, uint32_t& weightCount);
    uint32_t runsOf(const Asset& asset, uint32_t subjects) const { return uint32_t(asset.groups.size()) * subjects; }

    Buffer tables_;
    RangeList tableRanges_;
    std::vector<Retired> retired_; ///< oldest first
    Buffer frames_;
    VkDeviceSize instancesAt_ = 0, controlsAt_ = 0, runsAt_ = 0, posedAt_ = 0, weightsAt_ = 0;
    VkDeviceSize bytesPerFrame_ = 0, begin_ = 0;
    uint32_t framesInFlight_ = 1;
    uint32_t assetCapacity_ = 0, runCapacity_ = 0;

    std::vector<Asset> assets_; ///< by id of the scene
    uint32_t assetEnd_ = 0;
    std::vector<shader::GpuInstance> instances_; ///< by id
    uint32_t instanceEnd_ = 0;
    uint32_t runsNeeded_ = 0;
    std::vector<std::pair<uint32_t, shader::GpuRun>> runs_;   ///< with their ranks, in the order of the draws
    std::array<uint32_t, shader::kDrawKinds - 1> kindRuns_{}; ///< where those of kinds 1 and on begin
    uint64_t runsVersion_ = 1;                                ///< rises with them
    bool runsStale_ = false;
    std::vector<uint64_t> writtenRuns_; ///< version in each part
};

} // namespace xgc::vulkan
