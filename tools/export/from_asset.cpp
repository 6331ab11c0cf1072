#include <xgc/bake/from_asset.h>

#include <xgc/indices.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace xgc::bake {
namespace {

using format::StreamFormat;
using format::StreamKind;

template <typename T, int N>
glm::vec4 components(const std::byte* data, float scale) {
    T raw[N];
    std::memcpy(raw, data, sizeof(raw));
    glm::vec4 v(0);
    for (int i = 0; i < N; ++i) v[i] = float(raw[i]) * scale;
    return v;
}

/// One element as numbers: unorm in [0, 1], snorm in [-1, 1].
glm::vec4 decode(const VertexStream& stream, uint32_t row) {
    const std::byte* data = stream.bytes.data() + size_t(row) * stream.stride;
    switch (stream.format) {
    case StreamFormat::f32x2:
        return components<float, 2>(data, 1);
    case StreamFormat::f32x3:
        return components<float, 3>(data, 1);
    case StreamFormat::f32x4:
        return components<float, 4>(data, 1);
    case StreamFormat::unorm8x4:
        return components<uint8_t, 4>(data, 1.0f / 255);
    case StreamFormat::u16x4:
        return components<uint16_t, 4>(data, 1);
    case StreamFormat::snorm16x2:
        return glm::max(components<int16_t, 2>(data, 1.0f / 32767), -1.0f);
    case StreamFormat::snorm16x4:
        return glm::max(components<int16_t, 4>(data, 1.0f / 32767), -1.0f);
    case StreamFormat::u8:
        return components<uint8_t, 1>(data, 1);
    case StreamFormat::u16:
        return components<uint16_t, 1>(data, 1);
    case StreamFormat::u32:
        return components<uint32_t, 1>(data, 1);
    }
    return glm::vec4(0);
}

glm::vec3 unit(glm::vec3 v) {
    const float length = std::sqrt(glm::dot(v, v));
    return length > 0 ? v / length : glm::vec3(0);
}

glm::vec3 octahedral(glm::vec2 p) {
    const float z = 1 - std::abs(p.x) - std::abs(p.y);
    const auto sign = [](float x) { return x < 0 ? -1.0f : 1.0f; };
    if (z < 0) p = {(1 - std::abs(p.y)) * sign(p.x), (1 - std::abs(p.x)) * sign(p.y)};
    return unit({p.x, p.y, z});
}

glm::vec3 decodeNormal(const VertexStream& stream, uint32_t row) {
    const glm::vec4 v = decode(stream, row);
    return stream.format == StreamFormat::snorm16x2 ? octahedral(glm::vec2(v)) : glm::vec3(v);
}

glm::vec4 decodeTangent(const VertexStream& stream, uint32_t row) {
    const glm::vec4 v = decode(stream, row);
    return {unit(glm::vec3(v)), v.w < 0 ? -1.0f : 1.0f};
}

/// A column of the model, from rows of a stream.
template <typename T, typename Decode>
void fill(std::vector<T>& column, const VertexStream& stream, const std::vector<uint32_t>& rows, Decode&& decodeRow) {
    column.reserve(rows.size());
    for (const uint32_t row : rows) column.push_back(T(decodeRow(stream, row)));
}

Status addStream(const VertexStream& stream, const std::vector<uint32_t>& rows, Attributes& out) {
    size_t sets = 1;
    if (stream.kind == StreamKind::uv) sets = Attributes::kUvSets;
    if (stream.kind == StreamKind::color) sets = Attributes::kColorSets;
    if (stream.kind == StreamKind::joints || stream.kind == StreamKind::weights) sets = Attributes::kJointSets;
    if (stream.set >= sets) {
        return badInput(fmt::format("vertex stream of kind {} has set {}, this tool reads sets below {}",
                                    uint32_t(stream.kind), stream.set, sets));
    }
    switch (stream.kind) {
    case StreamKind::normal:
        fill(out.normals, stream, rows, decodeNormal);
        break;
    case StreamKind::tangent:
        fill(out.tangents, stream, rows, decodeTangent);
        break;
    case StreamKind::uv:
        fill(out.uvs[stream.set], stream, rows, decode);
        break;
    case StreamKind::color:
        fill(out.colors[stream.set], stream, rows, decode);
        break;
    case StreamKind::joints:
        fill(out.joints[stream.set], stream, rows, decode);
        break;
    case StreamKind::weights:
        fill(out.weights[stream.set], stream, rows, decode);
        break;
    default:
        break;
    }
    return {};
}

void addMaterials(const AssetView& asset, Model& model) {
    for (const format::MaterialRecord& record : asset.materials) {
        Material material;
        material.name = asset.text(record.name);
        material.baseColor = {record.baseColor[0], record.baseColor[1], record.baseColor[2], record.baseColor[3]};
        material.metallic = record.metallic;
        material.roughness = record.roughness;
        material.emissive = {record.emissive[0], record.emissive[1], record.emissive[2]};
        material.doubleSided = (record.flags & format::kDoubleSided) != 0;
        material.alphaMask = (record.flags & format::kAlphaMask) != 0;
        material.alphaBlend = (record.flags & format::kAlphaBlend) != 0;
        material.alphaCutoff = asset.alphaCutoff(uint32_t(model.materials.size()));
        model.materials.push_back(material);
    }
}

void addNodes(const AssetView& asset, Model& model) {
    for (const format::PartRecord& part : asset.parts) {
        model.nodes.push_back({std::string(asset.text(part.name)), kNone, glm::mat4(1)});
    }
    const auto first = uint32_t(model.nodes.size());
    for (const format::NodeRecord& record : asset.nodes) {
        SceneNode node;
        node.name = asset.text(record.name);
        node.parent = record.parent == format::kNone ? kNone : first + record.parent;
        std::memcpy(&node.toMesh, record.toMesh, sizeof(record.toMesh));
        model.nodes.push_back(node);
    }
}

Status checkLevels(const AssetView& asset, std::span<const uint8_t> levels) {
    if (levels.size() != asset.patchCount()) {
        return usageError(fmt::format("{} levels given, the asset has {} patches and wants one for each", levels.size(),
                                      asset.patchCount()));
    }
    for (size_t p = 0; p < levels.size(); ++p) {
        if (levels[p] >= asset.levelCount()) {
            return usageError(fmt::format("level {} of patch {}: the asset has levels 0 to {}", levels[p], p,
                                          asset.levelCount() - 1));
        }
    }
    return {};
}

/// Triangles of all patches over the asset's rows, with their material and part.
void addTriangles(const AssetView& asset, std::span<const uint8_t> levels, Model& model) {
    std::vector<uint32_t> scratch(scratchCapacity(asset)), indices;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        indices.resize(indexCapacity(asset, p, levels));
        const uint32_t count = buildIndices(asset, p, levels, scratch, indices);
        for (uint32_t i = 0; i < count; i += 3) {
            model.triangleFace.push_back(uint32_t(model.triangles.size()));
            model.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
            model.triangleMaterial.push_back(asset.patches[p].material);
            model.triangleNode.push_back(asset.patches[p].part);
        }
    }
    model.inputFaceCount = uint32_t(model.triangles.size());
}

