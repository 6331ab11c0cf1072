#include "bake/layout.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <tuple>

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
    streams_.push_back({record, {bytes.begin(), bytes.end()}, page()});
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
    streams_.push_back({r, {stored.begin(), stored.end()}, page()});
}

void FileBuilder::beginPage(uint32_t tier, uint32_t group, uint32_t firstLevel, uint32_t lastLevel) {
    PageRecord page = {};
    page.tier = tier;
    page.group = group;
    page.firstLevel = firstLevel;
    page.lastLevel = lastLevel;
    pages_.push_back(page);
}

/// Gives streams their places within their pages, and pages their sizes and streams.
std::vector<StreamRecord> FileBuilder::placeStreams() {
    std::sort(streams_.begin(), streams_.end(), [](const Stream& a, const Stream& b) {
        return std::tuple(a.page, a.record.kind, a.record.set) < std::tuple(b.page, b.record.kind, b.record.set);
    });
    std::vector<StreamRecord> table;
    for (Stream& s : streams_) {
        PageRecord& page = pages_[s.page];
        if (page.streamCount++ == 0) page.firstStream = uint32_t(table.size());
        s.record.offset = page.storedBytes;
        page.storedBytes = alignUp(page.storedBytes + s.record.storedBytes);
        page.rawBytes = alignUp(page.rawBytes + s.record.rawBytes);
        table.push_back(s.record);
    }
    return table;
}

void FileBuilder::finish(uint32_t levelCount, std::vector<std::byte>& out) {
    if (pages_.empty()) beginPage(0, 0, 0, levelCount - 1);
    const std::vector<StreamRecord> streamTable = placeStreams();
    // The page table is a section itself: its place must be known before its contents.
    section<PageRecord>(SectionId::pages, pages_);
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
    header.fileBytes = header.tableBytes;
    for (PageRecord& page : pages_) {
        page.offset = header.fileBytes;
        header.fileBytes += page.storedBytes;
    }
    out.assign(header.fileBytes, std::byte(0));
    for (const Stream& s : streams_) put(out, pages_[s.page].offset + s.record.offset, s.bytes);
    for (PageRecord& page : pages_) page.checksum = hash(std::span(out).subspan(page.offset, page.storedBytes));
    uint64_t at = sizeof header;
    for (Section& s : sections_) {
        if (s.record.id == SectionId::pages) {
            const std::span<const std::byte> pages = std::as_bytes(std::span(pages_));
            s.bytes.assign(pages.begin(), pages.end());
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
