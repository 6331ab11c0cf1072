#include "bake/compress.h"

#include "bake/layout.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>

namespace xgc::bake {
namespace compress {

Bytes deflate(std::span<const std::byte> bytes, int level) {
    Bytes out(ZSTD_compressBound(bytes.size()));
    const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
    out.resize(ZSTD_isError(size) ? 0 : size);
    return out;
}

void append(Bytes& out, std::span<const std::byte> bytes) {
    const size_t at = out.size();
    out.resize(at + bytes.size());
    std::copy(bytes.begin(), bytes.end(), out.begin() + ptrdiff_t(at));
}

void appendPlanes(Bytes& out, std::span<const uint32_t> values, uint32_t planes) {
    for (uint32_t p = 0; p < planes; ++p) {
        for (const uint32_t v : values) out.push_back(std::byte(v >> (8 * p) & 255));
    }
}

} // namespace compress

namespace {

using namespace format;
using namespace compress;

/// What a codec made of some bytes; codec `none` where nothing made them smaller.
struct Coded {
    Codec codec = Codec::none;
    Bytes bytes;

    void offer(Codec other, Bytes&& better) {
        if (better.empty() || better.size() >= bytes.size()) return;
        codec = other;
        bytes = std::move(better);
    }
};

class Compressor {
public:
    Compressor(const AssetView& asset, int level)
        : asset_(asset), level_(level), narrow_(slotsByUse(asset, false)), wide_(slotsByUse(asset, true)),
          references_(rowReferences(asset)) {}

    Coded section(std::span<const std::byte> bytes) const {
        Coded coded{Codec::none, {bytes.begin(), bytes.end()}};
        coded.offer(Codec::zstd, deflate(bytes, level_));
        return coded;
    }

    Coded stream(const StreamRecord& s, std::span<const std::byte> bytes) const {
        Coded coded = section(bytes);
        switch (s.kind) {
        case StreamKind::cornerNarrow:
        case StreamKind::cornerWide: {
            const bool wide = s.kind == StreamKind::cornerWide;
            coded = {Codec::faces, encodeFaces(asset_, wide, wide ? wide_ : narrow_, level_)};
            break;
        }
        case StreamKind::parentNarrow:
        case StreamKind::parentWide: {
            const bool wide = s.kind == StreamKind::parentWide;
            if (!(wide ? asset_.cornersWide.empty() : asset_.cornersNarrow.empty()))
                coded.offer(Codec::parents, encodeParents(asset_, wide, wide ? wide_ : narrow_, level_));
            break;
        }
        default:
            if (s.kind <= StreamKind::weights)
                coded.offer(Codec::rows,
                            encodeRows({s.kind, s.format, s.set, s.stride, s.count, bytes}, references_, level_));
            break;
        }
        return coded;
    }

private:
    const AssetView& asset_;
    int level_;
    std::vector<uint32_t> narrow_, wide_;
    std::vector<uint32_t> references_;
};

std::span<const SectionRecord> sectionsOf(const AssetView& asset) {
    const auto* header = reinterpret_cast<const FileHeader*>(asset.bytes.data());
    return {reinterpret_cast<const SectionRecord*>(header + 1), header->sectionCount};
}

Bytes compressed(const AssetView& asset, const CompressOptions& options) {
    const Compressor compressor(asset, options.zstdLevel);
    layout::FileBuilder file;
    for (const SectionRecord& s : sectionsOf(asset)) {
        if (s.id == SectionId::pages || s.id == SectionId::streams) continue; // the builder's
        const Coded coded = compressor.section(asset.bytes.subspan(s.offset, s.storedBytes));
        file.codedSection(s, coded.codec, coded.bytes);
    }
    for (const StreamRecord& s : asset.streams) {
        const Coded coded = compressor.stream(s, asset.bytes.subspan(asset.pages[0].offset + s.offset, s.storedBytes));
        file.codedStream(s, coded.codec, coded.bytes);
    }
    Bytes out;
    file.finish(asset.levelCount(), out);
    return out;
}

Status checkRoundTrip(std::span<const std::byte> image, std::span<const std::byte> bytes) {
    AlignedBytes decoded;
    if (Status s = decodeImage(alignedCopy(bytes), decoded); !s.ok()) return s;
    const std::span<const std::byte> back = decoded.span();
    if (std::equal(back.begin(), back.end(), image.begin(), image.end())) return {};
    return {Outcome::promiseBroken, "compress: the file does not decode to what it was made of"};
}

} // namespace

Status compressAsset(std::span<const std::byte> image, const CompressOptions& options, std::vector<std::byte>& out) {
    const AlignedBytes copy = alignedCopy(image);
    AssetView asset;
    if (const xgc::Status s = openAll(copy.span(), asset); !s.ok())
        return badInput(fmt::format("compress: {} (element {})", s.message, s.element));
    Bytes bytes = compressed(asset, options);
    if (Status s = checkRoundTrip(image, bytes); !s.ok()) return s;
    out = std::move(bytes);
    return {};
}

} // namespace xgc::bake
