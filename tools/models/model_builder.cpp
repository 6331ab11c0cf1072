#include "models/model_builder.h"

#include <cstring>
#include <unordered_map>

namespace xgc::bake::models {
namespace {

/// The bits of a row: what makes two of them one.
struct RowBits {
    uint32_t words[11];
    bool operator==(const RowBits&) const = default;
};
struct RowBitsHash {
    size_t operator()(const RowBits& row) const {
        uint64_t h = 0;
        for (const uint32_t w : row.words) h = (h ^ w) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
        return size_t(h);
    }
};

/// -0 becomes 0, so that equal numbers have equal bits.
template <typename Vector>
void clearNegativeZeros(std::vector<Vector>& column) {
    for (Vector& v : column) v += Vector(0);
}

} // namespace

uint32_t ModelBuilder::addMaterial(const char* name, glm::vec3 color, float roughness, float metallic) {
    Material material;
    material.name = name;
    material.baseColor = {color, 1};
    material.roughness = roughness;
    material.metallic = metallic;
    model_.materials.push_back(material);
    return uint32_t(model_.materials.size() - 1);
}

void ModelBuilder::beginNode(const std::string& name) {
    model_.nodes.push_back({name, kNone, glm::mat4(1)});
}

uint32_t ModelBuilder::addRow(const Row& row) {
    model_.positions.push_back(row.position);
    model_.attributes.normals.push_back(row.normal);
    model_.attributes.uvs[0].push_back(row.uv);
    model_.attributes.colors[0].emplace_back(row.color, 1.0f);
    return uint32_t(model_.positions.size() - 1);
}

void ModelBuilder::addTriangle(uint32_t a, uint32_t b, uint32_t c) {
    const std::vector<glm::vec3>& p = model_.positions;
    if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return;
    model_.triangleFace.push_back(uint32_t(model_.triangles.size()));
    model_.triangles.emplace_back(a, b, c);
    model_.triangleMaterial.push_back(material_);
    model_.triangleNode.push_back(model_.nodes.empty() ? kNone : uint32_t(model_.nodes.size() - 1));
}

void ModelBuilder::addModel(const Model& model, const glm::mat3& turn, float scale, glm::vec3 at) {
    if (counting_) {
        count_ += model.triangles.size();
        return;
    }
    const auto first = uint32_t(model_.positions.size());
    for (size_t row = 0; row < model.positions.size(); ++row) {
        addRow({turn * (scale * model.positions[row]) + at, turn * model.attributes.normals[row], {}, glm::vec3(1)});
    }
    for (const glm::uvec3 t : model.triangles) addTriangle(first + t.x, first + t.y, first + t.z);
}

Model ModelBuilder::finish(const char* name) {
    Attributes& from = model_.attributes;
    clearNegativeZeros(model_.positions);
    clearNegativeZeros(from.normals);
    clearNegativeZeros(from.uvs[0]);
    std::unordered_map<RowBits, uint32_t, RowBitsHash> merged;
    merged.reserve(model_.positions.size());
    std::vector<uint32_t> target(model_.positions.size(), kNone);
    uint32_t count = 0;
    const auto mergeRow = [&](uint32_t row) {
        if (target[row] != kNone) return target[row];
        RowBits bits;
        std::memcpy(bits.words, &model_.positions[row], 12);
        std::memcpy(bits.words + 3, &from.normals[row], 12);
        std::memcpy(bits.words + 6, &from.uvs[0][row], 8);
        std::memcpy(bits.words + 8, &from.colors[0][row], 12);
        return target[row] = merged.emplace(bits, uint32_t(merged.size())).first->second;
    };
    for (glm::uvec3& t : model_.triangles) t = {mergeRow(t.x), mergeRow(t.y), mergeRow(t.z)};
    count = uint32_t(merged.size());
    Model out = std::move(model_);
    Attributes rows;
    std::vector<glm::vec3> positions(count);
    rows.normals.resize(count);
    rows.uvs[0].resize(count);
    rows.colors[0].resize(count);
    for (uint32_t row = 0; row < target.size(); ++row) {
        if (target[row] == kNone) continue;
        positions[target[row]] = out.positions[row];
        rows.normals[target[row]] = out.attributes.normals[row];
        rows.uvs[0][target[row]] = out.attributes.uvs[0][row];
        rows.colors[0][target[row]] = out.attributes.colors[0][row];
    }
    out.file = name;
    out.positions = std::move(positions);
    out.attributes = std::move(rows);
    out.inputFaceCount = uint32_t(out.triangles.size());
    model_ = {};
    return out;
}

} // namespace xgc::bake::models
