#pragma once

#include <xgc/asset.h>
#include <xgc/bake/compress.h>

// The encoders of FORMAT.md's codecs: each the reverse of a decoder in runtime/load.

namespace xgc::bake::compress {

using Bytes = std::vector<std::byte>;

/// A zstd frame.
Bytes deflate(std::span<const std::byte> bytes, int level);

void append(Bytes& out, std::span<const std::byte> bytes);

/// Appends the bytes of numbers plane by plane: all low bytes, all next ones, ...
void appendPlanes(Bytes& out, std::span<const uint32_t> values, uint32_t planes);

constexpr uint32_t zigzag(uint32_t difference) {
    return (difference << 1) ^ (0u - (difference >> 31));
}

/// The slots of all patches of one width in the order in which their faces use them first, then the unused ones.
/// Entry PatchRecord::firstParent + i.
std::vector<uint32_t> slotsByUse(const AssetView& asset, bool wide);

/// A stream of Codec::faces: the corners of all patches of one width.
Bytes encodeFaces(const AssetView& asset, bool wide, std::span<const uint32_t> slots, int level);

/// A stream of Codec::parents.
Bytes encodeParents(const AssetView& asset, bool wide, std::span<const uint32_t> slots, int level);

/// For each row the one that it is coded against: its parent, or the row before where it has none.
std::vector<uint32_t> rowReferences(const AssetView& asset);

/// A stream of Codec::rows, by the transform that makes it smallest; empty for formats that the codec does not know.
Bytes encodeRows(const VertexStream& stream, std::span<const uint32_t> references, int level);

} // namespace xgc::bake::compress
