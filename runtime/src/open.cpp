#include "open.h"
#include "xxh64.h"

#include <algorithm>
#include <cstring>

// Opening is a recipe of four steps: the header (is it an asset, is it whole, is it this version), the sections
// (where each array lies, unaltered), the relations between the tables, and for `openAll` the page. A step trusts
// only what the steps before it have proved. Nothing is copied: the view holds spans into the bytes.

namespace xgc {
namespace {

using namespace format;

template <typename T>
const T* at(std::span<const std::byte> bytes, uint64_t offset) {
    return reinterpret_cast<const T*>(bytes.data() + offset);
}

Status checkHeader(std::span<const std::byte> bytes) {
    if (reinterpret_cast<uintptr_t>(bytes.data()) % kAlignment != 0)
        return {StatusCode::badArgument, "the bytes are not aligned to 64; load the file to an aligned address"};
    if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic.data(), sizeof kMagic) != 0)
        return {StatusCode::notAnAsset, "the bytes do not start as an .xgc asset; bake the model with `xgc bake`"};
    if (bytes.size() < sizeof(FileHeader))
        return {StatusCode::truncated, "the file ends within its header; copy it again", bytes.size()};
    const FileHeader& header = *at<FileHeader>(bytes, 0);
    if (header.version != kVersion)
        return {StatusCode::badVersion, "the file has another format version (the element); bake it with this version",
                header.version};
    if (header.tableBytes > bytes.size())
        return {StatusCode::truncated, "the file ends within its tables; copy it again", bytes.size()};
    const uint64_t directoryEnd = sizeof(FileHeader) + uint64_t(header.sectionCount) * sizeof(SectionRecord);
    if (directoryEnd > header.tableBytes || header.tableBytes > header.fileBytes)
        return corrupt("the sizes in the header contradict each other");
    FileHeader unsigned_ = header;
    unsigned_.headerChecksum = 0;
    if (xxh64(std::as_bytes(std::span(&unsigned_, 1)), bytes.subspan(sizeof header, directoryEnd - sizeof header)) !=
        header.headerChecksum)
        return {StatusCode::badChecksum, "the header or the section table was altered; copy the file again"};
    if (header.flags != 0)
        return unsupported("the file sets flags that this version does not know; update xgc", header.flags);
    return {};
}

bool allZero(std::span<const std::byte> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte(0); });
}

/// Sections have rising ids, follow each other at the next multiple of 64 with zeros between, fill the tables and
/// are unaltered: known or not.
Status checkSections(std::span<const std::byte> bytes) {
    const uint64_t tableBytes = at<FileHeader>(bytes, 0)->tableBytes;
    const std::span<const SectionRecord> sections = sectionsOf(bytes);
    uint64_t end = sizeof(FileHeader) + sections.size_bytes();
    for (size_t i = 0; i < sections.size(); ++i) {
        const SectionRecord& s = sections[i];
        const auto id = uint64_t(s.id);
        if (i > 0 && s.id <= sections[i - 1].id) return corrupt("sections (by id) are not in order", id);
        if (s.offset != alignUp(end)) return corrupt("section (by id) does not start behind the one before", id);
        if (s.offset > tableBytes || s.storedBytes > tableBytes - s.offset)
            return corrupt("section (by id) reaches past the tables", id);
        if (!allZero(bytes.subspan(end, s.offset - end)))
            return corrupt("padding before section (by id) is not zero", id);
        end = s.offset + s.storedBytes;
        if (xxh64(bytes.subspan(s.offset, s.storedBytes)) != s.checksum)
            return {StatusCode::badChecksum, "section (by id) was altered; copy the file again", id};
    }
    if (alignUp(end) != tableBytes) return corrupt("the tables do not end behind the last section");
    if (!allZero(bytes.subspan(end, tableBytes - end))) return corrupt("padding behind the last section is not zero");
    return {};
}

/// Finds sections as arrays. The first failure sticks.
class SectionReader {
public:
    explicit SectionReader(std::span<const std::byte> bytes) : bytes_(bytes), sections_(sectionsOf(bytes)) {}

    /// The section as an array; empty where the file has none.
    template <typename T>
    std::span<const T> array(SectionId id) {
        const SectionRecord* s = find(id);
        if (!s || !status_.ok()) return {};
        if (s->codec != Codec::none) {
            status_ = unsupported("section (by id) is compressed; decode the file with xgc::load first", uint64_t(id));
        } else if (s->stride != sizeof(T) || s->rawBytes != s->storedBytes ||
                   s->storedBytes != uint64_t(s->count) * sizeof(T)) {
            status_ = corrupt("section (by id) has another size than its elements", uint64_t(id));
        }
        return status_.ok() ? std::span<const T>(at<T>(bytes_, s->offset), s->count) : std::span<const T>();
    }

