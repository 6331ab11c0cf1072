#include "hierarchy/first_domains.h"

#include <algorithm>
#include <map>

namespace xgc::bake {

void assignFirstDomains(const Mesh& mesh, Hierarchy& h) {
    std::vector<std::pair<uint32_t, uint32_t>> incidences; // position, patch
    incidences.reserve(3 * mesh.faces.size());
    std::vector<uint32_t> only(mesh.positions.size(), kNone); // the first patch seen
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            uint32_t& first = only[corners[k]];
            if (first == kNone) first = h.facePatch[f];
            if (first != h.facePatch[f]) incidences.emplace_back(corners[k], h.facePatch[f]);
        }
    }
    std::sort(incidences.begin(), incidences.end());
    incidences.erase(std::unique(incidences.begin(), incidences.end()), incidences.end());
    std::map<std::vector<uint32_t>, uint32_t> known;
    std::vector<uint32_t> domainOfPatch(h.patches.size(), kNone);
    const auto intern = [&](const std::vector<uint32_t>& patches) {
        const auto [entry, isNew] = known.try_emplace(patches, uint32_t(h.domainPatches.size()));
        if (isNew) h.domainPatches.push_back(patches);
        return entry->second;
    };
    size_t next = 0;
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
        const uint32_t first = only[p] == kNone ? 0 : only[p]; // no face: any will do
        if (next == incidences.size() || incidences[next].first != p) {
            uint32_t& domain = domainOfPatch[first];
            if (domain == kNone) domain = intern({first});
            h.domain[p] = domain;
            continue;
        }
        std::vector<uint32_t> patches{first};
        for (; next < incidences.size() && incidences[next].first == p; ++next)
            patches.push_back(incidences[next].second);
        std::sort(patches.begin(), patches.end());
        h.domain[p] = intern(patches);
    }
}

} // namespace xgc::bake
