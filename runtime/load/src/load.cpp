#include "decode.h"
#include "join.h"
#include "xxh64.h"

#include <xgc/load.h>

#include <algorithm>

// Decoding is a recipe of four steps: the container (which bytes are which, unaltered), the directory of the image
// (where each section and stream will lie once decoded), the tables, which are opened as those of any file, and the
// streams, by those tables. Sections `pages` and `streams` are never compressed: they tell all sizes.

namespace xgc {
namespace {

using namespace format;
using namespace load;

constexpr uint64_t kMostBytes = uint64_t(1) << 40;

struct Directory {
    std::span<const std::byte> file;
    std::span<const SectionRecord> sections;
    const PageRecord* page = nullptr;
    std::span<const StreamRecord> streams;
    uint64_t tableBytes = 0; ///< of the image
    uint64_t pageBytes = 0;  ///< of the image
    uint64_t rowCount = 0, narrowSlots = 0, wideSlots = 0;
    uint64_t workBytes = 0;
    bool isCompressed = false;
};

std::span<const std::byte> storedOf(const Directory& d, const SectionRecord& s) {
    return d.file.subspan(s.offset, s.storedBytes);
}

std::span<const std::byte> storedOf(const Directory& d, const StreamRecord& s) {
    return d.file.subspan(d.page->offset + s.offset, s.storedBytes);
}

template <typename T>
Status findTable(const Directory& d, SectionId id, std::span<const T>& out) {
    for (const SectionRecord& s : d.sections) {
        if (s.id != id) continue;
        if (s.codec != Codec::none) return unsupported("section (by id) is compressed and must not be", uint64_t(id));
        if (s.stride != sizeof(T) || s.storedBytes != s.rawBytes || s.storedBytes != uint64_t(s.count) * sizeof(T))
            return corrupt("section (by id) has another size than its elements", uint64_t(id));
        out = {reinterpret_cast<const T*>(d.file.data() + s.offset), s.count};
        return {};
    }
    return corrupt("section (by id) is missing", uint64_t(id));
}

Status measureSections(Directory& d) {
    uint64_t end = sizeof(FileHeader) + d.sections.size_bytes();
    for (const SectionRecord& s : d.sections) {
        if (s.rawBytes > kMostBytes || s.rawBytes != uint64_t(s.count) * s.stride)
            return corrupt("section (by id) has another size than its elements", uint64_t(s.id));
        if (s.codec == Codec::none && s.storedBytes != s.rawBytes)
            return corrupt("section (by id) has another size than its elements", uint64_t(s.id));
        if (s.codec != Codec::none && s.codec != Codec::zstd)
            return unsupported("section (by id) has a codec that this version does not know; update xgc",
                               uint64_t(s.id));
        d.isCompressed |= s.codec != Codec::none;
        end = alignUp(end) + s.rawBytes;
        if (end > kMostBytes) return corrupt("the file decodes to more than 1 TiB");
    }
    d.tableBytes = alignUp(end);
    return {};
}

bool isKnown(Codec codec) {
    return codec == Codec::none || codec == Codec::zstd || (codec >= Codec::rows && codec <= Codec::parents);
}

/// The stream lies in the file where it says, and follows the one before.
Status checkStream(const Directory& d, size_t index, uint64_t end) {
    const StreamRecord& s = d.streams[index];
    if (!isKnown(s.codec)) return unsupported("stream has a codec that this version does not know; update xgc", index);
    if (s.offset != alignUp(end) || s.offset > d.page->storedBytes || s.storedBytes > d.page->storedBytes - s.offset)
        return corrupt("stream with a wrong offset or size", index);
    if (s.rawBytes > kMostBytes || s.rawBytes != uint64_t(s.count) * s.stride ||
        (s.codec == Codec::none && s.storedBytes != s.rawBytes))
        return corrupt("stream with another size than its elements", index);
    return {};
}

/// Bytes that the stream's codec unpacks beside the image.
uint64_t workBytes(const Directory& d, const StreamRecord& s) {
    switch (s.codec) {
    case Codec::faces:
        return facesWorkBytes(s, storedOf(d, s), s.kind == StreamKind::cornerWide ? d.wideSlots : d.narrowSlots);
    case Codec::rows:
    case Codec::parents:
        return s.rawBytes;
    case Codec::none:
    case Codec::zstd:
    case Codec::meshopt:
        break;
    }
    return 0;
}

Status measureStreams(Directory& d) {
    uint64_t stored = 0, raw = 0;
    for (size_t i = 0; i < d.streams.size(); ++i) {
        if (Status s = checkStream(d, i, stored); !s.ok()) return s;
        const StreamRecord& s = d.streams[i];
        stored = s.offset + s.storedBytes;
        raw = alignUp(raw) + s.rawBytes;
        if (raw > kMostBytes) return corrupt("the file decodes to more than 1 TiB");
        if (s.kind == StreamKind::position) d.rowCount = s.count;
        if (s.kind == StreamKind::parentNarrow) d.narrowSlots = s.count;
        if (s.kind == StreamKind::parentWide) d.wideSlots = s.count;
        d.isCompressed |= s.codec != Codec::none;
    }
    d.pageBytes = alignUp(raw);
    if (alignUp(stored) != d.page->storedBytes) return corrupt("the page does not end behind its last stream");
    if (d.pageBytes != d.page->rawBytes) return corrupt("the page has another size than its streams");
    // A patch of narrow slots has at most 65,536 of them.
    d.workBytes = sizeof(uint32_t) * std::max<uint64_t>(std::min<uint64_t>(d.narrowSlots, 65536), d.wideSlots);
    for (size_t i = 0; i < d.streams.size(); ++i) {
        d.workBytes = std::max(d.workBytes, workBytes(d, d.streams[i]));
        if (d.workBytes > kMostBytes) return corrupt("stream that unpacks to more than 1 TiB", i);
    }
    d.workBytes += kSlack;
    return {};
}

/// Everything but the contents of sections and streams. `file` holds the whole file.
Status readDirectory(std::span<const std::byte> file, Directory& d) {
    if (Status s = checkContainer(file); !s.ok()) return s;
    d.file = file;
    d.sections = sectionsOf(file);
    std::span<const PageRecord> pages;
    if (Status s = findTable(d, SectionId::pages, pages); !s.ok()) return s;
    if (Status s = findTable(d, SectionId::streams, d.streams); !s.ok()) return s;
    const FileHeader& header = *reinterpret_cast<const FileHeader*>(file.data());
    if (pages.size() != 1) return unsupported("the file has several pages, which this version does not read");
    d.page = pages.data();
    if (d.page->codec != Codec::none)
        return unsupported("the page has a codec of its own, which this version does not read; update xgc");
    if (d.page->offset != header.tableBytes || d.page->offset + d.page->storedBytes != header.fileBytes)
        return corrupt("the page does not fill the file behind the tables");
    if (file.size() < header.fileBytes)
        return {StatusCode::truncated, "the file ends within its page; copy it again", file.size()};
    if (Status s = measureSections(d); !s.ok()) return s;
    return measureStreams(d);
}

uint64_t imageBytes(const Directory& d) {
    return d.tableBytes + d.pageBytes;
}

uint64_t scratchBytes(const Directory& d) {
    return sizeof(uint32_t) * (d.rowCount + d.narrowSlots + d.wideSlots) + d.workBytes;
}

// --- The image ------------------------------------------------------------------------------------------------------

template <typename T>
void put(std::span<std::byte> out, uint64_t offset, const T& value) {
    std::memcpy(out.data() + offset, &value, sizeof value);
}

void putZeros(std::span<std::byte> out, uint64_t from, uint64_t to) {
    std::memset(out.data() + from, 0, to - from);
}

/// Sections, decoded, but for the records of the page and its streams, which follow when they are known.
Status decodeSections(const Directory& d, Inflater& inflater, std::span<std::byte> image) {
    uint64_t at = sizeof(FileHeader), end = at + d.sections.size_bytes();
    for (const SectionRecord& stored : d.sections) {
        SectionRecord s = stored;
        s.codec = Codec::none;
        s.offset = alignUp(end);
        s.storedBytes = s.rawBytes;
        putZeros(image, end, s.offset);
        end = s.offset + s.rawBytes;
        const std::span<std::byte> out = image.subspan(s.offset, s.rawBytes);
        if (stored.codec == Codec::none)
            std::memcpy(out.data(), storedOf(d, stored).data(), out.size());
        else if (!inflater.inflate(storedOf(d, stored), out))
            return corrupt("section (by id) does not decode", uint64_t(s.id));
        put(image, at, s);
        at += sizeof s;
    }
    putZeros(image, end, d.tableBytes);
    return {};
}

SectionRecord* findSection(std::span<std::byte> image, size_t count, SectionId id) {
    auto* records = reinterpret_cast<SectionRecord*>(image.data() + sizeof(FileHeader));
    return std::find_if(records, records + count, [id](const SectionRecord& s) { return s.id == id; });
}

/// Stream and page records of the image. The page's checksum is still that of nothing.
void placeStreams(const Directory& d, std::span<std::byte> image) {
    uint64_t at = findSection(image, d.sections.size(), SectionId::streams)->offset, end = 0;
    for (const StreamRecord& stored : d.streams) {
        StreamRecord s = stored;
        s.codec = Codec::none;
        s.offset = alignUp(end);
        s.storedBytes = s.rawBytes;
        putZeros(image, d.tableBytes + end, d.tableBytes + s.offset);
        end = s.offset + s.rawBytes;
        put(image, at, s);
        at += sizeof s;
    }
    putZeros(image, d.tableBytes + end, imageBytes(d));
    PageRecord page = *d.page;
    page.offset = d.tableBytes;
    page.storedBytes = page.rawBytes;
    page.checksum = 0;
    put(image, findSection(image, d.sections.size(), SectionId::pages)->offset, page);
}

/// Checksums of the sections and the header; `pageChecksum` goes into the page's record first.
void seal(const Directory& d, std::span<std::byte> image, uint64_t pageChecksum) {
    const size_t count = d.sections.size();
    put(image, findSection(image, count, SectionId::pages)->offset + offsetof(PageRecord, checksum), pageChecksum);
    auto* records = reinterpret_cast<SectionRecord*>(image.data() + sizeof(FileHeader));
    for (size_t i = 0; i < count; ++i) {
        records[i].checksum = xxh64(image.subspan(records[i].offset, records[i].storedBytes));
    }
    FileHeader header = *reinterpret_cast<const FileHeader*>(d.file.data());
    header.fileBytes = imageBytes(d);
    header.tableBytes = d.tableBytes;
    header.headerChecksum = 0;
    put(image, 0, header);
    header.headerChecksum = xxh64(image.first(sizeof header + d.sections.size_bytes()));
    put(image, 0, header);
}

/// Decodes streams in the order in which they need each other: corners, parents, the rest.
class StreamDecoder {
public:
    StreamDecoder(const Directory& directory, const AssetView& view, Inflater& inflater, std::span<std::byte> scratch,
                  std::span<std::byte> image)
        : d_(directory), image_(image), decoding_{view, inflater, {}, {}, {}, {}} {
        auto* words = reinterpret_cast<uint32_t*>(scratch.data());
        decoding_.references = {words, d_.rowCount};
        decoding_.narrowSlots = {words + d_.rowCount, d_.narrowSlots};
        decoding_.wideSlots = {words + d_.rowCount + d_.narrowSlots, d_.wideSlots};
        const uint64_t used = sizeof(uint32_t) * (d_.rowCount + d_.narrowSlots + d_.wideSlots);
        decoding_.work = scratch.subspan(used, d_.workBytes);
    }