    std::string_view text(SectionId id) {
        const std::span<const char> chars = array<char>(id);
        return {chars.data(), chars.size()};
    }

    const Status& status() const { return status_; }

private:
    const SectionRecord* find(SectionId id) const {
        const auto* s = std::lower_bound(sections_.data(), sections_.data() + sections_.size(), id,
                                         [](const SectionRecord& a, SectionId b) { return a.id < b; });
        return s != sections_.data() + sections_.size() && s->id == id ? s : nullptr;
    }

    std::span<const std::byte> bytes_;
    std::span<const SectionRecord> sections_;
    Status status_;
};

Status readSections(AssetView& view) {
    SectionReader reader(view.bytes);
    const std::span<const AssetRecord> record = reader.array<AssetRecord>(SectionId::asset);
    view.levels = reader.array<LevelRecord>(SectionId::levels);
    view.domains = reader.array<DomainRecord>(SectionId::domains);
    view.domainPatches = reader.array<uint32_t>(SectionId::domainPatches);
    view.vertexRanges = reader.array<VertexRange>(SectionId::vertexRanges);
    view.patches = reader.array<PatchRecord>(SectionId::patches);
    view.patchDomains = reader.array<uint32_t>(SectionId::patchDomains);
    view.patchSlots = reader.array<uint32_t>(SectionId::patchSlots);
    view.patchErrors = reader.array<float>(SectionId::patchErrors);
    view.faceLists = reader.array<FaceList>(SectionId::faceLists);
    view.parts = reader.array<PartRecord>(SectionId::parts);
    view.partNeighbours = reader.array<uint32_t>(SectionId::partNeighbours);
    view.materials = reader.array<MaterialRecord>(SectionId::materials);
    view.alphaCutoffs = reader.array<float>(SectionId::alphaCutoffs);
    view.nodes = reader.array<NodeRecord>(SectionId::nodes);
    view.joints = reader.array<JointRecord>(SectionId::skins);
    view.patchJoints = reader.array<PatchJoint>(SectionId::patchJoints);
    view.skinErrors = reader.array<SkinError>(SectionId::skinErrors);
    view.morphTargets = reader.array<MorphTargetRecord>(SectionId::morphTargets);
    view.morphRows = reader.array<uint32_t>(SectionId::morphRows);
    view.morphDeltas = reader.array<MorphDelta>(SectionId::morphDeltas);
    view.morphReach = reader.array<float>(SectionId::morphReach);
    view.morphErrors = reader.array<float>(SectionId::morphErrors);
    view.strings = reader.text(SectionId::strings);
    view.pages = reader.array<PageRecord>(SectionId::pages);
    view.streams = reader.array<StreamRecord>(SectionId::streams);
    view.contours = reader.array<float>(SectionId::contours);
    view.partShapes = reader.array<PartShape>(SectionId::partShapes);
    view.patchFaceCounts = reader.array<uint32_t>(SectionId::patchFaceCounts);
    view.merges = reader.array<MergeRecord>(SectionId::mergeTree);
    view.provenance = reader.text(SectionId::provenance);
    view.patchPages = reader.array<uint32_t>(SectionId::patchPages);
    if (!reader.status().ok()) return reader.status();
    if (record.size() != 1) return corrupt("the file has no asset record", uint64_t(SectionId::asset));
    view.record = record.data();
    return {};
}

Status readTables(std::span<const std::byte> bytes, AssetView& view) {
    if (Status s = checkContainer(bytes); !s.ok()) return s;
    view.bytes = bytes;
    if (Status s = readSections(view); !s.ok()) return s;
    for (const PageRecord& page : view.pages) {
        if (page.tier < kMaxTiers) view.tierLevels[page.tier] = uint8_t(std::min<uint32_t>(page.firstLevel, kNever));
    }
    return checkTables(view);
}

} // namespace

Status checkContainer(std::span<const std::byte> bytes) {
    if (Status s = checkHeader(bytes); !s.ok()) return s;
    return checkSections(bytes);
}

std::span<const SectionRecord> sectionsOf(std::span<const std::byte> bytes) {
    return {at<SectionRecord>(bytes, sizeof(FileHeader)), at<FileHeader>(bytes, 0)->sectionCount};
}

Status openTables(std::span<const std::byte> bytes, AssetView& out) {
    AssetView view;
    if (Status s = readTables(bytes, view); !s.ok()) return s;
    out = view;
    return {};
}

Status openAll(std::span<const std::byte> bytes, AssetView& out) {
    AssetView view;
    if (Status s = readTables(bytes, view); !s.ok()) return s;
    if (view.tierCount() > 1)
        return unsupported("the file is cut into pages: stream it (residency.h), or join them with xgc::decode");
    if (Status s = installPage(view); !s.ok()) return s;
    if (Status s = checkPage(view); !s.ok()) return s;
    out = view;
    return {};
}

} // namespace xgc
