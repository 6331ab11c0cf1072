#include "join.h"

#include "decode.h"
#include "xxh64.h"

#include <xgc/pages.h>

#include <algorithm>
#include <cstring>

// The tables of a cut file are those of its image, but for the page and stream records. So joining is: the image's
// directory and sections, then every run of rows, parents and corners to where the tables say that it lies.
//
//   scratch   [ contents of the pages | page and first row of each range | tiers of the patches | decoded pages ]

namespace xgc::load {
namespace {

using namespace format;

constexpr size_t kMostStreams = 64;

/// A stream of the image, of which each page has a piece.
struct Joined {
    StreamRecord record{};
    uint64_t offset = 0; ///< in the image
};

struct Join {
    AssetView view; ///< of the cut file
    std::span<const SectionRecord> sections;
    std::array<Joined, kMostStreams> streams;
    uint32_t streamCount = 0;
    uint64_t tableBytes = 0, imageBytes = 0; ///< of the image
    uint64_t rawBytes = 0;                   ///< of all pages, where one is compressed
    PageMap map;
    std::span<uint64_t> rawOffsets; ///< a page each
    std::span<std::byte> raw;

    uint64_t scratchBytes() const {
        return kAlignment + view.pages.size() * (sizeof(PageContents) + sizeof(uint64_t)) +
               2 * sizeof(uint32_t) * view.vertexRanges.size() + sizeof(PatchTier) * view.patchPages.size() +
               kAlignment + rawBytes;
    }
};

bool isRowStream(StreamKind kind) {
    return kind < StreamKind::parentNarrow;
}

Status listStreams(Join& j) {
    for (size_t i = 0; i < j.view.streams.size(); ++i) {
        const StreamRecord& s = j.view.streams[i];
        const auto end = j.streams.begin() + j.streamCount;
        auto at = std::find_if(j.streams.begin(), end, [&](const Joined& joined) {
            return joined.record.kind == s.kind && joined.record.set == s.set;
        });
        if (at == end) {
            if (j.streamCount == kMostStreams) return unsupported("stream past the 64 that an image may have", i);
            ++j.streamCount;
            at->record = s;
            at->record.codec = Codec::none;
            at->record.count = 0;
        }
        StreamRecord& sum = at->record;
        if (sum.format != s.format || sum.stride != s.stride)
            return corrupt("stream that changes from page to page", i);
        if (uint64_t(sum.count) + s.count > UINT32_MAX) return corrupt("pages with too many elements", i);
        sum.count += s.count;
    }
    const auto end = j.streams.begin() + j.streamCount;
    std::sort(j.streams.begin(), end, [](const Joined& a, const Joined& b) {
        return a.record.kind != b.record.kind ? a.record.kind < b.record.kind : a.record.set < b.record.set;
    });
    for (auto at = j.streams.begin(); at != end; ++at) {
        if (isRowStream(at->record.kind) && at->record.count != j.view.record->vertexCount)
            return corrupt("stream (by kind) that some page lacks", uint64_t(at->record.kind));
    }
    return {};
}

/// As the section lies in the image: those that this version does not know as they are.
uint64_t storedBytesOf(const Join& j, const SectionRecord& s) {
    if (s.id == SectionId::pages) return sizeof(PageRecord);
    if (s.id == SectionId::streams) return j.streamCount * sizeof(StreamRecord);
    return s.storedBytes;
}

void measure(Join& j) {
    uint64_t end = sizeof(FileHeader) + (j.sections.size() - 1) * sizeof(SectionRecord);
    for (const SectionRecord& s : j.sections) {
        if (s.id != SectionId::patchPages) end = alignUp(end) + storedBytesOf(j, s);
    }
    j.tableBytes = alignUp(end);
    uint64_t page = 0;
    for (uint32_t i = 0; i < j.streamCount; ++i) {
        StreamRecord& s = j.streams[i].record;
        s.rawBytes = s.storedBytes = uint64_t(s.count) * s.stride;
        s.offset = page;
        j.streams[i].offset = j.tableBytes + page;
        page = alignUp(page + s.rawBytes);
    }
    j.imageBytes = j.tableBytes + page;
    const bool coded = std::any_of(j.view.streams.begin(), j.view.streams.end(),
                                   [](const StreamRecord& s) { return s.codec != Codec::none; });
    for (const PageRecord& p : j.view.pages) j.rawBytes += coded ? p.rawBytes : 0;
}

Status readDirectory(std::span<const std::byte> file, Join& j) {
    if (Status s = openTables(file, j.view); !s.ok()) return s;
    j.sections = sectionsOf(file);
    const auto* header = reinterpret_cast<const FileHeader*>(file.data());
    if (file.size() < header->fileBytes)
        return {StatusCode::truncated, "the file ends within its pages; copy it again", file.size()};
    constexpr uint64_t kMostBytes = uint64_t(1) << 40;
    uint64_t raw = 0;
    for (const PageRecord& page : j.view.pages) {
        if (page.rawBytes > kMostBytes || (raw += page.rawBytes) > kMostBytes)
            return corrupt("the file decodes to more than 1 TiB");
    }
    if (Status s = listStreams(j); !s.ok()) return s;
    measure(j);
    return {};
}

// --- Pages ----------------------------------------------------------------------------------------------------------

template <typename T>
std::span<T> take(std::span<std::byte>& scratch, size_t count) {
    const std::span<T> out(reinterpret_cast<T*>(scratch.data()), count);
    scratch = scratch.subspan(count * sizeof(T));
    return out;
}

std::span<std::byte> aligned(std::span<std::byte> bytes) {
    const size_t past = reinterpret_cast<uintptr_t>(bytes.data()) % kAlignment;
    return bytes.subspan(past ? kAlignment - past : 0);
}

/// The piece of a stream that a page has.
std::span<const std::byte> pieceOf(const Join& j, uint32_t page, const StreamRecord& stream) {
    const PageRecord& record = j.view.pages[page];
    const std::byte* bytes = j.rawBytes ? j.raw.data() + j.rawOffsets[page] : j.view.bytes.data() + record.offset;
    uint64_t at = 0;
    for (const StreamRecord& s : j.view.streams.subspan(record.firstStream, record.streamCount)) {
        at = alignUp(at);
        if (s.kind == stream.kind && s.set == stream.set) return {bytes + at, s.rawBytes};
        at += s.rawBytes;
    }
    return {};
}

void copy(std::span<const std::byte> from, std::span<std::byte> to) {
    if (!from.empty()) std::memcpy(to.data(), from.data(), from.size());
}

class Joiner {
public:
    Joiner(const Join& j, std::span<std::byte> image) : j_(j), image_(image) {}

