#include <import/gltf_document.h>
#include <import/gltf_primitive.h>

#include <fmt/format.h>

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
        for (uint32_t i = 0; i < nodes.size(); ++i) {
            if (!nodes[i].inScene) continue;
            if (Status s = readNode(nodes[i], i); !s.ok()) return s;
        }
        out = builder_.finish();
        return {};
    }

private:
    Status refuse(const std::string& what) const {
        return badInput(fmt::format("{}: {}; export it again", file_, what));
    }

    Status readNode(const GltfNode& node, uint32_t number) {
        const tinygltf::Node& source = document_.nodes[size_t(node.source)];
        if (source.mesh == -1) return {};
        if (source.mesh < 0 || size_t(source.mesh) >= document_.meshes.size())
            return refuse(
                fmt::format("node {} names mesh {} of {}", node.source, source.mesh, document_.meshes.size()));
        std::vector<Skin>& skins = builder_.model().skins;
        if (source.skin != -1 && (source.skin < 0 || size_t(source.skin) >= skins.size()))
            return refuse(fmt::format("node {} names skin {} of {}", node.source, source.skin, skins.size()));
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
        }
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
};

} // namespace

Status readGltf(const Source& source, const ImportLimits& limits, Model& out) {
    tinygltf::Model document;
    if (Status s = parseGltf(source, document); !s.ok()) return s;
    return GltfScene(document, source.name, limits).read(out);
}

} // namespace xgc::bake
