#include <import/assimp_files.h>
#include <import/completeness.h>
#include <import/model_builder.h>
#include <import/obj_text.h>
#include <import/placement.h>
#include <import/polygon.h>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace xgc::bake {

namespace {

glm::vec3 toVec3(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}
glm::vec4 toVec4(const aiColor4D& c) {
    return {c.r, c.g, c.b, c.a};
}
glm::dmat4 toMat4(const aiMatrix4x4& m) {
    glm::dmat4 out;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) out[column][row] = double(m[unsigned(row)][unsigned(column)]);
    }
    return out;
}

Material toMaterial(const aiMaterial& material) {
    Material out;
    aiString name;
    if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) out.name = name.C_Str();
    aiColor4D color;
    if (material.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
        material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS)
        out.baseColor = toVec4(color);
    float opacity = 1;
    if (material.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS) out.baseColor.a = opacity;
    out.alphaBlend = out.baseColor.a < 1;
    material.Get(AI_MATKEY_METALLIC_FACTOR, out.metallic);
    material.Get(AI_MATKEY_ROUGHNESS_FACTOR, out.roughness);
    if (material.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS) out.emissive = glm::vec3(toVec4(color));
    int twoSided = 0;
    material.Get(AI_MATKEY_TWOSIDED, twoSided);
    out.doubleSided = twoSided != 0;
    return out;
}

class AssimpScene {
public:
    AssimpScene(const Source& source, const ImportLimits& limits, const aiScene& scene, const ObjText* obj)
        : source_(source), scene_(scene), obj_(obj), builder_(source.name, limits) {}

