#include "bake/layout.h"

#include <algorithm>
#include <numeric>
#include <tuple>

// Order of domains and of vertex rows. Rows lie in groups (the domains, then the interiors of the patches), each by
// collapse level descending, so that the rows alive at a level are a prefix. Within a group a parent never collapses
// before its child, so only among equal levels parents must be put before children by hand.

namespace xgc::bake::layout {
namespace {

bool widerFirst(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
}

/// Wedges in the order in which the faces touch them, then the parents up from them.
std::vector<uint32_t> firstTouch(const Mesh& mesh, const Hierarchy& h, const Faces& faces) {
    std::vector<uint32_t> rank(h.wedgePosition.size(), kNone);
    std::vector<uint32_t> queue;
    const auto touch = [&](uint32_t wedge) {
        if (wedge == kNone || rank[wedge] != kNone) return;
        rank[wedge] = uint32_t(queue.size());
        queue.push_back(wedge);
    };
    for (const uint32_t f : faces.order) {
        for (int k = 0; k < 3; ++k) touch(mesh.faces[f][k]);
    }
    for (size_t i = 0; i < queue.size(); ++i) touch(h.wedgeParent[queue[i]]);
    return rank;
}

/// Steps up from each wedge to the last parent of the same group and collapse level.
class Depths {
public:
    Depths(const Hierarchy& h, const Domains& domains)
        : h_(h), domains_(domains), depth_(h.wedgePosition.size(), kNone) {}

    uint32_t of(uint32_t wedge) {
        path_.clear();
        while (depth_[wedge] == kNone) {
            path_.push_back(wedge);
            const uint32_t parent = h_.wedgeParent[wedge];
            if (parent == kNone || !alike(wedge, parent)) {
                depth_[wedge] = 0;
                break;
            }
            wedge = parent;
        }
        uint32_t depth = depth_[wedge];
        for (size_t i = path_.size(); i-- > 0;) depth_[path_[i]] = path_[i] == wedge ? depth : ++depth;
        return path_.empty() ? depth : depth_[path_.front()];
    }

private:
    bool alike(uint32_t a, uint32_t b) const {
        const uint32_t p = h_.wedgePosition[a], q = h_.wedgePosition[b];
        return h_.collapseLevel[p] == h_.collapseLevel[q] &&
               domains_.groupOf[h_.domain[p]] == domains_.groupOf[h_.domain[q]];
    }

    const Hierarchy& h_;
    const Domains& domains_;
    std::vector<uint32_t> depth_;
    std::vector<uint32_t> path_;
};

} // namespace

std::vector<uint8_t> usedWedges(const Mesh& mesh, const Hierarchy& h) {
    std::vector<uint8_t> used(h.wedgePosition.size(), 0);
    for (const glm::uvec3& face : mesh.faces) {
        for (int k = 0; k < 3; ++k) {
            for (uint32_t w = face[k]; w != kNone && !used[w]; w = h.wedgeParent[w]) used[w] = 1;
        }
    }
    return used;
}

Domains orderDomains(const Hierarchy& h, const std::vector<uint8_t>& used) {
    std::vector<uint8_t> isUsed(h.domainPatches.size(), 0);
    for (size_t w = 0; w < used.size(); ++w) {
        if (used[w]) isUsed[h.domain[h.wedgePosition[w]]] = 1;
    }
    Domains domains;
    for (size_t d = 0; d < isUsed.size(); ++d) {
        if (isUsed[d] && h.domainPatches[d].size() > 1) domains.sets.push_back(h.domainPatches[d]);
    }
    std::sort(domains.sets.begin(), domains.sets.end(), widerFirst);
    domains.sets.erase(std::unique(domains.sets.begin(), domains.sets.end()), domains.sets.end());

    domains.groupOf.assign(isUsed.size(), kNone);
    for (size_t d = 0; d < isUsed.size(); ++d) {
        if (!isUsed[d]) continue;
        const std::vector<uint32_t>& set = h.domainPatches[d];
        const auto found = std::lower_bound(domains.sets.begin(), domains.sets.end(), set, widerFirst);
        domains.groupOf[d] =
            set.size() > 1 ? uint32_t(found - domains.sets.begin()) : uint32_t(domains.sets.size()) + set.front();
    }
    domains.ofPatch.resize(h.patches.size());
    for (uint32_t d = 0; d < domains.sets.size(); ++d) {
        for (const uint32_t p : domains.sets[d]) domains.ofPatch[p].push_back(d);
    }
    return domains;
}

Rows orderRows(const Mesh& mesh, const Hierarchy& h, const Domains& domains, const Faces& faces) {
    const std::vector<uint32_t> rank = firstTouch(mesh, h, faces);
    Depths depths(h, domains);
    struct Key {
        uint32_t group, level, depth, rank, wedge;
        auto tied() const { return std::tie(group, level, depth, rank); }
    };
    std::vector<Key> keys;
    for (uint32_t w = 0; w < rank.size(); ++w) {
        if (rank[w] == kNone) continue;
        const uint32_t p = h.wedgePosition[w];
        keys.push_back({domains.groupOf[h.domain[p]], 255u - h.collapseLevel[p], depths.of(w), rank[w], w});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.tied() < b.tied(); });

    Rows rows;
    rows.rowOf.assign(rank.size(), kNone);
    rows.ranges.resize(domains.sets.size() + h.patches.size());
    for (const Key& key : keys) {
        rows.rowOf[key.wedge] = uint32_t(rows.wedgeOf.size());
        rows.wedgeOf.push_back(key.wedge);
        ++rows.ranges[key.group].count;
    }
    uint32_t first = 0;
    for (format::VertexRange& range : rows.ranges) {
        range.first = first;
        first += range.count;
    }
    return rows;
}

} // namespace xgc::bake::layout