    Status decodeAll() {
        for (const auto step :
             {&StreamDecoder::decodeCorners, &StreamDecoder::decodeParents, &StreamDecoder::decodeOther}) {
            for (const StreamRecord& s : d_.streams) {
                if (!(this->*step)(s)) return corrupt("stream does not decode", uint64_t(&s - d_.streams.data()));
            }
        }
        return {};
    }

private:
    std::span<std::byte> bytesOf(const StreamRecord& stream) const {
        uint64_t at = 0;
        for (const StreamRecord& s : d_.streams) {
            at = alignUp(at);
            if (&s == &stream) break;
            at += s.rawBytes;
        }
        return image_.subspan(d_.tableBytes + at, stream.rawBytes);
    }

    template <typename T>
    std::span<T> elementsOf(const StreamRecord& stream) const {
        return {reinterpret_cast<T*>(bytesOf(stream).data()), stream.rawBytes / sizeof(T)};
    }

    bool decodeCorners(const StreamRecord& s) {
        if (s.codec != Codec::faces) return true;
        const std::span<const std::byte> stored = storedOf(d_, s);
        if (s.kind == StreamKind::cornerNarrow && s.stride == 2) {
            hasNarrowSlots_ = decodeFaces<uint16_t>(decoding_, stored, decoding_.narrowSlots, elementsOf<uint16_t>(s));
            return hasNarrowSlots_;
        }
        if (s.kind != StreamKind::cornerWide || s.stride != 4) return false;
        hasWideSlots_ = decodeFaces<uint32_t>(decoding_, stored, decoding_.wideSlots, elementsOf<uint32_t>(s));
        return hasWideSlots_;
    }