    Status read(Model& out) {
        obj_ ? nameObjParts() : nameMaterials();
        if (Status s = walk(); !s.ok()) return s;
        if (obj_ && builder_.model().inputFaceCount != obj_->faceGroup.size())
            return badInput(fmt::format("{}: {} of its {} `f` lines could be read; repair or export it again",
                                        source_.name, builder_.model().inputFaceCount, obj_->faceGroup.size()));
        out = builder_.finish();
        return {};
    }

private:
    void nameMaterials() {
        for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
            builder_.model().materials.push_back(toMaterial(*scene_.mMaterials[i]));
        }
    }

    /// Materials and groups by the OBJ's own statements; what the .mtl says of a material is Assimp's.
    void nameObjParts() {
        for (const std::string& name : obj_->materials) {
            Material material;
            material.name = name;
            for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
                const Material known = toMaterial(*scene_.mMaterials[i]);
                if (known.name == name) material = known;
            }
            builder_.model().materials.push_back(material);
        }
        for (const std::string& name : obj_->groups) builder_.model().nodes.emplace_back().name = name;
    }

    /// Depth first without recursion: a node tree can be as deep as the file is long.
    Status walk() {
        struct Visit {
            const aiNode* node;
            uint32_t parent;
            glm::dmat4 toMesh;
        };
        std::vector<Visit> stack{{scene_.mRootNode, kNone, glm::dmat4(1)}};
        while (!stack.empty()) {
            const Visit visit = stack.back();
            stack.pop_back();
            const glm::dmat4 toMesh = visit.toMesh * toMat4(visit.node->mTransformation);
            uint32_t node = kNone;
            if (!obj_) {
                node = uint32_t(builder_.model().nodes.size());
                builder_.model().nodes.push_back({visit.node->mName.C_Str(), visit.parent, glm::mat4(toMesh), kNone});
            }
            for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
                const unsigned mesh = visit.node->mMeshes[i];
                if (mesh >= scene_.mNumMeshes) return damaged("a node names a mesh past the last one");
                if (Status s = readMesh(*scene_.mMeshes[mesh], Placement(toMesh), node); !s.ok()) return s;
            }
            for (unsigned i = visit.node->mNumChildren; i-- > 0;) {
                stack.push_back({visit.node->mChildren[i], node, toMesh});
            }
        }
        return {};
    }

    Status damaged(const char* what) const {
        return badInput(fmt::format("{}: {}; export it again", source_.name, what));
    }

    Status readMesh(const aiMesh& mesh, const Placement& placement, uint32_t node) {
        uint32_t first = 0;
        if (Status s = builder_.beginRows(mesh.mNumVertices, first); !s.ok()) return s;
        readRows(mesh, placement);
        builder_.endRows();
        return readFaces(mesh, placement, node, first);
    }

    void readRows(const aiMesh& mesh, const Placement& placement) {
        const unsigned count = mesh.mNumVertices;
        const auto positions = builder_.positions();
        for (unsigned i = 0; i < count; ++i) positions[i] = placement.point(toVec3(mesh.mVertices[i]));
        if (mesh.HasNormals() && source_.extension != ".stl") { // STL's say no more than its facets
            const auto normals = builder_.normals();
            for (unsigned i = 0; i < count; ++i) normals[i] = placement.normal(toVec3(mesh.mNormals[i]));
        }
        if (mesh.HasTangentsAndBitangents() && mesh.HasNormals()) {
            const auto tangents = builder_.tangents();
            for (unsigned i = 0; i < count; ++i) {
                const glm::vec3 bitangent = glm::cross(toVec3(mesh.mNormals[i]), toVec3(mesh.mTangents[i]));
                const float side = glm::dot(bitangent, toVec3(mesh.mBitangents[i])) < 0 ? -1.0f : 1.0f;
                tangents[i] = placement.tangent({toVec3(mesh.mTangents[i]), side});
            }
        }
        for (unsigned set = 0; set < Attributes::kUvSets; ++set) {
            if (!mesh.HasTextureCoords(set)) continue;
            const auto uvs = builder_.uvs(set);
            for (unsigned i = 0; i < count; ++i) uvs[i] = glm::vec2(toVec3(mesh.mTextureCoords[set][i]));
        }
        for (unsigned set = 0; set < Attributes::kColorSets; ++set) {
            if (!mesh.HasVertexColors(set)) continue;
            const auto colors = builder_.colors(set);
            for (unsigned i = 0; i < count; ++i) colors[i] = toVec4(mesh.mColors[set][i]);
        }
    }

    /// A face of an OBJ with fewer than three corners or a point of a point cloud still counts where it is a record
    /// of the file's face list.
    bool isFaceRecord(const aiFace& face) const {
        return face.mNumIndices >= 3 || obj_ || source_.extension == ".off" || source_.extension == ".ply";
    }

    Status readFaces(const aiMesh& mesh, const Placement& placement, uint32_t node, uint32_t first) {
        std::vector<glm::vec3> corners;
        std::vector<glm::uvec3> split;
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (!isFaceRecord(face)) continue;
            if (Status s = builder_.checkFaces(std::max(face.mNumIndices, 3u) - 2); !s.ok()) return s;
            const uint32_t input = builder_.model().inputFaceCount++;
            corners.clear();
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                if (face.mIndices[k] >= mesh.mNumVertices)
                    return badInput(fmt::format("{}: face {} names vertex {} of {}; export it again", source_.name,
                                                input, face.mIndices[k], mesh.mNumVertices));
                corners.push_back(toVec3(mesh.mVertices[face.mIndices[k]]));
            }
            if (corners.size() < 3) continue;
            split.clear();
            triangulatePolygon(corners, split);
            for (const glm::uvec3& t : split) {
                const glm::uvec3 rows(first + face.mIndices[t.x], first + face.mIndices[t.y],
                                      first + face.mIndices[t.z]);
                addTriangle(placement.wind(rows), input, mesh.mMaterialIndex, node);
            }
        }
        return {};
    }

    void addTriangle(const glm::uvec3& rows, uint32_t input, uint32_t material, uint32_t node) {
        if (!obj_) return builder_.addTriangle(rows, input, material, node);
        if (input < obj_->faceGroup.size())
            builder_.addTriangle(rows, input, obj_->faceMaterial[input], obj_->faceGroup[input]);
    }

    const Source& source_;
    const aiScene& scene_;
    const ObjText* obj_;
    ModelBuilder builder_;
};

} // namespace

Status readWithAssimp(const Source& source, const ImportLimits& limits, Model& out) {
    Assimp::Importer importer;
    if (source.extension == ".xgc")
        return usageError(fmt::format("{}: a baked asset; `xgc extract` makes a model of it", source.name));
    if (source.extension.empty() || !importer.IsExtensionSupported(source.extension))
        return badInput(fmt::format("{}: no reader for the extension \"{}\"; give glTF, GLB, OBJ, PLY, OFF, STL or "
                                    "another format that Assimp reads",
                                    source.name, source.extension));
    if (Status s = checkComplete(source); !s.ok()) return s;

    ObjText obj;
    Source given = source;
    const bool isObj = source.extension == ".obj";
    if (isObj) {
        obj = splitObj(source.bytes);
        given.bytes = std::as_bytes(std::span(obj.text));
    }
    // The extension in lower case, for readers are chosen by it.
    const std::string name = (source.folder / ("model" + source.extension)).string();
    importer.SetIOHandler(new AssimpFiles(given, name)); // owned by the importer
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const aiScene* scene = importer.ReadFile(name, 0);
    if (!scene || !scene->mRootNode)
        return badInput(
            fmt::format("{}: {}; check the file or export it again", source.name, importer.GetErrorString()));
    return AssimpScene(source, limits, *scene, isObj ? &obj : nullptr).read(out);
}

} // namespace xgc::bake