    void joinStream(const Joined& stream) {
        const StreamKind kind = stream.record.kind;
        if (isRowStream(kind)) return joinRows(stream);
        const bool wide = kind == StreamKind::parentWide || kind == StreamKind::cornerWide;
        const bool parents = kind == StreamKind::parentNarrow || kind == StreamKind::parentWide;
        if (!parents && kind != StreamKind::cornerNarrow && kind != StreamKind::cornerWide) return; // a later version's
        for (uint32_t p = 0; p < j_.view.patchCount(); ++p) {
            if (isWide(j_.view.patches[p]) != wide) continue;
            for (uint32_t t = 0; t < j_.view.tierCount(); ++t) {
                const PatchTier& tier = j_.map.patchTiers[size_t(p) * j_.view.tierCount() + t];
                parents ? joinParents(p, tier, stream) : joinCorners(p, tier, stream);
            }
        }
    }

private:
    void joinRows(const Joined& stream) {
        const size_t stride = stream.record.stride;
        for (size_t r = 0; r < j_.view.vertexRanges.size(); ++r) {
            const VertexRange rows = j_.view.vertexRanges[r];
            if (rows.count == 0) continue;
            copy(pieceOf(j_, j_.map.rangePages[r], stream.record)
                     .subspan(j_.map.rangeRows[r] * stride, rows.count * stride),
                 image_.subspan(stream.offset + rows.first * stride));
        }
    }

