#include "decode.h"

#include <type_traits>

// A row is much like its parent, which lies close by: only the difference is stored. Lanes are the components of an
// element; a difference is zigzag coded, and the bytes of equal weight of all rows lie together, lane by lane:
//
//   lane 0: low bytes of all rows | next bytes of all rows | ... | lane 1: low bytes ...

namespace xgc::load {
namespace {

using namespace format;

struct Lanes {
    uint32_t count;
    uint32_t bytes; ///< of each
    bool isFloat;
};

/// Of the formats that a row may have; no lanes for others.
Lanes lanesOf(StreamFormat format) {
    switch (format) {
    case StreamFormat::f32x2:
        return {2, 4, true};
    case StreamFormat::f32x3:
        return {3, 4, true};
    case StreamFormat::f32x4:
        return {4, 4, true};
    case StreamFormat::unorm8x4:
        return {4, 1, false};
    case StreamFormat::u16x4:
    case StreamFormat::snorm16x4:
        return {4, 2, false};
    case StreamFormat::snorm16x2:
        return {2, 2, false};
    case StreamFormat::u8:
    case StreamFormat::u16:
    case StreamFormat::u32:
        break;
    }
    return {0, 0, false};
}

bool headerFits(const RowsHeader& header, const Lanes& lanes) {
    if (lanes.count == 0 || header.planes > lanes.bytes) return false;
    switch (header.transform) {
    case RowTransform::none:
        return true;
    case RowTransform::floats:
        return lanes.isFloat;
    case RowTransform::grid:
        return lanes.isFloat && header.parameter >= -126 && header.parameter <= 127;
    case RowTransform::snorm:
        return lanes.bytes == 2 && header.parameter >= 8 && header.parameter <= 15;
    }
    return false;
}

/// out[row] = out[reference] + difference, for the rows past the first.
template <typename Lane, uint32_t laneCount, uint32_t planeCount>
void addDifferences(const std::byte* planes, std::span<const uint32_t> references, Lane* out) {
    const size_t rows = references.size();
    for (size_t row = 1; row < rows; ++row) {
        const Lane* from = out + size_t(references[row]) * laneCount;
        for (uint32_t lane = 0; lane < laneCount; ++lane) {
            uint32_t z = 0;
            for (uint32_t p = 0; p < planeCount; ++p) {
                z |= uint32_t(planes[(lane * planeCount + p) * rows + row]) << (8 * p);
            }
            const uint32_t difference = (z >> 1) ^ (0u - (z & 1));
            out[row * laneCount + lane] = Lane(from[lane] + difference);
        }
    }
}

template <typename Lane, uint32_t laneCount>
void addPlanes(uint32_t planeCount, const std::byte* planes, std::span<const uint32_t> references, Lane* out) {
    switch (planeCount) {
    case 0:
        return addDifferences<Lane, laneCount, 0>(planes, references, out);
    case 1:
        return addDifferences<Lane, laneCount, 1>(planes, references, out);
    case 2:
        if constexpr (sizeof(Lane) >= 2) return addDifferences<Lane, laneCount, 2>(planes, references, out);
        break;
    case 3:
        if constexpr (sizeof(Lane) >= 4) return addDifferences<Lane, laneCount, 3>(planes, references, out);
        break;
    default:
        if constexpr (sizeof(Lane) >= 4) return addDifferences<Lane, laneCount, 4>(planes, references, out);
        break;
    }
}

template <typename Lane>
void addLanes(const Lanes& lanes, const RowsHeader& header, const std::byte* planes,
              std::span<const uint32_t> references, std::byte* bytes) {
    Lane* out = reinterpret_cast<Lane*>(bytes);
    for (uint32_t lane = 0; lane < lanes.count; ++lane) out[lane] = Lane(header.base[lane]);
    if (lanes.count == 2) return addPlanes<Lane, 2>(header.planes, planes, references, out);
    if (lanes.count == 3) return addPlanes<Lane, 3>(header.planes, planes, references, out);
    addPlanes<Lane, 4>(header.planes, planes, references, out);
}

/// Keys, ordered as the floats are, to the bits of the floats.
void toFloatBits(std::span<std::byte> bytes) {
    auto* out = reinterpret_cast<uint32_t*>(bytes.data());
    for (size_t i = 0; i < bytes.size() / 4; ++i) {
        const uint32_t key = out[i];
        out[i] = key ^ ((key >> 31) ? 0x80000000u : 0xffffffffu);
    }
}

void toGrid(std::span<std::byte> bytes, int32_t exponent) {
    const auto stepBits = uint32_t(exponent + 127) << 23;
    float step = 0;
    std::memcpy(&step, &stepBits, sizeof step);
    for (size_t i = 0; i < bytes.size() / 4; ++i) {
        int32_t value = 0;
        std::memcpy(&value, bytes.data() + 4 * i, sizeof value);
        const float result = float(value) * step;
        std::memcpy(bytes.data() + 4 * i, &result, sizeof result);
    }
}

/// Repeats the bits of the magnitude until 15 are full: the largest becomes 32,767.
void widenSnorm(std::span<std::byte> bytes, uint32_t bits) {
    const uint32_t b = bits - 1; // 7..14
    const uint32_t repeat = (1u << (2 * b)) | (1u << b) | 1u, shift = 3 * b - 15;
    auto* out = reinterpret_cast<uint16_t*>(bytes.data());
    for (size_t i = 0; i < bytes.size() / 2; ++i) {
        const uint32_t sign = 0u - uint32_t(out[i] >> 15);
        const uint32_t magnitude = ((out[i] ^ sign) - sign) & ((1u << b) - 1);
        const auto wide = uint32_t((uint64_t(magnitude) * repeat) >> shift);
        out[i] = uint16_t((wide ^ sign) - sign);
    }
}

} // namespace

bool decodeRows(const Decoding& d, const StreamRecord& stream, std::span<const std::byte> stored,
                std::span<std::byte> out) {
    RowsHeader header;
    const Lanes lanes = lanesOf(stream.format);
    if (!readHeader(stored, header) || !headerFits(header, lanes)) return false;
    if (stream.stride != lanes.count * lanes.bytes || stream.count != d.references.size()) return false;
    const uint64_t size = uint64_t(stream.count) * lanes.count * header.planes;
    if (size > d.work.size() || !d.inflater.inflate(stored, d.work.first(size))) return false;
    if (lanes.bytes == 1)
        addLanes<uint8_t>(lanes, header, d.work.data(), d.references, out.data());
    else if (lanes.bytes == 2)
        addLanes<uint16_t>(lanes, header, d.work.data(), d.references, out.data());
    else
        addLanes<uint32_t>(lanes, header, d.work.data(), d.references, out.data());
    if (header.transform == RowTransform::floats) toFloatBits(out);
    if (header.transform == RowTransform::grid) toGrid(out, header.parameter);
    if (header.transform == RowTransform::snorm) widenSnorm(out, uint32_t(header.parameter));
    return true;
}

} // namespace xgc::load
