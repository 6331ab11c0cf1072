#include "bake/layout.h"
#include "bake/octahedral.h"

#include <algorithm>
#include <cmath>

// Encodings of the vertex streams, by +, -, *, / and sqrt alone, so that they are the same on any machine.

namespace xgc::bake::layout {
namespace {

using format::StreamFormat;
using format::StreamKind;

int16_t snorm16(double value) {
    return int16_t(std::floor(std::clamp(value, -1.0, 1.0) * 32767 + 0.5));
}

uint8_t unorm8(double value) {
    return uint8_t(std::floor(std::clamp(value, 0.0, 1.0) * 255 + 0.5)); // NaN is clamped by the caller's check
}

glm::i16vec4 encodeTangent(const glm::vec4& t) {
    const double length = std::sqrt(double(t.x) * t.x + double(t.y) * t.y + double(t.z) * t.z);
    const double scale = length > 0 && std::isfinite(length) ? 1 / length : 0;
    const auto component = [&](float v) { return scale > 0 ? snorm16(v * scale) : int16_t(0); };
    return {component(t.x), component(t.y), component(t.z), int16_t(t.w < 0 ? -32767 : 32767)};
}

glm::u8vec4 encodeColor(const glm::vec4& c) {
    const auto component = [](float v) { return std::isnan(v) ? uint8_t(0) : unorm8(v); };
    return {component(c.x), component(c.y), component(c.z), component(c.w)};
}

/// One column, a row each, through an encoding. Columns that the mesh does not have give nothing.
template <typename T, typename Encode>
void addColumn(const std::vector<T>& column, const Rows& rows, StreamKind kind, StreamFormat format, uint32_t set,
               FileBuilder& file, const Encode& encode) {
    if (column.empty()) return;
    std::vector<decltype(encode(column.front()))> encoded;
    encoded.reserve(rows.wedgeOf.size());
    for (const uint32_t wedge : rows.wedgeOf) encoded.push_back(encode(column[wedge]));
    file.stream<decltype(encode(column.front()))>(kind, format, set, encoded);
}

} // namespace

void addVertexStreams(const Hierarchy& h, const Rows& rows, FileBuilder& file) {
    const auto same = [](const auto& value) { return value; };
    const Attributes& a = h.attributes;
    std::vector<glm::vec3> positions;
    positions.reserve(rows.wedgeOf.size());
    for (const uint32_t wedge : rows.wedgeOf) positions.push_back(h.positions[h.wedgePosition[wedge]]);
    file.stream<glm::vec3>(StreamKind::position, StreamFormat::f32x3, 0, positions);
    addColumn(a.normals, rows, StreamKind::normal, StreamFormat::snorm16x2, 0, file,
              [](const glm::vec3& n) { return octahedralEncode(n); });
    addColumn(a.tangents, rows, StreamKind::tangent, StreamFormat::snorm16x4, 0, file, encodeTangent);
    for (uint32_t set = 0; set < a.uvs.size(); ++set) {
        addColumn(a.uvs[set], rows, StreamKind::uv, StreamFormat::f32x2, set, file, same);
    }
    for (uint32_t set = 0; set < a.colors.size(); ++set) {
        addColumn(a.colors[set], rows, StreamKind::color, StreamFormat::unorm8x4, set, file, encodeColor);
    }
    for (uint32_t set = 0; set < a.joints.size(); ++set) {
        addColumn(a.joints[set], rows, StreamKind::joints, StreamFormat::u16x4, set, file, same);
        addColumn(a.weights[set], rows, StreamKind::weights, StreamFormat::f32x4, set, file, same);
    }
}

} // namespace xgc::bake::layout
