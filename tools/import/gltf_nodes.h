#pragma once

#include <import/gltf_accessor.h>
#include <xgc/bake/model.h>

namespace xgc::bake {

/// A node of the flattened scene.
struct GltfNode {
    int source = -1; ///< in the document
    glm::dmat4 toMesh{1};
    bool inScene = true; ///< false: only a joint needs it
};

/// Nodes in depth-first order, parents before children: those of the default scene (the first, or all roots where there
/// is none), then, where skins name nodes outside it, the rest. `nodes` and `out` go side by side. Refuses
/// cycles and nodes with two parents.
Status flattenNodes(const tinygltf::Model& document, const std::string& file, std::vector<GltfNode>& nodes,
                    std::vector<SceneNode>& out);

/// All skins, in the document's order, with joints as numbers of flattened nodes.
Status readSkins(const tinygltf::Model& document, const std::string& file, const GltfAccessors& accessors,
                 const std::vector<GltfNode>& nodes, std::vector<Skin>& out);

} // namespace xgc::bake