    void joinParents(uint32_t p, const PatchTier& t, const Joined& stream) {
        if (t.slotCount == 0) return;
        const size_t stride = stream.record.stride, first = j_.view.patches[p].firstParent + size_t(t.firstSlot);
        copy(pieceOf(j_, t.page, stream.record).subspan(t.firstParent * stride, t.slotCount * stride),
             image_.subspan(stream.offset + first * stride));
    }

    void joinCorners(uint32_t p, const PatchTier& t, const Joined& stream) {
        if (t.faceCount == 0) return;
        const size_t stride = stream.record.stride;
        size_t first = j_.view.patches[p].firstCorner;
        for (uint32_t i = 0; i < t.firstList; ++i) first += 3 * size_t(j_.view.listsOf(p)[i].faceCount);
        copy(pieceOf(j_, t.page, stream.record)
                 .subspan(3 * size_t(t.firstFace) * stride, 3 * size_t(t.faceCount) * stride),
             image_.subspan(stream.offset + first * stride));
    }

    const Join& j_;
    std::span<std::byte> image_;
};

Status decodePages(const Join& j) {
    uint64_t at = 0;
    for (uint32_t page = 0; page < j.view.pages.size(); ++page) {
        const PageRecord& record = j.view.pages[page];
        const std::span<const std::byte> stored = j.view.bytes.subspan(record.offset, record.storedBytes);
        if (j.rawBytes == 0) {
            if (xxh64(stored) != record.checksum)
                return {StatusCode::badChecksum, "page was altered; copy the file again", page};
            continue;
        }
        j.rawOffsets[page] = at;
        if (Status s = decodePage(j.view, page, stored, j.raw.subspan(at, record.rawBytes)); !s.ok()) return s;
        at += record.rawBytes;
    }
    return {};
}

// --- The image ------------------------------------------------------------------------------------------------------

template <typename T>
void putAt(std::span<std::byte> out, uint64_t offset, const T& value) {
    std::memcpy(out.data() + offset, &value, sizeof value);
}

void putSection(const Join& j, const SectionRecord& s, std::span<std::byte> out) {
    if (s.id == SectionId::streams) {
        for (uint32_t i = 0; i < j.streamCount; ++i) putAt(out, i * sizeof(StreamRecord), j.streams[i].record);
        return;
    }
    if (s.id != SectionId::pages) std::memcpy(out.data(), j.view.bytes.data() + s.offset, out.size());
    if (s.id != SectionId::asset) return;
    AssetRecord record = *j.view.record;
    record.tierCount = record.pageGroupCount = 1;
    putAt(out, 0, record);
}

PageRecord onePage(const Join& j, std::span<const std::byte> image) {
    PageRecord page = {};
    page.lastLevel = j.view.levelCount() - 1;
    page.offset = j.tableBytes;
    page.storedBytes = page.rawBytes = j.imageBytes - j.tableBytes;
    page.checksum = xxh64(image.subspan(j.tableBytes, page.rawBytes));
    page.streamCount = j.streamCount;
    return page;
}

/// Everything but the page, which lies in the image already.
void putTables(const Join& j, std::span<std::byte> image) {
    uint64_t at = sizeof(FileHeader), end = at + (j.sections.size() - 1) * sizeof(SectionRecord);
    const uint64_t directoryEnd = end;
    for (const SectionRecord& cut : j.sections) {
        if (cut.id == SectionId::patchPages) continue;
        SectionRecord s = cut;
        s.offset = alignUp(end);
        s.storedBytes = storedBytesOf(j, cut);
        if (s.id == SectionId::pages || s.id == SectionId::streams) {
            s.rawBytes = s.storedBytes;
            s.count = uint32_t(s.rawBytes / s.stride);
        }
        end = s.offset + s.storedBytes;
        const std::span<std::byte> out = image.subspan(s.offset, s.storedBytes);
        putSection(j, cut, out);
        if (s.id == SectionId::pages) putAt(out, 0, onePage(j, image));
        s.checksum = xxh64(out);
        putAt(image, at, s);
        at += sizeof s;
    }
    FileHeader header = *reinterpret_cast<const FileHeader*>(j.view.bytes.data());
    header.sectionCount = uint32_t(j.sections.size()) - 1;
    header.fileBytes = j.imageBytes;
    header.tableBytes = j.tableBytes;
    header.headerChecksum = 0;
    putAt(image, 0, header);
    header.headerChecksum = xxh64(image.first(directoryEnd));
    putAt(image, 0, header);
}

} // namespace

bool isCut(std::span<const std::byte> file) {
    if (!checkContainer(file).ok()) return false;
    for (const SectionRecord& s : sectionsOf(file)) {
        if (s.id == SectionId::patchPages) return true;
    }
    return false;
}

Status joinedSize(std::span<const std::byte> file, DecodedSize& out) {
    Join j;
    if (Status s = readDirectory(file, j); !s.ok()) return s;
    out = {j.imageBytes, j.scratchBytes(), true};
    return {};
}

Status join(std::span<const std::byte> file, std::span<std::byte> scratch, std::span<std::byte> image) {
    Join j;
    if (Status s = readDirectory(file, j); !s.ok()) return s;
    if (image.size() < j.imageBytes || reinterpret_cast<uintptr_t>(image.data()) % kAlignment != 0)
        return {StatusCode::badArgument, "the image's buffer is smaller than decodedSize says, or not aligned to 64",
                j.imageBytes};
    if (scratch.size() < j.scratchBytes())
        return {StatusCode::badArgument, "the scratch is smaller than decodedSize says", j.scratchBytes()};
    image = image.first(j.imageBytes);
    scratch = aligned(scratch);
    j.map.pages = take<PageContents>(scratch, j.view.pages.size());
    j.rawOffsets = take<uint64_t>(scratch, j.view.pages.size());
    j.map.rangePages = take<uint32_t>(scratch, j.view.vertexRanges.size());
    j.map.rangeRows = take<uint32_t>(scratch, j.view.vertexRanges.size());
    j.map.patchTiers = take<PatchTier>(scratch, j.view.patchPages.size());
    j.raw = aligned(scratch).first(j.rawBytes);
    mapPages(j.view, j.map);
    if (Status s = checkPageContents(j.view, j.map); !s.ok()) return s;
    if (Status s = decodePages(j); !s.ok()) return s;
    std::memset(image.data(), 0, image.size());
    for (uint32_t i = 0; i < j.streamCount; ++i) Joiner(j, image).joinStream(j.streams[i]);
    putTables(j, image);
    return {};
}

} // namespace xgc::load

namespace xgc {

Status decodePage(const AssetView& tables, uint32_t index, std::span<const std::byte> stored,
                  std::span<std::byte> out) {
    using namespace load;
    const format::PageRecord& page = tables.pages[index];
    if (stored.size() != page.storedBytes || out.size() < page.rawBytes)
        return {StatusCode::badArgument, "decodePage: the buffers must have the page's sizes", index};
    if (xxh64(stored) != page.checksum)
        return {StatusCode::badChecksum, "page was altered; copy the file again", index};
    Inflater inflater;
    uint64_t at = 0;
    for (const format::StreamRecord& s : tables.streams.subspan(page.firstStream, page.streamCount)) {
        const std::span<const std::byte> from = stored.subspan(s.offset, s.storedBytes);
        const std::span<std::byte> to = out.subspan(at, s.rawBytes);
        if (s.codec == format::Codec::none) {
            copy(from, to);
        } else if (!inflater.inflate(from, to)) {
            return corrupt("page with a stream that does not decode", index);
        }
        at += s.rawBytes;
        const uint64_t next = alignUp(at);
        std::memset(out.data() + at, 0, next - at);
        at = next;
    }
    return {};
}

} // namespace xgc