    bool decodeParents(const StreamRecord& s) {
        const bool narrow = s.kind == StreamKind::parentNarrow && s.stride == 2;
        const bool wide = s.kind == StreamKind::parentWide && s.stride == 4;
        if (!narrow && !wide) return s.codec != Codec::parents;
        const std::span<const std::byte> stored = storedOf(d_, s);
        if (narrow) narrowParents_ = elementsOf<uint16_t>(s);
        if (wide) wideParents_ = elementsOf<uint32_t>(s);
        if (s.codec != Codec::parents) return decodePlain(s);
        if (narrow)
            return hasNarrowSlots_ &&
                   load::decodeParents<uint16_t>(decoding_, stored, decoding_.narrowSlots, elementsOf<uint16_t>(s));
        return hasWideSlots_ &&
               load::decodeParents<uint32_t>(decoding_, stored, decoding_.wideSlots, elementsOf<uint32_t>(s));
    }

    bool decodeOther(const StreamRecord& s) {
        if (s.codec == Codec::rows) {
            if (!hasReferences_ && !findReferences(decoding_, narrowParents_, wideParents_)) return false;
            hasReferences_ = true;
            return decodeRows(decoding_, s, storedOf(d_, s), bytesOf(s));
        }
        const bool done =
            s.codec == Codec::faces || s.kind == StreamKind::parentNarrow || s.kind == StreamKind::parentWide;
        return done || decodePlain(s);
    }

