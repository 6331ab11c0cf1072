#pragma once

#include <xgc/asset.h>
#include <xgc/bake/status.h>

#include <glm/gtc/quaternion.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace xgc::scene_sample {

/// An animation of a .glb: what a host brings beside the asset, whose nodes it moves by name.
class Clip {
public:
    /// Reads the animation of that name, or the first. Linear and step keys of translations, rotations and scales.
    static bake::Status read(const std::filesystem::path& glb, const std::string& name, Clip& out);

    float seconds() const { return seconds_; }
    /// Transforms of all nodes of the asset to their parents; nodes that it does not move stay as the asset has them.
    void sample(const AssetView& asset, float second, std::span<glm::mat4> toParent) const;

private:
    enum class Path { translation, rotation, scale };
    struct Channel {
        Path path;
        bool step;
        std::vector<float> times;
        std::vector<glm::vec4> values;
        glm::vec4 at(float second) const;
    };
    struct Node {
        std::string name;
        glm::vec3 translation{0};
        glm::vec4 rotation{0, 0, 0, 1}; ///< x, y, z, w
        glm::vec3 scale{1};
        std::vector<Channel> channels;
    };
    friend class ClipReader;

    std::vector<Node> nodes_;
    float seconds_ = 0;
};

} // namespace xgc::scene_sample
