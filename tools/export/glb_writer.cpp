#include "export/writers.h"

#include <nlohmann/json.hpp>

#include <bit>
#include <cstring>

static_assert(std::endian::native == std::endian::little, "files are little-endian");

namespace xgc::bake::exports {
namespace {

using Json = nlohmann::ordered_json;

// Constants of the glTF 2.0 specification, 3.6.2.2 and 5.11.
constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
constexpr int kArrayBuffer = 34962;
constexpr int kElementArrayBuffer = 34963;
constexpr uint32_t kJsonChunk = 0x4e4f534a;
constexpr uint32_t kBinaryChunk = 0x004e4942;

template <typename Vector>
Json toJson(const Vector& v) {
    Json list = Json::array();
    for (int i = 0; i < Vector::length(); ++i) list.push_back(double(v[i]));
    return list;
}

Json toJson(const glm::mat4& m) {
    Json list = Json::array();
    for (int i = 0; i < 16; ++i) list.push_back(double(m[i / 4][i % 4]));
    return list;
}

/// Typed arrays in one buffer.
class BufferWriter {
public:
    template <typename T>
    uint32_t add(const std::vector<T>& values, int componentType, const char* type, int target) {
        const size_t offset = bytes.size();
        append(bytes, values.data(), values.size() * sizeof(T));
        const size_t size = bytes.size() - offset;
        bytes.resize((bytes.size() + 3) / 4 * 4);
        Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
        if (target) view["target"] = target;
        views.push_back(view);
        accessors.push_back({{"bufferView", views.size() - 1},
                             {"componentType", componentType},
                             {"count", values.size()},
                             {"type", type}});
        return uint32_t(accessors.size() - 1);
    }

    /// Positions need their bounds.
    uint32_t addPositions(const std::vector<glm::vec3>& values) {
        const uint32_t accessor = add(values, kFloat, "VEC3", kArrayBuffer);
        glm::vec3 low = values.front(), high = low;
        for (const glm::vec3& v : values) {
            low = glm::min(low, v);
            high = glm::max(high, v);
        }
        accessors[accessor]["min"] = toJson(low);
        accessors[accessor]["max"] = toJson(high);
        return accessor;
    }

