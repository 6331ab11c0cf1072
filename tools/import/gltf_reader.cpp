#include <import/gltf_document.h>
#include <import/gltf_primitive.h>

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {

namespace {

double numberOf(const tinygltf::ExtensionMap& extensions, const char* extension, const char* key, double missing) {
    const auto it = extensions.find(extension);
    if (it == extensions.end() || !it->second.IsObject() || !it->second.Has(key)) return missing;
    const tinygltf::Value& value = it->second.Get(key);
    return value.IsNumber() ? value.GetNumberAsDouble() : missing;
}

Material toMaterial(const tinygltf::Material& source) {
    Material out;
    out.name = source.name;
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    if (pbr.baseColorFactor.size() == 4) {
        for (int k = 0; k < 4; ++k) out.baseColor[k] = float(pbr.baseColorFactor[size_t(k)]);
    }
    out.metallic = float(pbr.metallicFactor);
    out.roughness = float(pbr.roughnessFactor);
    const double strength = numberOf(source.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    if (source.emissiveFactor.size() == 3) {
        for (int k = 0; k < 3; ++k) out.emissive[k] = float(source.emissiveFactor[size_t(k)] * strength);
    }
    out.doubleSided = source.doubleSided;
    out.alphaMask = source.alphaMode == "MASK";
    out.alphaBlend = source.alphaMode == "BLEND";
    if (out.alphaMask) out.alphaCutoff = float(source.alphaCutoff);
    return out;
}

/// Names of morph targets by the common convention: mesh.extras.targetNames.
std::vector<std::string> morphNames(const tinygltf::Mesh& mesh) {
    std::vector<std::string> names;
    if (!mesh.extras.IsObject() || !mesh.extras.Has("targetNames")) return names;
    const tinygltf::Value& list = mesh.extras.Get("targetNames");
    for (int i = 0; list.IsArray() && i < int(list.ArrayLen()); ++i) {
        const tinygltf::Value& name = list.Get(i);
        names.push_back(name.IsString() ? name.Get<std::string>() : std::string());
    }
    return names;
}

class GltfScene {
public:
    GltfScene(const tinygltf::Model& document, const std::string& file, const ImportLimits& limits)
        : document_(document), file_(file), accessors_(document, file), builder_(file, limits) {}

    Status read(Model& out) {
        Model& model = builder_.model();
        for (const tinygltf::Material& m : document_.materials) model.materials.push_back(toMaterial(m));
        std::vector<GltfNode> nodes;
        if (Status s = flattenNodes(document_, file_, nodes, model.nodes); !s.ok()) return s;
        if (Status s = readSkins(document_, file_, accessors_, nodes, model.skins); !s.ok()) return s;
        if (Status s = numberJoints(nodes); !s.ok()) return s;
        for (uint32_t i = 0; i < nodes.size(); ++i) {
            if (!nodes[i].inScene) continue;
            if (Status s = readNode(nodes[i], i); !s.ok()) return s;
        }
        repairWeights();
        out = builder_.finish();
        return {};
    }

private:
    Status refuse(const std::string& what) const {
        return badInput(fmt::format("{}: {}; export it again", file_, what));
    }

    /// Rows name joints of all skins together. Where some meshes have a skin, the others follow a joint that stands for
    /// their node: one pose moves all of the model.
    Status numberJoints(const std::vector<GltfNode>& nodes) {
        std::vector<Skin>& skins = builder_.model().skins;
        uint32_t count = 0;
        for (const Skin& skin : skins) {
            firstJoint_.push_back(count);
            count += uint32_t(skin.joints.size());
        }
        rigidJoint_.assign(nodes.size(), kNone);
        const auto isDrawn = [&](const GltfNode& n) {
            return n.inScene && document_.nodes[size_t(n.source)].mesh >= 0;
        };
        const auto isSkinned = [&](const GltfNode& n) { return document_.nodes[size_t(n.source)].skin >= 0; };
        const bool skinned =
            std::any_of(nodes.begin(), nodes.end(), [&](const GltfNode& n) { return isDrawn(n) && isSkinned(n); });
        if (!skinned) {
            skins.clear(); // no row names them
            firstJoint_.clear();
            return {};
        }
        Skin rigid;
        rigid.name = "nodes";
        for (uint32_t i = 0; i < nodes.size(); ++i) {
            if (!isDrawn(nodes[i]) || isSkinned(nodes[i])) continue;
            rigidJoint_[i] = count++;
            rigid.joints.push_back(i);
            const bool flat = glm::determinant(nodes[i].toMesh) == 0; // drawn as nothing
            rigid.inverseBind.push_back(flat ? glm::mat4(1) : glm::mat4(glm::inverse(nodes[i].toMesh)));
        }
        if (!rigid.joints.empty()) skins.push_back(std::move(rigid));
        return count <= 65536 ? Status{} : refuse(fmt::format("its skins have {} joints, more than 65,536", count));
    }

    /// Weights of at least 0, some of them above: what poses rely on.
    void repairWeights() {
        Attributes& a = builder_.model().attributes;
        if (builder_.model().skins.empty() || a.weights[0].empty()) return;
        for (size_t row = 0; row < a.weights[0].size(); ++row) {
            float sum = 0;
            for (auto& weights : a.weights) {
                if (weights.empty()) continue;
                weights[row] = glm::max(weights[row], glm::vec4(0));
                sum += weights[row].x + weights[row].y + weights[row].z + weights[row].w;
            }
            if (!(sum > 0)) a.weights[0][row] = glm::vec4(1, 0, 0, 0);
        }
    }

    Status readNode(const GltfNode& node, uint32_t number) {
        const tinygltf::Node& source = document_.nodes[size_t(node.source)];
        if (source.mesh == -1) return {};
        if (source.mesh < 0 || size_t(source.mesh) >= document_.meshes.size())
            return refuse(
                fmt::format("node {} names mesh {} of {}", node.source, source.mesh, document_.meshes.size()));
        std::vector<Skin>& skins = builder_.model().skins;
        const size_t skinCount = document_.skins.size();
        if (source.skin != -1 && (source.skin < 0 || size_t(source.skin) >= skinCount))
            return refuse(fmt::format("node {} names skin {} of {}", node.source, source.skin, skinCount));
        const bool skinned = source.skin >= 0;
        const tinygltf::Mesh& mesh = document_.meshes[size_t(source.mesh)];
        // A skin's joints place its mesh, not the node: the geometry stays in the space of the inverse bind matrices.
        GltfTarget target{Placement(skinned ? glm::dmat4(1) : node.toMesh),
                          number,
                          kNone,
                          uint32_t(document_.materials.size()),
                          {},
                          morphNames(mesh)};
        if (skinned) {
            builder_.model().nodes[number].skin = uint32_t(source.skin);
            target.jointCount = uint32_t(skins[size_t(source.skin)].joints.size());
            target.firstJoint = firstJoint_[size_t(source.skin)];
        }
        target.rigidJoint = rigidJoint_[number];
        for (size_t i = 0; i < mesh.primitives.size(); ++i) {
            target.name = fmt::format("mesh {} primitive {}", source.mesh, i);
            if (Status s = readGltfPrimitive(accessors_, mesh.primitives[i], target, builder_); !s.ok()) return s;
        }
        return {};
    }

    const tinygltf::Model& document_;
    const std::string& file_;
    GltfAccessors accessors_;
    ModelBuilder builder_;
    std::vector<uint32_t> firstJoint_; ///< a skin each
    std::vector<uint32_t> rigidJoint_; ///< a node each; kNone: it has a skin, or nothing to draw
};

} // namespace

Status readGltf(const Source& source, const ImportLimits& limits, Model& out) {
    tinygltf::Model document;
    if (Status s = parseGltf(source, document); !s.ok()) return s;
    return GltfScene(document, source.name, limits).read(out);
}

} // namespace xgc::bake
