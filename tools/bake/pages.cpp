#include "bake/compress.h"
#include "bake/layout.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/pages.h>
#include <xgc/load.h>
#include <xgc/pages.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

// The tables of a file in pages are those of the image, but for its page and stream records, the count of tiers and
// the page of each patch and tier: what a page holds is told by running sums over them (xgc/pages.h). So cutting is a
// matter of choosing the patches of each page, and copying runs of the image's streams.
//
// Patches of a page should be neighbours, since what a view wants finer it wants finer in one place: patches are
// ordered along a Morton curve and cut into runs, tier by tier, each as long as a page allows: readers give each page
// the memory of the largest.

namespace xgc::bake {
namespace {

using namespace format;

/// Bits of x, two zeros behind each.
uint64_t spread(uint32_t x) {
    uint64_t out = 0;
    for (uint32_t bit = 0; bit < 16; ++bit) out |= uint64_t(x >> bit & 1) << (3 * bit);
    return out;
}

std::vector<uint32_t> mortonOrder(const AssetView& asset) {
    std::vector<uint64_t> codes;
    const float *low = asset.record->boundsMin, *high = asset.record->boundsMax;
    for (const PatchRecord& patch : asset.patches) {
        uint64_t code = 0;
        for (int k = 0; k < 3; ++k) {
            const float extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
            const float t = extent > 0 ? (patch.sphereCenter[k] - low[k]) / extent : 0.0f;
            code |= spread(uint32_t(std::clamp(t, 0.0f, 1.0f) * 65535.0f)) << k;
        }
        codes.push_back(code);
    }
    std::vector<uint32_t> order(codes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::pair(codes[a], a) < std::pair(codes[b], b); });
    return order;
}

/// The finest level of each tier: from there on all rows of finer tiers have collapsed.
std::vector<uint32_t> tierLevels(const AssetView& image) {
    const uint32_t tierCount = std::max(1u, image.record->laidOutTiers);
    std::vector<uint32_t> levels(tierCount, 0);
    for (uint32_t range = 0; range < image.vertexRanges.size(); ++range) {
        const uint32_t tier = range < image.domains.size() ? image.domains[range].tier : tierCount - 1;
        if (tier == 0 || image.vertexRanges[range].count == 0) continue;
        const uint8_t level = image.collapseLevels[image.vertexRanges[range].first];
        for (uint32_t t = 0; t < tier; ++t) levels[t] = std::max<uint32_t>(levels[t], level);
    }
    return levels;
}

class Cutter {
public:
    Cutter(const AssetView& image, const PageOptions& options)
        : image_(image), options_(options), levels_(tierLevels(image)), tierCount_(uint32_t(levels_.size())) {
        record_ = *image.record;
        record_.tierCount = tierCount_;
        cut_ = image;
        cut_.record = &record_;
        for (uint32_t t = 0; t < tierCount_; ++t) cut_.tierLevels[t] = uint8_t(levels_[t]);
    }
    Cutter(const Cutter&) = delete;
    Cutter& operator=(const Cutter&) = delete;

    uint32_t tierCount() const { return tierCount_; }

    std::vector<std::byte> cut() {
        choosePages();
        layout::FileBuilder file;
        for (uint32_t page = 0; page < pages_.size(); ++page) addPage(page, file);
        addSections(file);
        std::vector<std::byte> bytes;
        file.finish(record_.levelCount, bytes);
        return bytes;
    }

private:
    /// Bytes that a patch brings to a page of the tier.
    std::vector<uint64_t> costs(uint32_t tier) {
        // As if each patch had a page of its own.
        std::vector<uint32_t> own(size_t(record_.patchCount) * tierCount_);
        std::iota(own.begin(), own.end(), 0u);
        std::vector<PageRecord> records(own.size());
        map(own, records);
        uint64_t rowBytes = 0;
        for (const StreamRecord& s : image_.streams) rowBytes += s.kind < StreamKind::parentNarrow ? s.stride : 0;
        std::vector<uint64_t> costs;
        for (uint32_t p = 0; p < record_.patchCount; ++p) {
            const PageContents& c = contents_[size_t(p) * tierCount_ + tier];
            costs.push_back(c.rows * rowBytes + 2 * c.narrowSlots + 4 * c.wideSlots + 6 * c.narrowFaces +
                            12 * c.wideFaces);
        }
        return costs;
    }