    Bytes bytes;
    Json views = Json::array();
    Json accessors = Json::array();
};

/// Entries of a column at rows.
template <typename T>
std::vector<T> gather(const std::vector<T>& column, const std::vector<uint32_t>& rows) {
    std::vector<T> out;
    out.reserve(rows.size());
    for (const uint32_t row : rows) out.push_back(column[row]);
    return out;
}

template <typename T, size_t N>
void addSets(BufferWriter& buffer, const std::array<std::vector<T>, N>& sets, const std::vector<uint32_t>& rows,
             const std::string& name, int componentType, const char* type, Json& attributes) {
    for (size_t set = 0; set < N; ++set) {
        if (sets[set].empty()) continue;
        attributes[name + std::to_string(set)] = buffer.add(gather(sets[set], rows), componentType, type, kArrayBuffer);
    }
}

Json attributesOf(BufferWriter& buffer, const Model& model, const std::vector<uint32_t>& rows) {
    const Attributes& a = model.attributes;
    Json out;
    out["POSITION"] = buffer.addPositions(gather(model.positions, rows));
    if (!a.normals.empty()) out["NORMAL"] = buffer.add(gather(a.normals, rows), kFloat, "VEC3", kArrayBuffer);
    if (!a.tangents.empty()) out["TANGENT"] = buffer.add(gather(a.tangents, rows), kFloat, "VEC4", kArrayBuffer);
    addSets(buffer, a.uvs, rows, "TEXCOORD_", kFloat, "VEC2", out);
    addSets(buffer, a.colors, rows, "COLOR_", kFloat, "VEC4", out);
    addSets(buffer, a.joints, rows, "JOINTS_", kUnsignedShort, "VEC4", out);
    addSets(buffer, a.weights, rows, "WEIGHTS_", kFloat, "VEC4", out);
    return out;
}

Json targetsOf(BufferWriter& buffer, const Model& model, const std::vector<uint32_t>& rows) {
    Json targets = Json::array();
    for (const MorphTarget& shape : model.attributes.morphTargets) {
        Json target;
        // A target must have an attribute: one that moves nothing gets zeros.
        const bool still = shape.positions.empty() && shape.normals.empty() && shape.tangents.empty();
        if (still) target["POSITION"] = buffer.addPositions(std::vector<glm::vec3>(rows.size(), glm::vec3(0)));
        if (!shape.positions.empty()) target["POSITION"] = buffer.addPositions(gather(shape.positions, rows));
        if (!shape.normals.empty()) {
            target["NORMAL"] = buffer.add(gather(shape.normals, rows), kFloat, "VEC3", kArrayBuffer);
        }
        if (!shape.tangents.empty()) {
            target["TANGENT"] = buffer.add(gather(shape.tangents, rows), kFloat, "VEC3", kArrayBuffer);
        }
        targets.push_back(target);
    }
    return targets;
}

Json primitiveOf(BufferWriter& buffer, const Model& model, const Group& group) {
    const UsedRows used = usedRows(model, group.triangles);
    Json primitive;
    primitive["attributes"] = attributesOf(buffer, model, used.rows);
    if (used.rows.size() < 65535) {
        const std::vector<uint16_t> narrow(used.indices.begin(), used.indices.end());
        primitive["indices"] = buffer.add(narrow, kUnsignedShort, "SCALAR", kElementArrayBuffer);
    } else {
        primitive["indices"] = buffer.add(used.indices, kUnsignedInt, "SCALAR", kElementArrayBuffer);
    }
    primitive["material"] = group.material;
    const Json targets = targetsOf(buffer, model, used.rows);
    if (!targets.empty()) primitive["targets"] = targets;
    return primitive;
}

Json materialOf(const Material& material) {
    Json out;
    if (!material.name.empty()) out["name"] = material.name;
    out["pbrMetallicRoughness"] = {{"baseColorFactor", toJson(material.baseColor)},
                                   {"metallicFactor", double(material.metallic)},
                                   {"roughnessFactor", double(material.roughness)}};
    if (material.emissive != glm::vec3(0)) out["emissiveFactor"] = toJson(material.emissive);
    if (material.doubleSided) out["doubleSided"] = true;
    if (material.alphaMask) out["alphaMode"] = "MASK";
    if (material.alphaMask && material.alphaCutoff != 0.5f) out["alphaCutoff"] = material.alphaCutoff;
    if (material.alphaBlend) out["alphaMode"] = "BLEND";
    return out;
}

/// World transforms to write. Geometry is in mesh space already, so that positions stay exact a node that
/// carries triangles, and all above it, stand at the origin.
std::vector<glm::mat4> writtenTransforms(const Model& model, const std::vector<Group>& groups) {
    std::vector<glm::mat4> out;
    for (const SceneNode& node : model.nodes) out.push_back(node.toMesh);
    for (const Group& group : groups) {
        for (uint32_t n = group.node; n != kNone; n = model.nodes[n].parent) out[n] = glm::mat4(1);
    }
    return out;
}

/// Nodes by name with their tree; the index of each stays. Returns the roots.
Json addNodes(const Model& model, const std::vector<Group>& groups, Json& nodes) {
    const std::vector<glm::mat4> toMesh = writtenTransforms(model, groups);
    Json roots = Json::array();
    for (uint32_t n = 0; n < model.nodes.size(); ++n) {
        const SceneNode& node = model.nodes[n];
        Json out = Json::object();
        if (!node.name.empty()) out["name"] = node.name;
        const glm::mat4 local = node.parent == kNone ? toMesh[n] : glm::inverse(toMesh[node.parent]) * toMesh[n];
        if (local != glm::mat4(1)) out["matrix"] = toJson(local);
        nodes.push_back(out);
        if (node.parent == kNone) {
            roots.push_back(n);
        } else {
            nodes[node.parent]["children"].push_back(n);
        }
    }
    return roots;
}

Json skinOf(BufferWriter& buffer, const Skin& skin) {
    Json out;
    if (!skin.name.empty()) out["name"] = skin.name;
    out["joints"] = skin.joints;
    if (!skin.inverseBind.empty()) out["inverseBindMatrices"] = buffer.add(skin.inverseBind, kFloat, "MAT4", 0);
    return out;
}

/// One mesh a node, one primitive a material; triangles without a node get one of their own.
void addMeshes(const Model& model, const std::vector<Group>& groups, BufferWriter& buffer, Json& root, Json& roots) {
    Json targetNames = Json::array();
    for (const MorphTarget& shape : model.attributes.morphTargets) targetNames.push_back(shape.name);
    for (size_t g = 0; g < groups.size(); ++g) {
        const bool isNew = g == 0 || groups[g].node != groups[g - 1].node;
        if (isNew) {
            uint32_t node = groups[g].node;
            if (node == kNone) {
                node = uint32_t(root["nodes"].size());
                root["nodes"].push_back(Json::object());
                roots.push_back(node);
            }
            Json mesh = {{"primitives", Json::array()}};
            const Json& owner = root["nodes"][node];
            if (owner.contains("name")) mesh["name"] = owner["name"];
            if (!targetNames.empty()) mesh["extras"]["targetNames"] = targetNames;
            root["nodes"][node]["mesh"] = root["meshes"].size();
            if (model.skins.size() == 1 && !model.attributes.joints[0].empty()) root["nodes"][node]["skin"] = 0;
            root["meshes"].push_back(mesh);
        }
        root["meshes"].back()["primitives"].push_back(primitiveOf(buffer, model, groups[g]));
    }
}

void appendChunk(Bytes& out, uint32_t type, const void* data, size_t size, char padding) {
    const auto padded = uint32_t((size + 3) / 4 * 4);
    append(out, &padded, 4);
    append(out, &type, 4);
    append(out, data, size);
    out.resize(out.size() + padded - size, std::byte(padding));
}

} // namespace

Status glbBytes(const Model& model, Bytes& out) {
    const std::vector<Group> groups = groupTriangles(model);
    BufferWriter buffer;
    Json root = {{"asset", {{"version", "2.0"}, {"generator", "xgc"}}}, {"scene", 0}};
    root["nodes"] = Json::array();
    root["meshes"] = Json::array();
    Json roots = addNodes(model, groups, root["nodes"]);
    addMeshes(model, groups, buffer, root, roots);
    for (const Material& material : model.materials) root["materials"].push_back(materialOf(material));
    for (const Skin& skin : model.skins) root["skins"].push_back(skinOf(buffer, skin));
    root["scenes"] = {{{"nodes", roots}}};
    root["accessors"] = std::move(buffer.accessors);
    root["bufferViews"] = std::move(buffer.views);
    root["buffers"] = {{{"byteLength", buffer.bytes.size()}}};
    const std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);

    const uint64_t total = 28 + (text.size() + 3) / 4 * 4 + buffer.bytes.size();
    if (total > 0xffffffffu) return badInput("a .glb file holds at most 4 GiB: write a .ply instead");
    out.clear();
    out.reserve(total);
    const uint32_t header[3] = {0x46546c67, 2, uint32_t(total)};
    append(out, header, sizeof(header));
    appendChunk(out, kJsonChunk, text.data(), text.size(), ' ');
    appendChunk(out, kBinaryChunk, buffer.bytes.data(), buffer.bytes.size(), 0);
    return {};
}

} // namespace xgc::bake::exports