/// Renumbers the triangles over the rows that they use; returns those.
std::vector<uint32_t> keepUsedRows(uint32_t rowCount, std::vector<glm::uvec3>& triangles) {
    std::vector<uint32_t> number(rowCount, kNone);
    for (const glm::uvec3 t : triangles) {
        for (int k = 0; k < 3; ++k) number[t[k]] = 0;
    }
    std::vector<uint32_t> rows;
    for (uint32_t row = 0; row < rowCount; ++row) {
        if (number[row] == kNone) continue;
        number[row] = uint32_t(rows.size());
        rows.push_back(row);
    }
    for (glm::uvec3& t : triangles) t = {number[t.x], number[t.y], number[t.z]};
    return rows;
}

} // namespace

Status modelFromAsset(const AssetView& asset, std::span<const uint8_t> levels, Model& out) {
    if (Status status = checkLevels(asset, levels); !status.ok()) return status;
    Model model;
    addMaterials(asset, model);
    addNodes(asset, model);
    addTriangles(asset, levels, model);
    const std::vector<uint32_t> rows = keepUsedRows(asset.record->vertexCount, model.triangles);
    for (const uint32_t row : rows) model.positions.push_back(asset.positions[row]);
    for (uint32_t s = 0; s < asset.vertexStreamCount; ++s) {
        if (Status status = addStream(asset.vertexStreams[s], rows, model.attributes); !status.ok()) return status;
    }
    out = std::move(model);
    return {};
}

} // namespace xgc::bake
