#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/select.h>

#include <filesystem>
#include <vector>

namespace xgc::scene_sample {

/// An .xgc file in memory, opened in place.
struct LoadedAsset {
    bake::AlignedBytes bytes;
    AssetView view;

    bake::Status load(const std::filesystem::path& file);
};

/// Heights of a terrain in world space, on a grid.
class Ground {
public:
    Ground(const AssetView& terrain, const glm::mat4& toWorld);

    float height(float x, float z) const;
    /// Largest difference of heights in a circle.
    float roughness(float x, float z, float radius) const;
    /// Of the places within `within` of the middle, the flattest circle.
    glm::vec3 flattest(float radius, float within) const;

private:
    static constexpr int kCells = 256;
    float cell(int x, int z) const;

    float half_ = 1;
    std::vector<float> heights_;
};

/// Where things stand.
struct World {
    glm::mat4 terrain{1}, temple{1}, fox{1};
    std::vector<glm::mat4> creatures;
    glm::vec3 eye{0}, target{0};
    glm::vec3 center{0}; ///< of what casts shadows
    float radius = 1;
};

struct WorldAssets {
    const AssetView& creature;
    const AssetView& temple;
    const AssetView& terrain;
    const AssetView& fox;
};
World makeWorld(const WorldAssets& assets, uint32_t creatureCount);

} // namespace xgc::scene_sample