    void map(std::vector<uint32_t>& patchPages, std::span<const PageRecord> records) {
        cut_.pages = records;
        cut_.patchPages = patchPages;
        contents_.assign(records.size(), {});
        rangePages_.assign(image_.vertexRanges.size(), 0);
        rangeRows_.assign(image_.vertexRanges.size(), 0);
        patchTiers_.assign(patchPages.size(), {});
        mapPages(cut_, {contents_, rangePages_, rangeRows_, patchTiers_});
    }

    void choosePages() {
        const std::vector<uint32_t> order = mortonOrder(image_);
        std::vector<uint32_t> patchPages(size_t(record_.patchCount) * tierCount_);
        for (uint32_t tier = 0; tier < tierCount_; ++tier) {
            const std::vector<uint64_t> cost = costs(tier);
            uint64_t used = 0;
            uint32_t groups = 0;
            for (const uint32_t p : order) {
                if (groups == 0 || used + cost[p] > options_.pageBytes) {
                    pages_.push_back({});
                    pages_.back().tier = tier;
                    pages_.back().group = groups++;
                    used = 0;
                }
                used += cost[p];
                patchPages[size_t(p) * tierCount_ + tier] = uint32_t(pages_.size()) - 1;
            }
            record_.pageGroupCount = std::max(record_.pageGroupCount, groups);
        }
        patchPages_ = std::move(patchPages);
        map(patchPages_, pages_);
        findMembers();
    }

    void findMembers() {
        pageRanges_.assign(pages_.size(), {});
        pagePatches_.assign(pages_.size(), {});
        for (uint32_t range = 0; range < rangePages_.size(); ++range) pageRanges_[rangePages_[range]].push_back(range);
        for (uint32_t p = 0; p < record_.patchCount; ++p) {
            for (uint32_t t = 0; t < tierCount_; ++t) {
                pagePatches_[patchPages_[size_t(p) * tierCount_ + t]].push_back(p);
            }
        }
    }

    std::span<const std::byte> bytesOf(const StreamRecord& s) const {
        return image_.bytes.subspan(image_.pages[0].offset + s.offset, s.storedBytes);
    }

    void addPage(uint32_t page, layout::FileBuilder& file) const {
        const uint32_t tier = pages_[page].tier;
        file.beginPage(tier, pages_[page].group, levels_[tier], tier ? levels_[tier - 1] - 1 : record_.levelCount - 1);
        for (const StreamRecord& s : image_.streams) {
            compress::Bytes bytes;
            if (s.kind < StreamKind::parentNarrow) {
                appendRows(page, s, bytes);
            } else if (s.kind == StreamKind::parentNarrow || s.kind == StreamKind::parentWide) {
                appendParents(page, s, bytes);
            } else if (s.kind == StreamKind::cornerNarrow || s.kind == StreamKind::cornerWide) {
                appendCorners(page, s, bytes);
            }
            if (!bytes.empty()) addStream(s, std::move(bytes), file);
        }
    }

    void addStream(const StreamRecord& of, compress::Bytes&& bytes, layout::FileBuilder& file) const {
        StreamRecord record = of;
        record.count = uint32_t(bytes.size() / of.stride);
        record.rawBytes = bytes.size();
        compress::Bytes coded;
        if (options_.compress) coded = compress::deflate(bytes, options_.zstdLevel);
        if (coded.empty() || coded.size() >= bytes.size()) return file.codedStream(record, Codec::none, bytes);
        file.codedStream(record, Codec::zstd, coded);
    }

    void appendRows(uint32_t page, const StreamRecord& s, compress::Bytes& out) const {
        for (const uint32_t range : pageRanges_[page]) {
            const VertexRange rows = image_.vertexRanges[range];
            compress::append(out, bytesOf(s).subspan(size_t(rows.first) * s.stride, size_t(rows.count) * s.stride));
        }
    }

    bool has(uint32_t patch, bool wide) const { return bool(image_.patches[patch].flags & kWideSlots) == wide; }

