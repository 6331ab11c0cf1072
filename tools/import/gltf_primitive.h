#pragma once

#include <import/gltf_nodes.h>
#include <import/model_builder.h>
#include <import/placement.h>

namespace xgc::bake {

/// Where and how the primitives of one node's mesh are added.
struct GltfTarget {
    Placement placement;
    uint32_t node = kNone;
    uint32_t jointCount = kNone; ///< of the node's skin, or kNone
    uint32_t materialCount = 0;
    std::string name; ///< of the primitive, for messages
    std::vector<std::string> morphNames;
    uint32_t firstJoint = 0;     ///< number of the skin's joint 0 among those of all skins
    uint32_t rigidJoint = kNone; ///< of a node without a skin, in a model that has some
};

/// Adds a primitive's rows and triangles.
Status readGltfPrimitive(const GltfAccessors& accessors, const tinygltf::Primitive& primitive, const GltfTarget& target,
                         ModelBuilder& builder);

} // namespace xgc::bake
