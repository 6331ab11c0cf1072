#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace xgc::bake {

inline constexpr uint32_t kNone = 0xffffffffu;

/// One blend shape: displacements, a row each; empty where the shape does not move that attribute.
struct MorphTarget {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec3> tangents;
};

/// Vertex attributes as columns: each is empty or has one entry a row. Joints and weights come in pairs.
struct Attributes {
    static constexpr size_t kUvSets = 4;
    static constexpr size_t kColorSets = 2;
    static constexpr size_t kJointSets = 2;

    std::vector<glm::vec3> normals;  ///< unit, or zero where the input has none
    std::vector<glm::vec4> tangents; ///< w: handedness, +1 or -1
    std::array<std::vector<glm::vec2>, kUvSets> uvs;
    std::array<std::vector<glm::vec4>, kColorSets> colors; ///< linear
    std::array<std::vector<glm::u16vec4>, kJointSets> joints;
    std::array<std::vector<glm::vec4>, kJointSets> weights;
    std::vector<MorphTarget> morphTargets;
};

struct Material {
    std::string name;
    glm::vec4 baseColor{1}; ///< linear
    float metallic = 0;
    float roughness = 1;
    glm::vec3 emissive{0}; ///< linear
    bool doubleSided = false;
    bool alphaMask = false;
    float alphaCutoff = 0.5f; ///< of alphaMask: alpha below it is not there
    bool alphaBlend = false;
};

/// A node of the source scene. Geometry is flattened into mesh space already.
struct SceneNode {
    std::string name;
    uint32_t parent = kNone; ///< before its children
    glm::mat4 toMesh{1};
    uint32_t skin = kNone; ///< of the geometry that the node holds
};

/// Rows of Attributes::joints name joints of all skins, one behind the other.
struct Skin {
    std::string name;
    std::vector<uint32_t> joints; ///< nodes
    std::vector<glm::mat4> inverseBind;
};

/// What a model file holds, flattened into one space, before welding: rows of positions and
/// attributes, triangles over rows. Face order is the file's: labels per face refer to it.
struct Model {
    std::string file; ///< as given, for messages
    std::vector<glm::vec3> positions;
    Attributes attributes;
    std::vector<glm::uvec3> triangles;
    std::vector<uint32_t> triangleFace;     ///< input face (a polygon gives several triangles)
    std::vector<uint32_t> triangleMaterial; ///< never kNone
    std::vector<uint32_t> triangleNode;     ///< node it came from, or kNone
    uint32_t inputFaceCount = 0;
    std::vector<Material> materials; ///< at least one
    std::vector<SceneNode> nodes;
    std::vector<Skin> skins;
};

} // namespace xgc::bake