    const PatchTier& tierOf(uint32_t patch, uint32_t page) const {
        return patchTiers_[size_t(patch) * tierCount_ + pages_[page].tier];
    }

    void appendParents(uint32_t page, const StreamRecord& s, compress::Bytes& out) const {
        for (const uint32_t p : pagePatches_[page]) {
            if (!has(p, s.kind == StreamKind::parentWide)) continue;
            const PatchTier& tier = tierOf(p, page);
            const size_t first = image_.patches[p].firstParent + size_t(tier.firstSlot);
            compress::append(out, bytesOf(s).subspan(first * s.stride, size_t(tier.slotCount) * s.stride));
        }
    }

    void appendCorners(uint32_t page, const StreamRecord& s, compress::Bytes& out) const {
        for (const uint32_t p : pagePatches_[page]) {
            if (!has(p, s.kind == StreamKind::cornerWide)) continue;
            const PatchTier& tier = tierOf(p, page);
            size_t first = image_.patches[p].firstCorner;
            for (uint32_t i = 0; i < tier.firstList; ++i) first += 3 * size_t(image_.listsOf(p)[i].faceCount);
            compress::append(out, bytesOf(s).subspan(first * s.stride, 3 * size_t(tier.faceCount) * s.stride));
        }
    }

    /// Those of the image, but for what tells of pages.
    void addSections(layout::FileBuilder& file) const {
        const auto* header = reinterpret_cast<const FileHeader*>(image_.bytes.data());
        for (const SectionRecord& s :
             std::span(reinterpret_cast<const SectionRecord*>(header + 1), header->sectionCount)) {
            if (s.id == SectionId::pages || s.id == SectionId::streams) continue; // the builder's
            const std::span<const std::byte> bytes = image_.bytes.subspan(s.offset, s.storedBytes);
            const bool isRecord = s.id == SectionId::asset;
            file.codedSection(s, Codec::none, isRecord ? std::as_bytes(std::span(&record_, 1)) : bytes);
        }
        file.section<uint32_t>(SectionId::patchPages, patchPages_);
    }

    const AssetView& image_;
    const PageOptions& options_;
    const std::vector<uint32_t> levels_;
    const uint32_t tierCount_;
    AssetRecord record_{};
    AssetView cut_; ///< tables alone
    std::vector<PageRecord> pages_;
    std::vector<uint32_t> patchPages_;
    std::vector<PageContents> contents_;
    std::vector<uint32_t> rangePages_, rangeRows_;
    std::vector<PatchTier> patchTiers_;
    std::vector<std::vector<uint32_t>> pageRanges_, pagePatches_;
};

/// No file is handed out whose pages do not join to the image again.
Status checkJoins(std::span<const std::byte> image, std::span<const std::byte> bytes) {
    AlignedBytes joined;
    if (Status s = decodeImage(alignedCopy(bytes), joined); !s.ok())
        return {Outcome::promiseBroken, fmt::format("pages: they do not join: {}", s.message)};
    if (std::ranges::equal(joined.span(), image)) return {};
    return {Outcome::promiseBroken, "pages: they join to another image"};
}

} // namespace

Status cutIntoPages(std::span<const std::byte> image, const PageOptions& options, std::vector<std::byte>& out) {
    if (options.tiers == 0 || options.tiers > kMaxTiers || options.pageBytes == 0)
        return badInput(fmt::format("pages: 1 to {} tiers, and pages of at least one byte", kMaxTiers));
    const AlignedBytes copy = alignedCopy(image);
    AssetView asset;
    if (const xgc::Status s = openAll(copy.span(), asset); !s.ok())
        return badInput(fmt::format("pages: {} (element {})", s.message, s.element));
    for (const DomainRecord& d : asset.domains) {
        if (d.tier >= std::clamp(asset.record->laidOutTiers, 1u, kMaxTiers))
            return badInput("pages: a domain of no tier");
    }
    Cutter cutter(asset, options);
    if (cutter.tierCount() == 1) {
        out.assign(image.begin(), image.end());
        return {};
    }
    std::vector<std::byte> bytes = cutter.cut();
    if (Status s = checkJoins(image, bytes); !s.ok()) return s;
    out = std::move(bytes);
    return {};
}

} // namespace xgc::bake
