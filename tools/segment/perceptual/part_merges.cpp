#include "part_merges.h"
#include "disjoint_sets.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// The part that holds most of each cell. Of cells that parts share, some parts may hold none.
CellRegions regionsOf(const Component& component, const Segmentation& parts) {
    const std::vector<uint32_t>& cell = component.cells.ofTriangle;
    CellRegions regions = {std::vector<uint32_t>(component.cells.graph.size(), kNone), parts.partCount()};
    std::vector<std::pair<uint32_t, uint32_t>> members; // cell, part
    members.reserve(cell.size());
    for (size_t t = 0; t < cell.size(); ++t) members.emplace_back(cell[t], parts.facePart[component.face[t]]);
    std::sort(members.begin(), members.end());
    for (size_t i = 0, j = 0; i < members.size();) {
        uint32_t most = 0;
        const uint32_t c = members[i].first;
        for (; i < members.size() && members[i].first == c; i = j) {
            while (j < members.size() && members[j] == members[i]) ++j;
            if (uint32_t(j - i) <= most) continue;
            most = uint32_t(j - i);
            regions.ofCell[c] = members[i].second;
        }
    }
    return regions;
}

/// Joins the parts that p and q are in by now, if they are two.
void joinParts(uint32_t p, uint32_t q, double cost, DisjointSets& joined, std::vector<PartMerge>& merges) {
    p = joined.find(p);
    q = joined.find(q);
    if (joined.join(p, q)) merges.push_back({std::min(p, q), std::max(p, q), float(cost)});
}

/// Per part: the one it shares most border with, or kNone.
std::vector<uint32_t> closestNeighbours(const Mesh& mesh, const Topology& topology, const Segmentation& parts) {
    struct Border {
        uint32_t part, other;
        double length;
    };
    std::vector<Border> borders;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        for (size_t i = 1; i < faces.size(); ++i) {
            const uint32_t p = parts.facePart[faces[0]], q = parts.facePart[faces[i]];
            if (p == q) continue;
            const double length =
                double(glm::distance(mesh.positions[topology.edges[e].x], mesh.positions[topology.edges[e].y]));
            borders.push_back({p, q, length});
            borders.push_back({q, p, length});
        }
    }
    std::stable_sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
        return a.part != b.part ? a.part < b.part : a.other < b.other;
    });
    std::vector<uint32_t> closest(parts.partCount(), kNone);
    std::vector<double> most(parts.partCount(), -1.0);
    for (size_t i = 0, j = 0; i < borders.size(); i = j) {
        double sum = 0;
        for (; j < borders.size() && borders[j].part == borders[i].part && borders[j].other == borders[i].other; ++j)
            sum += borders[j].length;
        if (sum <= most[borders[i].part]) continue;
        most[borders[i].part] = sum;
        closest[borders[i].part] = borders[i].other;
    }
    return closest;
}

} // namespace

std::vector<PartMerge> findPartMerges(const AnalysedMesh& at, const Segmentation& parts) {
    struct Step {
        double dearest; ///< cost of this or an earlier merge of the component
        uint32_t component, order;
        uint32_t p, q;
        double cost;
    };
    std::vector<Step> steps;
    std::vector<uint8_t> hasCells(parts.partCount(), 0);
    for (uint32_t c = 0; c < at.components.size(); ++c) {
        FirstRegions first;
        const CellRegions regions = regionsOf(at.components[c], parts);
        const std::vector<Merge> merges = mergesOf(at.components[c], regions, first);
        for (const uint32_t part : first.group) hasCells[part] = 1;
        double dearest = 0;
        for (uint32_t i = 0; i < merges.size(); ++i) {
            const uint32_t p = first.group[merges[i].a], q = first.group[merges[i].b];
            if (p == q) continue; // within a part
            dearest = std::max(dearest, merges[i].cost);
            steps.push_back({dearest, c, i, p, q, merges[i].cost});
        }
    }
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
        if (a.dearest != b.dearest) return a.dearest < b.dearest;
        return a.component != b.component ? a.component < b.component : a.order < b.order;
    });
    std::vector<PartMerge> merges;
    DisjointSets joined(parts.partCount());
    const std::vector<uint32_t> closest = closestNeighbours(at.mesh, at.topology, parts);
    for (uint32_t p = 0; p < parts.partCount(); ++p) {
        if (!hasCells[p] && closest[p] != kNone) joinParts(p, closest[p], 0, joined, merges);
    }
    for (const Step& step : steps) joinParts(step.p, step.q, step.cost, joined, merges);
    return merges;
}

} // namespace xgc::bake
