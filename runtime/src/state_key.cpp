#include "state_key.h"

#include "rows.h"

#include <cstring>

namespace xgc {
namespace {

std::byte* put(std::byte* at, uint32_t value) {
    std::memcpy(at, &value, sizeof value);
    return at + sizeof value;
}

} // namespace

uint32_t canonicalLevel(const AssetView& asset, format::VertexRange range, uint32_t level) {
    // Nothing has collapsed at level 0. Else the first dead row is the one that collapsed last.
    const uint32_t alive = level == 0 ? range.count : aliveCount(asset, range, level);
    return alive == range.count ? 0 : asset.collapseLevels[size_t(range.first) + alive];
}

size_t writePatchKey(uint32_t assetId, const AssetView& asset, uint32_t patch, Levels levels, std::byte* key) {
    std::byte* at = put(put(key, assetId), patch);
    if (asset.residence) at = put(at, asset.residence->stamps[patch]);
    const std::span<const uint32_t> domains = asset.domainsOf(patch);
    if (levels[patch] == 0) { // and so are its domains
        std::memset(at, 0, 1 + domains.size());
        return size_t(at - key) + 1 + domains.size();
    }
    *at++ = std::byte(canonicalLevel(asset, asset.interiorRange(patch), levels[patch]));
    for (const uint32_t domain : domains) {
        *at++ = std::byte(canonicalLevel(asset, asset.domainRange(domain), domainLevel(asset, domain, levels)));
    }
    return size_t(at - key);
}

size_t writeWholeKey(uint32_t assetId, uint32_t material, uint32_t level, std::byte* key) {
    std::byte* at = put(put(put(key, assetId), format::kNone), material);
    *at++ = std::byte(level);
    return size_t(at - key);
}

} // namespace xgc
