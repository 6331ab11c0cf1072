#include "bake/layout.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

// Order of domains and of vertex rows. Rows lie in groups (the domains, then the interiors of the patches), each by
// collapse level descending, so that the rows alive at a level are a prefix. Within a group a parent never collapses
// before its child, so only among equal levels parents must be put before children by hand.
//
// Domains are small: at a coarse level a few vertices of each are left, and whatever fetches them fetches the dead ones
// behind them too. So the rows of a domain are cut by the levels to which they live, and what lives long in all domains
// lies together:
//
//   one tier      [ a: ##..... | b: #.... | c: ##...... | ... ]                       # : alive at a coarse level
//   two tiers     [ a: ## | b: # | c: ## | ... ]  [ a: ..... | b: .... | c: ...... | ... ]
//
// To a reader each piece is a domain, of the same patches. Files that are cut into pages are cut by their tiers, and so
// are the interiors: the pieces of coarser tiers are domains of one patch.

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
        return h_.collapseLevel[p] == h_.collapseLevel[q] && domains_.groupOf[p] == domains_.groupOf[q];
    }

    const Hierarchy& h_;
    const Domains& domains_;
    std::vector<uint32_t> depth_;
    std::vector<uint32_t> path_;
};

// Tiers ------------------------------------------------------------------------------------------------------------

/// For each position the last level to which it or any vertex that collapses into it lives: a parent's is never below
/// its child's, which collapse levels alone do not promise between domains.
std::vector<uint8_t> lastLevels(const Hierarchy& h, const std::vector<uint8_t>& used) {
    std::vector<uint8_t> last = h.collapseLevel;
    for (uint32_t w = 0; w < used.size(); ++w) {
        const uint8_t level = last[h.wedgePosition[w]];
        for (uint32_t up = used[w] ? h.wedgeParent[w] : kNone; up != kNone; up = h.wedgeParent[up]) {
            uint8_t& upper = last[h.wedgePosition[up]];
            if (upper >= level) break;
            upper = level;
        }
    }
    return last;
}

} // namespace

Tiers findTiers(const Hierarchy& h, const std::vector<uint8_t>& used, uint32_t ratio, uint32_t mostTiers) {
    std::vector<uint8_t> tiers = lastLevels(h, used);
    std::vector<uint32_t> firstLevels = {0};
    std::array<uint32_t, 256> dying{};
    for (uint32_t w = 0; w < used.size(); ++w) dying[tiers[h.wedgePosition[w]]] += used[w];
    uint32_t alive = std::accumulate(dying.begin(), dying.end(), 0u), atCut = alive;
    std::array<uint8_t, 256> tierOf{}; // the finest is 0 here
    uint8_t tier = 0;
    for (uint32_t level = 1; level < dying.size(); ++level) {
        if (alive > 0 && uint64_t(alive) * ratio <= atCut && tier + 1u < mostTiers) {
            ++tier;
            firstLevels.push_back(level - 1); // where only those that live longer are left
            atCut = alive;
        }
        tierOf[level] = tier;
        alive -= dying[level];
    }
    for (uint8_t& t : tiers) t = uint8_t(tier - tierOf[t]);
    std::reverse(firstLevels.begin(), firstLevels.end());
    return {std::move(tiers), std::move(firstLevels)};
}

namespace {

/// The rows of a domain in one tier, in the file's order.
struct TierOfDomain {
    uint8_t tier;
    const std::vector<uint32_t>* patches;

    bool operator<(const TierOfDomain& other) const {
        return tier != other.tier ? tier < other.tier : widerFirst(*patches, *other.patches);
    }
    bool operator==(const TierOfDomain& other) const { return tier == other.tier && *patches == *other.patches; }
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

Domains orderDomains(const Hierarchy& h, const std::vector<uint8_t>& used, const Tiers* pages) {
    const std::vector<uint8_t> tiers = pages ? pages->of : findTiers(h, used, 2, 4).of;
    // What a patch has of its own is its interior; where there are pages, in the last tier alone.
    const auto isShared = [&](uint32_t p) {
        return h.domainPatches[h.domain[p]].size() > 1 || (pages && tiers[p] + 1u < pages->count());
    };
    std::vector<TierOfDomain> all;
    std::vector<uint32_t> positions; // that are used
    std::vector<uint8_t> seen(h.positions.size(), 0);
    for (uint32_t w = 0; w < used.size(); ++w) {
        const uint32_t p = h.wedgePosition[w];
        if (!used[w] || seen[p]++) continue;
        positions.push_back(p);
        if (isShared(p)) all.push_back({tiers[p], &h.domainPatches[h.domain[p]]});
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());

    Domains domains;
    for (const TierOfDomain& d : all) {
        domains.sets.push_back(*d.patches);
        domains.tiers.push_back(pages ? d.tier : 0);
    }
    domains.groupOf.assign(h.positions.size(), kNone);
    for (const uint32_t p : positions) {
        const std::vector<uint32_t>& set = h.domainPatches[h.domain[p]];
        const auto found = std::lower_bound(all.begin(), all.end(), TierOfDomain{tiers[p], &set});
        domains.groupOf[p] = isShared(p) ? uint32_t(found - all.begin()) : uint32_t(all.size()) + set.front();
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
        keys.push_back({domains.groupOf[p], 255u - h.collapseLevel[p], depths.of(w), rank[w], w});
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
