#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/select.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace xgc::scene_sample {

/// An .xgc file in memory, opened in place.
struct LoadedAsset {
    bake::AlignedBytes bytes;
    AssetView view;

    bake::Status load(const std::filesystem::path& file);
};

/// Heights of a surface in world space, on a grid.
class Ground {
public:
    /// Of the patches of a material, by name, or of all.
    Ground(const AssetView& asset, const glm::mat4& toWorld, std::string_view material = {});

    float height(float x, float z) const;
    /// Least and largest height in a circle.
    glm::vec2 range(float x, float z, float radius) const;
    /// Of the places within `within` of the middle, the middle of the flattest circle.
    glm::vec2 flattest(float radius, float within) const;

private:
    static constexpr int kCells = 128;
    float cell(int x, int z) const;

    float half_ = 1;
    std::vector<float> heights_;
};

/// Where things stand.
struct World {
    glm::mat4 terrain{1}, temple{1}, fox{1};
    std::vector<glm::mat4> creatures;
    glm::vec3 eye{0}, target{0};
    glm::vec3 towardsSun{0, 1, 0};
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
