#include <xgc/asset.h>
#include <xgc/draw_list.h>
#include <xgc/indices.h>
#include <xgc/select.h>

#include <array>
#include <cstdio>

// Links the runtime core as an application does: a state of two patches, and the level of the border between them.
int main() {
    const std::array<xgc::format::DomainRecord, 1> domains = {{{0, 2}}};
    const std::array<uint32_t, 2> patches = {0, 1};
    const std::array<uint8_t, 2> levels = {3, 1};
    xgc::AssetView asset;
    asset.domains = domains;
    asset.domainPatches = patches;
    const uint32_t level = xgc::domainLevel(asset, 0, levels);
    std::printf("the border stands at level %u\n", level);
    return level == 1 ? 0 : 1;
}
