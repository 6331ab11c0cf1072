#include "merge.h"

#include <algorithm>
#include <numeric>
#include <queue>

/// Every region keeps a list of (neighbour, length) that is allowed to be stale: merging appends the shorter list to
/// the longer and renames nothing. Only when a region is the smallest is its list brought up to date: neighbours are
/// looked up in a union-find forest, equal ones added up. So an entry moves O(log n) times.
namespace xgc::bake {

namespace {

struct Neighbour {
    uint32_t region;
    double length;
};

struct Candidate {
    double area;
    uint32_t lowest; ///< lowest original region in it: its number in the result
    uint32_t root;
    /// For a heap whose top is the smallest.
    bool operator<(const Candidate& o) const { return area != o.area ? area > o.area : lowest > o.lowest; }
};

class Merger {
public:
    Merger(const Mesh& mesh, const Topology& topology, const Regions& regions, std::vector<double> areas)
        : areas_(std::move(areas)), parent_(regions.count), lowest_(regions.count), neighbours_(regions.count) {
        std::iota(parent_.begin(), parent_.end(), 0u);
        std::iota(lowest_.begin(), lowest_.end(), 0u);
        for (uint32_t e = 0; e < topology.edges.size(); ++e) addEdge(mesh, topology, regions, e);
    }

    void mergeDownTo(uint32_t wanted) {
        std::priority_queue<Candidate> smallest;
        for (uint32_t r = 0; r < parent_.size(); ++r) smallest.push({areas_[r], r, r});
        auto left = uint32_t(parent_.size());
        while (left > wanted && !smallest.empty()) {
            const Candidate c = smallest.top();
            smallest.pop();
            const bool stale = parent_[c.root] != c.root || lowest_[c.root] != c.lowest || areas_[c.root] != c.area;
            if (stale) continue;
            const uint32_t into = longestNeighbour(c.root);
            if (into == kNone) continue; // an island
            const uint32_t root = unite(c.root, into);
            smallest.push({areas_[root], lowest_[root], root});
            --left;
        }
    }

    uint32_t result(uint32_t region) { return lowest_[find(region)]; }

private:
    /// Neighbours along an edge of any number of faces: those that follow one another in its list.
    void addEdge(const Mesh& mesh, const Topology& topology, const Regions& regions, uint32_t e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        const glm::uvec2 ends = topology.edges[e];
        for (size_t i = 0; i + 1 < faces.size(); ++i) {
            const uint32_t a = regions.ofFace[faces[i]], b = regions.ofFace[faces[i + 1]];
            if (a == b) continue;
            const double length = glm::length(glm::dvec3(mesh.positions[ends.x]) - glm::dvec3(mesh.positions[ends.y]));
            neighbours_[a].push_back({b, length});
            neighbours_[b].push_back({a, length});
        }
    }

    uint32_t find(uint32_t r) {
        while (parent_[r] != r) {
            parent_[r] = parent_[parent_[r]];
            r = parent_[r];
        }
        return r;
    }

    void bringUpToDate(uint32_t root) {
        std::vector<Neighbour>& list = neighbours_[root];
        for (Neighbour& n : list) n.region = find(n.region);
        std::erase_if(list, [&](const Neighbour& n) { return n.region == root; });
        std::sort(list.begin(), list.end(), [](const Neighbour& a, const Neighbour& b) { // lengths too: one sum only
            return a.region != b.region ? a.region < b.region : a.length < b.length;
        });
        size_t kept = 0;
        for (size_t i = 0; i < list.size(); ++i) {
            if (kept > 0 && list[kept - 1].region == list[i].region) {
                list[kept - 1].length += list[i].length;
            } else {
                list[kept++] = list[i];
            }
        }
        list.resize(kept);
    }

    uint32_t longestNeighbour(uint32_t root) {
        bringUpToDate(root);
        uint32_t best = kNone;
        double longest = 0;
        for (const Neighbour& n : neighbours_[root]) {
            const bool better =
                best == kNone || n.length > longest || (n.length == longest && lowest_[n.region] < lowest_[best]);
            if (!better) continue;
            best = n.region;
            longest = n.length;
        }
        return best;
    }

    uint32_t unite(uint32_t a, uint32_t b) {
        if (neighbours_[a].size() > neighbours_[b].size()) std::swap(a, b);
        neighbours_[b].insert(neighbours_[b].end(), neighbours_[a].begin(), neighbours_[a].end());
        neighbours_[a] = {};
        parent_[a] = b;
        lowest_[b] = std::min(lowest_[a], lowest_[b]);
        areas_[b] += areas_[a];
        return b;
    }

    std::vector<double> areas_;
    std::vector<uint32_t> parent_;
    std::vector<uint32_t> lowest_;
    std::vector<std::vector<Neighbour>> neighbours_;
};

} // namespace

std::vector<uint32_t> mergeRegions(const Mesh& mesh, const Topology& topology, const Regions& regions,
                                   std::vector<double> areas, uint32_t wanted) {
    Merger merger(mesh, topology, regions, std::move(areas));
    merger.mergeDownTo(wanted);
    std::vector<uint32_t> labels;
    labels.reserve(regions.ofFace.size());
    for (const uint32_t r : regions.ofFace) labels.push_back(merger.result(r));
    return labels;
}

} // namespace xgc::bake
