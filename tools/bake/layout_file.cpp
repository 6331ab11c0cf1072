#include "bake/layout.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

namespace xgc::bake::layout {
namespace {

using namespace format;

uint64_t alignUp(uint64_t offset) {
    return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

void put(std::vector<std::byte>& out, uint64_t offset, std::span<const std::byte> bytes) {
    if (!bytes.empty()) std::memcpy(out.data() + offset, bytes.data(), bytes.size());
}

template <typename T>
std::span<const std::byte> bytesOf(const T& value) {
    return std::as_bytes(std::span(&value, 1));
}

} // namespace

uint64_t hash(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), 0);
}

void FileBuilder::addSection(SectionId id, std::span<const std::byte> bytes, uint32_t count, uint32_t stride) {
    if (bytes.empty()) return;
    const SectionRecord record = {id, Codec::none, 0, bytes.size(), bytes.size(), hash(bytes), count, stride};
    sections_.push_back({record, {bytes.begin(), bytes.end()}});
}

void FileBuilder::addStream(StreamKind kind, StreamFormat format, uint32_t set, std::span<const std::byte> bytes,
                            uint32_t count, uint32_t stride) {
    if (bytes.empty()) return;
    const StreamRecord record = {kind, format, set, Codec::none, 0, bytes.size(), bytes.size(), 0, count, stride, {}};
    streams_.push_back({record, {bytes.begin(), bytes.end()}});
}

void FileBuilder::codedSection(const SectionRecord& record, Codec codec, std::span<const std::byte> stored) {
    SectionRecord r = record;
    r.codec = codec;
    r.storedBytes = stored.size();
    r.checksum = hash(stored);
    sections_.push_back({r, {stored.begin(), stored.end()}});
}

void FileBuilder::codedStream(const StreamRecord& record, Codec codec, std::span<const std::byte> stored) {
    StreamRecord r = record;
    r.codec = codec;
    r.storedBytes = stored.size();
    streams_.push_back({r, {stored.begin(), stored.end()}});
}

void FileBuilder::finish(uint32_t levelCount, std::vector<std::byte>& out) {
    std::sort(streams_.begin(), streams_.end(), [](const Stream& a, const Stream& b) {
        return std::pair(a.record.kind, a.record.set) < std::pair(b.record.kind, b.record.set);
    });
    uint64_t pageBytes = 0, rawBytes = 0;
    std::vector<StreamRecord> streamTable;
    for (Stream& s : streams_) {
        s.record.offset = pageBytes;
        pageBytes = alignUp(pageBytes + s.record.storedBytes);
        rawBytes = alignUp(rawBytes + s.record.rawBytes);
        streamTable.push_back(s.record);
    }
    // The page table is a section itself: its place must be known before its contents.
    PageRecord page = {};
    page.lastLevel = levelCount - 1;
    page.storedBytes = pageBytes;
    page.rawBytes = rawBytes;
    page.streamCount = uint32_t(streamTable.size());
    section<PageRecord>(SectionId::pages, std::span(&page, 1));
    section<StreamRecord>(SectionId::streams, streamTable);
    std::sort(sections_.begin(), sections_.end(),
              [](const Section& a, const Section& b) { return a.record.id < b.record.id; });

    const uint64_t directoryEnd = sizeof(FileHeader) + sections_.size() * sizeof(SectionRecord);
    uint64_t end = directoryEnd;
    for (Section& s : sections_) {
        s.record.offset = alignUp(end);
        end = s.record.offset + s.record.storedBytes;
    }
    FileHeader header = {};
    std::copy(kMagic.begin(), kMagic.end(), header.magic);
    header.version = kVersion;
    header.sectionCount = uint32_t(sections_.size());
    header.tableBytes = alignUp(end);
    header.fileBytes = header.tableBytes + pageBytes;

    out.assign(header.fileBytes, std::byte(0));
    page.offset = header.tableBytes;
    for (const Stream& s : streams_) put(out, page.offset + s.record.offset, s.bytes);
    page.checksum = hash(std::span(out).subspan(page.offset));
    uint64_t at = sizeof header;
    for (Section& s : sections_) {
        if (s.record.id == SectionId::pages) {
            s.bytes.assign(bytesOf(page).begin(), bytesOf(page).end());
            s.record.checksum = hash(s.bytes);
        }
        put(out, s.record.offset, s.bytes);
        put(out, at, bytesOf(s.record));
        at += sizeof(SectionRecord);
    }
    put(out, 0, bytesOf(header));
    header.headerChecksum = hash(std::span(out).first(directoryEnd));
    put(out, 0, bytesOf(header));
}

} // namespace xgc::bake::layout