    bool decodePlain(const StreamRecord& s) {
        const std::span<const std::byte> stored = storedOf(d_, s);
        if (s.codec == Codec::zstd) return decoding_.inflater.inflate(stored, bytesOf(s));
        if (s.codec != Codec::none) return false;
        if (!stored.empty()) std::memcpy(bytesOf(s).data(), stored.data(), stored.size());
        return true;
    }

    const Directory& d_;
    std::span<std::byte> image_;
    Decoding decoding_;
    std::span<const uint16_t> narrowParents_;
    std::span<const uint32_t> wideParents_;
    bool hasNarrowSlots_ = false, hasWideSlots_ = false, hasReferences_ = false;
};

bool isAligned(std::span<const std::byte> bytes, size_t alignment) {
    return reinterpret_cast<uintptr_t>(bytes.data()) % alignment == 0;
}

Status decodeAll(const Directory& d, std::span<std::byte> scratch, std::span<std::byte> image) {
    Inflater inflater;
    if (Status s = decodeSections(d, inflater, image); !s.ok()) return s;
    placeStreams(d, image);
    seal(d, image, 0);
    AssetView tables;
    if (Status s = openTables(image.first(d.tableBytes), tables); !s.ok()) return s;
    if (tables.record->vertexCount != d.rowCount) return corrupt("the page has no position for each vertex row");
    StreamDecoder streams(d, tables, inflater, scratch, image);
    if (Status s = streams.decodeAll(); !s.ok()) return s;
    seal(d, image, xxh64(image.subspan(d.tableBytes)));
    return {};
}

} // namespace

Status decodedSize(std::span<const std::byte> file, DecodedSize& out) {
    if (isCut(file)) return joinedSize(file, out);
    Directory d;
    if (Status s = readDirectory(file, d); !s.ok()) return s;
    out = {imageBytes(d), d.isCompressed ? scratchBytes(d) : 0, d.isCompressed};
    return {};
}

Status decode(std::span<const std::byte> file, std::span<std::byte> scratch, std::span<std::byte> image) {
    if (isCut(file)) return join(file, scratch, image);
    Directory d;
    if (Status s = readDirectory(file, d); !s.ok()) return s;
    if (image.size() < imageBytes(d) || !isAligned(image, kAlignment))
        return {StatusCode::badArgument, "the image's buffer is smaller than decodedSize says, or not aligned to 64",
                imageBytes(d)};
    if (d.isCompressed && (scratch.size() < scratchBytes(d) || !isAligned(scratch, alignof(uint32_t))))
        return {StatusCode::badArgument, "the scratch is smaller than decodedSize says, or not aligned to 4",
                scratchBytes(d)};
    if (xxh64(file.subspan(d.page->offset, d.page->storedBytes)) != d.page->checksum)
        return {StatusCode::badChecksum, "the page was altered; copy the file again"};
    if (!d.isCompressed) {
        std::memcpy(image.data(), file.data(), imageBytes(d));
        return {};
    }
    return decodeAll(d, scratch, image.first(imageBytes(d)));
}

} // namespace xgc
