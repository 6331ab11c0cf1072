#include <import/gltf_nodes.h>

#include <fmt/format.h>

namespace xgc::bake {

namespace {

glm::dmat4 rotation(const std::vector<double>& q) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0),
            glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0),
            glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0), glm::dvec4(0, 0, 0, 1)};
}

glm::dmat4 localTransform(const tinygltf::Node& node) {
    glm::dmat4 m(1);
    if (node.matrix.size() == 16) {
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[size_t(i)];
        return m;
    }
    if (node.rotation.size() == 4) m = rotation(node.rotation);
    if (node.scale.size() == 3) {
        for (int k = 0; k < 3; ++k) m[k] *= node.scale[size_t(k)];
    }
    if (node.translation.size() == 3) {
        for (int k = 0; k < 3; ++k) m[3][k] = node.translation[size_t(k)];
    }
    return m;
}

class Flattener {
public:
    Flattener(const tinygltf::Model& document, const std::string& file, std::vector<GltfNode>& nodes,
              std::vector<SceneNode>& out)
        : document_(document), file_(file), nodes_(nodes), out_(out), visited_(document.nodes.size(), false) {}

    Status run() {
        std::vector<int> roots;
        if (Status s = findRoots(roots); !s.ok()) return s;
        if (Status s = visit(roots, true); !s.ok()) return s;
        if (!skinsReachOutside()) return {};
        for (const int root : parentless()) {
            if (visited_[size_t(root)]) continue;
            if (Status s = visit({root}, false); !s.ok()) return s;
        }
        return {};
    }

private:
    Status refuse(const std::string& what) const {
        return badInput(fmt::format("{}: {}; export it again", file_, what));
    }

    std::vector<int> parentless() const {
        std::vector<bool> hasParent(document_.nodes.size(), false);
        for (const tinygltf::Node& node : document_.nodes) {
            for (const int child : node.children) {
                if (child >= 0 && size_t(child) < hasParent.size()) hasParent[size_t(child)] = true;
            }
        }
        std::vector<int> roots;
        for (size_t i = 0; i < hasParent.size(); ++i) {
            if (!hasParent[i]) roots.push_back(int(i));
        }
        return roots;
    }

    Status findRoots(std::vector<int>& roots) const {
        if (document_.scenes.empty()) {
            roots = parentless();
            return {};
        }
        const int scene = std::max(document_.defaultScene, 0);
        if (size_t(scene) >= document_.scenes.size())
            return refuse(fmt::format("default scene {} of {}", scene, document_.scenes.size()));
        roots = document_.scenes[size_t(scene)].nodes;
        return {};
    }

    bool skinsReachOutside() const {
        for (const tinygltf::Skin& skin : document_.skins) {
            for (const int joint : skin.joints) {
                if (joint >= 0 && size_t(joint) < visited_.size() && !visited_[size_t(joint)]) return true;
            }
        }
        return false;
    }

    Status visit(const std::vector<int>& roots, bool inScene) {
        struct Visit {
            int node;
            uint32_t parent;
        };
        std::vector<Visit> stack;
        for (auto it = roots.rbegin(); it != roots.rend(); ++it) stack.push_back({*it, kNone});
        while (!stack.empty()) {
            const auto [node, parent] = stack.back();
            stack.pop_back();
            if (node < 0 || size_t(node) >= document_.nodes.size())
                return refuse(fmt::format("node {} of {}", node, document_.nodes.size()));
            if (visited_[size_t(node)])
                return refuse(fmt::format("node {} has two parents or is its own ancestor", node));
            visited_[size_t(node)] = true;
            const tinygltf::Node& source = document_.nodes[size_t(node)];
            const glm::dmat4 above = parent == kNone ? glm::dmat4(1) : nodes_[parent].toMesh;
            const auto number = uint32_t(nodes_.size());
            nodes_.push_back({node, above * localTransform(source), inScene});
            out_.push_back({source.name, parent, glm::mat4(nodes_.back().toMesh), kNone});
            for (auto it = source.children.rbegin(); it != source.children.rend(); ++it) stack.push_back({*it, number});
        }
        return {};
    }

    const tinygltf::Model& document_;
    const std::string& file_;
    std::vector<GltfNode>& nodes_;
    std::vector<SceneNode>& out_;
    std::vector<bool> visited_;
};

} // namespace

Status flattenNodes(const tinygltf::Model& document, const std::string& file, std::vector<GltfNode>& nodes,
                    std::vector<SceneNode>& out) {
    return Flattener(document, file, nodes, out).run();
}

Status readSkins(const tinygltf::Model& document, const std::string& file, const GltfAccessors& accessors,
                 const std::vector<GltfNode>& nodes, std::vector<Skin>& out) {
    std::vector<uint32_t> flattened(document.nodes.size(), kNone);
    for (uint32_t i = 0; i < nodes.size(); ++i) flattened[size_t(nodes[i].source)] = i;
    for (size_t i = 0; i < document.skins.size(); ++i) {
        const tinygltf::Skin& source = document.skins[i];
        Skin skin;
        skin.name = source.name;
        for (const int joint : source.joints) {
            if (joint < 0 || size_t(joint) >= flattened.size() || flattened[size_t(joint)] == kNone)
                return badInput(fmt::format("{}: skin {} names the joint {}, which no scene reaches; export it again",
                                            file, i, joint));
            skin.joints.push_back(flattened[size_t(joint)]);
        }
        skin.inverseBind.assign(skin.joints.size(), glm::mat4(1));
        if (source.inverseBindMatrices >= 0) {
            std::vector<float> values;
            const std::string use = fmt::format("inverse bind matrices of skin {}", i);
            if (Status s = accessors.readFloats(source.inverseBindMatrices, 16, use, values); !s.ok()) return s;
            if (values.size() < skin.joints.size() * 16)
                return badInput(
                    fmt::format("{}: {}: fewer than its {} joints; export it again", file, use, skin.joints.size()));
            for (size_t j = 0; j < skin.joints.size() * 16; ++j) {
                skin.inverseBind[j / 16][int(j % 16 / 4)][int(j % 4)] = values[j];
            }
        }
        out.push_back(std::move(skin));
    }
    return {};
}

} // namespace xgc::bake
