#include "export/writers.h"

#include <algorithm>
#include <map>

namespace xgc::bake::exports {

std::vector<Group> groupTriangles(const Model& model) {
    std::map<std::pair<uint32_t, uint32_t>, size_t> index;
    std::vector<Group> groups;
    for (uint32_t t = 0; t < model.triangles.size(); ++t) {
        const std::pair key(model.triangleNode[t], model.triangleMaterial[t]);
        const auto [it, isNew] = index.emplace(key, groups.size());
        if (isNew) groups.push_back({key.first, key.second, {}});
        groups[it->second].triangles.push_back(t);
    }
    std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
        return std::pair(a.node, a.material) < std::pair(b.node, b.material);
    });
    return groups;
}

UsedRows usedRows(const Model& model, std::span<const uint32_t> triangles) {
    UsedRows used;
    for (const uint32_t t : triangles) {
        for (int k = 0; k < 3; ++k) used.indices.push_back(model.triangles[t][k]);
    }
    used.rows = used.indices;
    std::sort(used.rows.begin(), used.rows.end());
    used.rows.erase(std::unique(used.rows.begin(), used.rows.end()), used.rows.end());
    for (uint32_t& i : used.indices) {
        i = uint32_t(std::lower_bound(used.rows.begin(), used.rows.end(), i) - used.rows.begin());
    }
    return used;
}

} // namespace xgc::bake::exports
