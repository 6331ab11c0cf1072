#include "open.h"
#include "xxh64.h"

// A page is a run of streams, each one array. Kinds that this version does not know are skipped, once it is sure
// that they lie where they say.

namespace xgc {
namespace {

using namespace format;

/// Bytes of one element; 0 for formats that this version does not know.
uint32_t sizeOf(StreamFormat format) {
    switch (format) {
    case StreamFormat::u8:
        return 1;
    case StreamFormat::u16:
        return 2;
    case StreamFormat::u32:
        return 4;
    case StreamFormat::f32x2:
        return 8;
    case StreamFormat::f32x3:
        return 12;
    case StreamFormat::f32x4:
        return 16;
    case StreamFormat::unorm8x4:
        return 4;
    case StreamFormat::u16x4:
        return 8;
    case StreamFormat::snorm16x2:
        return 4;
    case StreamFormat::snorm16x4:
        return 8;
    }
    return 0;
}

/// The format of the streams that the core itself reads; the others may have any that is known.
bool formatFits(StreamKind kind, StreamFormat format) {
    switch (kind) {
    case StreamKind::position:
        return format == StreamFormat::f32x3;
    case StreamKind::collapseLevel:
    case StreamKind::birthLevel:
        return format == StreamFormat::u8;
    case StreamKind::parentNarrow:
    case StreamKind::cornerNarrow:
        return format == StreamFormat::u16;
    case StreamKind::parentWide:
    case StreamKind::cornerWide:
        return format == StreamFormat::u32;
    default:
        return sizeOf(format) != 0;
    }
}

/// Streams are sorted by kind and set, and follow each other at the next multiple of 64.
Status checkPlacement(const StreamRecord& s, const StreamRecord* before, uint64_t end, uint64_t pageBytes,
                      uint64_t index) {
    if (before && (s.kind < before->kind || (s.kind == before->kind && s.set <= before->set)))
        return corrupt("stream out of order", index);
    if (s.offset != alignUp(end) || s.offset > pageBytes || s.storedBytes > pageBytes - s.offset)
        return corrupt("stream with a wrong offset or size", index);
    if (s.rawBytes != uint64_t(s.count) * s.stride || (s.codec == Codec::none && s.storedBytes != s.rawBytes))
        return corrupt("stream with another size than its elements", index);
    if (s.firstElement != 0) return corrupt("stream that continues a page that is not there", index);
    return {};
}

Status checkPlacements(const AssetView& v) {
    const PageRecord& page = v.pages[0];
    uint64_t end = 0;
    for (size_t i = 0; i < v.streams.size(); ++i) {
        const StreamRecord& s = v.streams[i];
        const StreamRecord* before = i > 0 ? &v.streams[i - 1] : nullptr;
        if (s.codec != Codec::none) return unsupported("stream is compressed; decode the file with xgc::load first", i);
        if (Status status = checkPlacement(s, before, end, page.storedBytes, i); !status.ok()) return status;
        end = s.offset + s.storedBytes;
    }
    return alignUp(end) == page.storedBytes ? Status{} : corrupt("the page does not end behind its last stream");
}

template <typename T>
std::span<const T> elements(const AssetView& v, const StreamRecord& s) {
    return {reinterpret_cast<const T*>(v.bytes.data() + v.pages[0].offset + s.offset), s.count};
}

Status installVertexStream(AssetView& v, const StreamRecord& s, uint64_t index) {
    if (v.vertexStreamCount == AssetView::kMaxVertexStreams)
        return unsupported("stream past the 16 that a vertex may have", index);
    const std::span<const std::byte> bytes = v.bytes.subspan(v.pages[0].offset + s.offset, s.storedBytes);
    v.vertexStreams[v.vertexStreamCount++] = {s.kind, s.format, s.set, s.stride, s.count, bytes};
    return {};
}

bool isKnown(StreamKind kind) {
    return (kind >= StreamKind::position && kind <= StreamKind::birthLevel) ||
           (kind >= StreamKind::parentNarrow && kind <= StreamKind::cornerWide);
}

bool isRowStream(StreamKind kind) {
    return kind >= StreamKind::position && kind <= StreamKind::birthLevel;
}

Status checkFormat(const StreamRecord& s, uint64_t index) {
    if (!formatFits(s.kind, s.format)) return unsupported("stream in a format that this version does not read", index);
    if (s.stride != sizeOf(s.format)) return corrupt("stream with another stride than its format", index);
    return {};
}

Status installStream(AssetView& v, uint64_t index) {
    const StreamRecord& s = v.streams[index];
    if (isRowStream(s.kind) && s.count != v.record->vertexCount)
        return corrupt("stream with another count than the vertex rows", index);
    if (!isKnown(s.kind)) return {}; // a later version's
    if (Status status = checkFormat(s, index); !status.ok()) return status;
    switch (s.kind) {
    case StreamKind::position:
        v.positions = elements<glm::vec3>(v, s);
        break;
    case StreamKind::collapseLevel:
        v.collapseLevels = elements<uint8_t>(v, s);
        break;
    case StreamKind::birthLevel:
        v.birthLevels = elements<uint8_t>(v, s);
        break;
    case StreamKind::parentNarrow:
        v.parentsNarrow = elements<uint16_t>(v, s);
        break;
    case StreamKind::parentWide:
        v.parentsWide = elements<uint32_t>(v, s);
        break;
    case StreamKind::cornerNarrow:
        v.cornersNarrow = elements<uint16_t>(v, s);
        break;
    case StreamKind::cornerWide:
        v.cornersWide = elements<uint32_t>(v, s);
        break;
    case StreamKind::normal:
    case StreamKind::tangent:
    case StreamKind::uv:
    case StreamKind::color:
    case StreamKind::joints:
    case StreamKind::weights:
        break;
    }
    return s.kind <= StreamKind::weights ? installVertexStream(v, s, index) : Status{};
}

/// The streams hold as many elements as the patches refer to.
Status checkCounts(const AssetView& v) {
    uint64_t narrowSlots = 0, wideSlots = 0, narrowFaces = 0, wideFaces = 0;
    for (const PatchRecord& patch : v.patches) {
        const bool wide = patch.flags & kWideSlots;
        (wide ? wideSlots : narrowSlots) += patch.slotCount;
        (wide ? wideFaces : narrowFaces) += patch.listedFaceCount;
    }
    if (v.positions.size() != v.record->vertexCount) return corrupt("the page has no position for each vertex row");
    if (v.collapseLevels.size() != v.record->vertexCount)
        return corrupt("the page has no collapse level for each vertex row");
    if (v.parentsNarrow.size() != narrowSlots || v.parentsWide.size() != wideSlots)
        return corrupt("the page has not a parent for each slot");
    if (v.cornersNarrow.size() != 3 * narrowFaces || v.cornersWide.size() != 3 * wideFaces)
        return corrupt("the page has not three corners for each listed face");
    return {};
}

} // namespace

Status checkStreamRecord(const StreamRecord& s, const StreamRecord* before, uint64_t end, uint64_t pageBytes,
                         uint64_t index) {
    if (s.codec != Codec::none && s.codec != Codec::zstd)
        return unsupported("stream has a codec that pages are not read in; update xgc", index);
    if (Status status = checkPlacement(s, before, end, pageBytes, index); !status.ok()) return status;
    return isKnown(s.kind) ? checkFormat(s, index) : Status{};
}

Status installPage(AssetView& view) {
    const PageRecord& page = view.pages[0];
    if (view.bytes.size() < page.offset + page.storedBytes)
        return {StatusCode::truncated, "the file ends within its page; copy it again", view.bytes.size()};
    if (xxh64(view.bytes.subspan(page.offset, page.storedBytes)) != page.checksum)
        return {StatusCode::badChecksum, "the page was altered; copy the file again"};
    if (Status s = checkPlacements(view); !s.ok()) return s;
    for (size_t i = 0; i < view.streams.size(); ++i) {
        if (Status s = installStream(view, i); !s.ok()) return s;
    }
    return checkCounts(view);
}

} // namespace xgc
