#include <xgc/bake/asset_sizes.h>

#include <zstd.h>

#include <algorithm>
#include <cstring>

namespace xgc::bake {
namespace {

using namespace format;

template <typename Record>
std::vector<Record> recordsAt(std::span<const std::byte> bytes, size_t count) {
    std::vector<Record> records(count);
    if (count > 0) std::memcpy(records.data(), bytes.data(), count * sizeof(Record));
    return records;
}

std::vector<StreamRecord> streamsOf(std::span<const std::byte> file, const SectionRecord& section) {
    std::span<const std::byte> stored = file.subspan(section.offset, section.storedBytes);
    std::vector<std::byte> raw;
    if (section.codec == Codec::zstd) {
        raw.resize(section.rawBytes);
        if (ZSTD_isError(ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size()))) return {};
        stored = raw;
    }
    return recordsAt<StreamRecord>(stored, section.count);
}

} // namespace

AssetSizes sizesOf(std::span<const std::byte> file) {
    const FileHeader header = recordsAt<FileHeader>(file, 1).front();
    AssetSizes sizes;
    std::vector<StreamRecord> streams;
    for (const SectionRecord& s : recordsAt<SectionRecord>(file.subspan(sizeof header), header.sectionCount)) {
        sizes.sections.push_back({sectionName(s.id), 0, s.rawBytes, s.storedBytes});
        if (s.id == SectionId::streams) streams = streamsOf(file, s);
    }
    std::stable_sort(streams.begin(), streams.end(), [](const StreamRecord& a, const StreamRecord& b) {
        return a.kind != b.kind ? a.kind < b.kind : a.set < b.set;
    });
    const StreamRecord* last = nullptr;
    for (const StreamRecord& s : streams) {
        if (!last || s.kind != last->kind || s.set != last->set)
            sizes.streams.push_back({streamName(s.kind), s.set, 0, 0});
        sizes.streams.back().rawBytes += s.rawBytes;
        sizes.streams.back().storedBytes += s.storedBytes;
        last = &s;
    }
    return sizes;
}

const char* streamName(StreamKind kind) {
    switch (kind) {
    case StreamKind::position:
        return "position";
    case StreamKind::normal:
        return "normal";
    case StreamKind::tangent:
        return "tangent";
    case StreamKind::uv:
        return "uv";
    case StreamKind::color:
        return "color";
    case StreamKind::joints:
        return "joints";
    case StreamKind::weights:
        return "weights";
    case StreamKind::collapseLevel:
        return "collapseLevel";
    case StreamKind::birthLevel:
        return "birthLevel";
    case StreamKind::parentNarrow:
        return "parentNarrow";
    case StreamKind::parentWide:
        return "parentWide";
    case StreamKind::cornerNarrow:
        return "cornerNarrow";
    case StreamKind::cornerWide:
        return "cornerWide";
    }
    return "unknown";
}

const char* sectionName(SectionId id) {
    switch (id) {
    case SectionId::asset:
        return "asset";
    case SectionId::levels:
        return "levels";
    case SectionId::domains:
        return "domains";
    case SectionId::domainPatches:
        return "domainPatches";
    case SectionId::vertexRanges:
        return "vertexRanges";
    case SectionId::patches:
        return "patches";
    case SectionId::patchDomains:
        return "patchDomains";
    case SectionId::patchErrors:
        return "patchErrors";
    case SectionId::faceLists:
        return "faceLists";
    case SectionId::parts:
        return "parts";
    case SectionId::partNeighbours:
        return "partNeighbours";
    case SectionId::materials:
        return "materials";
    case SectionId::nodes:
        return "nodes";
    case SectionId::strings:
        return "strings";
    case SectionId::pages:
        return "pages";
    case SectionId::streams:
        return "streams";
    case SectionId::patchSlots:
        return "patchSlots";
    case SectionId::mergeTree:
        return "mergeTree";
    case SectionId::contours:
        return "contours";
    case SectionId::morphTargets:
        return "morphTargets";
    case SectionId::skins:
        return "skins";
    case SectionId::locks:
        return "locks";
    case SectionId::provenance:
        return "provenance";
    case SectionId::partShapes:
        return "partShapes";
    case SectionId::patchFaceCounts:
        return "patchFaceCounts";
    case SectionId::patchPages:
        return "patchPages";
    case SectionId::alphaCutoffs:
        return "alphaCutoffs";
    case SectionId::patchJoints:
        return "patchJoints";
    case SectionId::skinErrors:
        return "skinErrors";
    case SectionId::morphRows:
        return "morphRows";
    case SectionId::morphDeltas:
        return "morphDeltas";
    case SectionId::morphReach:
        return "morphReach";
    case SectionId::morphErrors:
        return "morphErrors";
    }
    return "unknown";
}

} // namespace xgc::bake
