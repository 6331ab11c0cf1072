#include "open.h"

#include <algorithm>

// Files of several tiers: pages lie one behind the other, tier by tier, the coarsest first, and tile the file behind
// the tables. That the streams hold what the tables say of them is found out where a page map is made (pages.h): it
// needs memory.

namespace xgc {
namespace {

using namespace format;

/// Levels of the tiers tile 0..K, and no row or list of a patch lies in a page of another tier.
Status checkTiers(const AssetView& v) {
    for (size_t i = 0; i < v.pages.size(); ++i) {
        const PageRecord& page = v.pages[i];
        const PageRecord* before = i > 0 ? &v.pages[i - 1] : nullptr;
        const bool same = before && before->tier == page.tier;
        if (page.tier != (before ? before->tier + !same : 0) || page.group != (same ? before->group + 1 : 0) ||
            page.group >= v.record->pageGroupCount)
            return corrupt("page out of order", i);
        const uint32_t last = same ? before->lastLevel : before ? before->firstLevel - 1 : v.record->levelCount - 1;
        if (page.lastLevel != last || page.firstLevel > last || (same && page.firstLevel != before->firstLevel) ||
            (before && !same && before->firstLevel == 0))
            return corrupt("page with a wrong range of levels", i);
    }
    if (v.pages.empty() || v.pages.back().tier + 1 != v.tierCount() || v.pages.back().firstLevel != 0)
        return corrupt("the pages do not serve all tiers and levels");
    for (size_t i = 0; i < v.patchPages.size(); ++i) {
        const uint32_t page = v.patchPages[i];
        if (page >= v.pages.size() || v.pages[page].tier != i % v.tierCount())
            return corrupt("patch with a page of another tier", i / v.tierCount());
    }
    return {};
}

/// Domains come tier by tier, and a list begins where each tier does.
Status checkGroups(const AssetView& v) {
    if (v.record->laidOutTiers != v.tierCount()) return corrupt("the asset has other tiers than its rows");
    uint32_t tier = 0;
    for (size_t d = 0; d < v.domains.size(); ++d) {
        if (v.domains[d].tier < tier || v.domains[d].tier >= v.tierCount())
            return corrupt("domain whose tier falls or is out of range", d);
        tier = v.domains[d].tier;
    }
    for (uint32_t p = 0; p < v.patchCount(); ++p) {
        const std::span<const FaceList> lists = v.listsOf(p);
        for (uint32_t t = 0; t + 1 < v.tierCount(); ++t) {
            const auto begins = [&](const FaceList& list) { return list.level == v.tierLevels[t]; };
            if (std::none_of(lists.begin(), lists.end(), begins))
                return corrupt("patch without a face list where a tier begins", p);
        }
    }
    return {};
}

Status checkStreams(const AssetView& v, const PageRecord& page) {
    uint64_t stored = 0, raw = 0;
    const StreamRecord* before = nullptr;
    for (uint32_t i = page.firstStream; i < page.firstStream + page.streamCount; ++i) {
        const StreamRecord& s = v.streams[i];
        if (Status status = checkStreamRecord(s, before, stored, page.storedBytes, i); !status.ok()) return status;
        if (s.rawBytes > page.rawBytes) return corrupt("stream with a wrong offset or size", i);
        stored = s.offset + s.storedBytes;
        raw = alignUp(raw) + s.rawBytes;
        before = &s;
    }
    if (alignUp(stored) != page.storedBytes || alignUp(raw) != page.rawBytes)
        return corrupt("page that does not end behind its last stream", uint64_t(&page - v.pages.data()));
    return {};
}

} // namespace

Status checkPageTables(const AssetView& v) {
    const FileHeader& header = *reinterpret_cast<const FileHeader*>(v.bytes.data());
    uint64_t end = header.tableBytes, stream = 0;
    for (size_t i = 0; i < v.pages.size(); ++i) {
        const PageRecord& page = v.pages[i];
        if (page.codec != Codec::none)
            return unsupported("page has a codec of its own, which this version does not read; update xgc", i);
        if (page.offset != end || page.storedBytes > header.fileBytes - end)
            return corrupt("page with a wrong offset or size", i);
        if (page.firstStream != stream || page.streamCount > v.streams.size() - stream)
            return corrupt("page with a wrong run of streams", i);
        if (Status s = checkStreams(v, page); !s.ok()) return s;
        end += page.storedBytes;
        stream += page.streamCount;
    }
    if (end != header.fileBytes) return corrupt("the pages do not fill the file behind the tables");
    if (stream != v.streams.size()) return corrupt("section streams holds more than the pages do");
    if (Status s = checkTiers(v); !s.ok()) return s;
    return checkGroups(v);
}

} // namespace xgc
