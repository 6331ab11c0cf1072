#include "bake/compress.h"
#include "bake/octahedral.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

namespace xgc::bake::compress {
namespace {

using namespace format;

/// Elements as numbers, one after the other; `bytes` tells how many of their low bytes count.
struct Lanes {
    uint32_t count = 0; ///< of an element
    uint32_t bytes = 0;
    bool isFloat = false;
    std::vector<uint32_t> values;
};

Lanes lanesOf(const VertexStream& s) {
    Lanes lanes;
    lanes.isFloat =
        s.format == StreamFormat::f32x2 || s.format == StreamFormat::f32x3 || s.format == StreamFormat::f32x4;
    lanes.bytes = lanes.isFloat ? 4 : s.format == StreamFormat::unorm8x4 ? 1 : 2;
    lanes.count = s.stride / lanes.bytes;
    lanes.values.resize(s.bytes.size() / lanes.bytes);
    for (size_t i = 0; i < lanes.values.size(); ++i) {
        std::memcpy(&lanes.values[i], s.bytes.data() + i * lanes.bytes, lanes.bytes);
    }
    return lanes;
}

/// A transform, its parameter and what it makes of the values.
struct Transformed {
    RowTransform transform = RowTransform::none;
    int32_t parameter = 0;
    std::vector<uint32_t> values;
};

uint32_t floatKey(uint32_t bits) {
    return bits ^ (bits >> 31 ? 0xffffffffu : 0x80000000u);
}

/// Exponent of the lowest set bit of a float; none where it is 0.
std::optional<int32_t> lowestExponent(uint32_t bits) {
    const uint32_t exponent = bits >> 23 & 255, fraction = bits & 0x7fffff;
    if (exponent == 0 && fraction == 0) return {};
    const uint32_t mantissa = exponent ? fraction | 0x800000 : fraction;
    return int32_t(std::max(exponent, 1u)) - 150 + std::countr_zero(mantissa);
}

/// The coarsest grid of a power of two that all values lie on; none where 32 bits do not count its cells.
std::optional<Transformed> onGrid(const Lanes& lanes) {
    int32_t exponent = 127;
    for (const uint32_t bits : lanes.values) {
        if (bits == 0x80000000u) return {}; // the grid has no -0
        exponent = std::min(exponent, lowestExponent(bits).value_or(127));
    }
    if (exponent < -126) return {};
    Transformed t{RowTransform::grid, exponent, {}};
    t.values.reserve(lanes.values.size());
    const double cells = std::ldexp(1.0, -exponent);
    for (const uint32_t bits : lanes.values) {
        const double cell = double(std::bit_cast<float>(bits)) * cells;
        if (!(std::abs(cell) < 0x1p31)) return {};
        t.values.push_back(uint32_t(int32_t(cell)));
    }
    return t;
}

/// Fewer bits, where all values are such widened to 16.
std::optional<Transformed> narrowSnorm(const Lanes& lanes) {
    for (int32_t bits = 8; bits <= 15; ++bits) {
        Transformed t{RowTransform::snorm, bits, {}};
        t.values.reserve(lanes.values.size());
        for (const uint32_t v : lanes.values) {
            const auto wide = int16_t(v);
            const int32_t code = wide < 0 ? -(-wide >> (16 - bits)) : wide >> (16 - bits);
            if (widenSnorm(code, uint32_t(bits)) != wide) break;
            t.values.push_back(uint32_t(code) & 0xffff);
        }
        if (t.values.size() == lanes.values.size()) return t;
    }
    return {};
}

Bytes encode(const Lanes& lanes, const Transformed& t, std::span<const uint32_t> references, int level) {
    const uint32_t n = lanes.count, unused = 32 - 8 * lanes.bytes;
    RowsHeader header = {};
    header.transform = t.transform;
    header.parameter = t.parameter;
    for (uint32_t lane = 0; lane < n; ++lane) header.base[lane] = t.values[lane];
    std::vector<std::vector<uint32_t>> differences(n, std::vector<uint32_t>(references.size(), 0));
    uint32_t largest = 0;
    for (size_t row = 1; row < references.size(); ++row) {
        for (uint32_t lane = 0; lane < n; ++lane) {
            const uint32_t d = t.values[row * n + lane] - t.values[size_t(references[row]) * n + lane];
            const uint32_t z = zigzag(uint32_t(int32_t(d << unused) >> unused));
            differences[lane][row] = z;
            largest = std::max(largest, z);
        }
    }
    header.planes = uint32_t(std::bit_width(largest) + 7) / 8;
    Bytes planes, out;
    for (const std::vector<uint32_t>& lane : differences) appendPlanes(planes, lane, header.planes);
    append(out, std::as_bytes(std::span(&header, 1)));
    append(out, deflate(planes, level));
    return out;
}

} // namespace

Bytes encodeRows(const VertexStream& stream, std::span<const uint32_t> references, int level) {
    const Lanes lanes = lanesOf(stream);
    if (lanes.count < 2 || lanes.count > 4 || references.empty()) return {};
    const RowTransform plain = lanes.isFloat ? RowTransform::floats : RowTransform::none;
    Transformed t{plain, 0, lanes.values};
    if (lanes.isFloat) std::transform(t.values.begin(), t.values.end(), t.values.begin(), floatKey);
    Bytes best = encode(lanes, t, references, level);
    const std::optional<Transformed> other = lanes.isFloat      ? onGrid(lanes)
                                             : lanes.bytes == 2 ? narrowSnorm(lanes)
                                                                : std::nullopt;
    if (!other) return best;
    Bytes bytes = encode(lanes, *other, references, level);
    return bytes.size() < best.size() ? bytes : best;
}

} // namespace xgc::bake::compress
