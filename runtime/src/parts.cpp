#include <xgc/parts.h>

#include <algorithm>
#include <cassert>

namespace xgc {

uint32_t mergedParts(const AssetView& asset, uint32_t wanted, std::span<uint32_t> groupOfPart) {
    const auto partCount = uint32_t(asset.parts.size());
    assert(wanted > 0 && groupOfPart.size() == partCount);
    const auto mergeCount = uint32_t(asset.merges.size());
    const uint32_t taken = wanted < partCount ? std::min(partCount - wanted, mergeCount) : 0;
    uint32_t groups = 0;
    for (uint32_t part = 0; part < partCount; ++part) {
        // A part joins a lower one, whose group is known.
        const uint32_t merge = taken > 0 ? asset.partShapes[part].joinedBy : format::kNone;
        groupOfPart[part] = merge < taken ? groupOfPart[asset.merges[merge].a] : groups++;
    }
    return groups;
}

uint32_t findPart(const AssetView& asset, uint64_t stableId) {
    for (uint32_t part = 0; part < asset.parts.size(); ++part) {
        if (asset.parts[part].stableId == stableId) return part;
    }
    return format::kNone;
}

uint32_t findPart(const AssetView& asset, std::string_view name) {
    for (uint32_t part = 0; part < asset.parts.size(); ++part) {
        if (asset.text(asset.parts[part].name) == name) return part;
    }
    return format::kNone;
}

} // namespace xgc
