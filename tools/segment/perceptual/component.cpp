#include "component.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace xgc::bake {

Resolution resolutionFor(double share) {
    const double s = std::sqrt(share);
    return {uint32_t(std::max(500.0, 6000 * s)), uint32_t(std::max(2000.0, 24000 * s)),
            share > 0.5 ? 450u : uint32_t(std::max(40.0, 450 * s))};
}

Component analyseComponent(Piece piece, double share) {
    const Resolution resolution = resolutionFor(share);
    Component component;
    if (piece.triangleCount() < resolution.leastCells) {
        component.wasSplit = true;
        piece = splitLongEdges(piece, resolution.leastCells);
    }
    component.cells = makeCells(piece, resolution.mostCells);
    component.face = std::move(piece.face);
    component.pose = piece.pose;
    const CellGraph& graph = component.cells.graph;
    component.features = findEdgeFeatures(graph);
    component.superfacets = growSuperfacets(graph, component.features, resolution.superfacets);
    const RayScene scene(component.cells.soup);
    const std::vector<glm::vec3>& normals =
        component.features.isNoisy() ? component.features.filteredNormals : graph.normals;
    component.diameters = shapeDiameters(graph, component.superfacets, normals, scene, component.cells.skin);
    component.lines = findLinesOfSight(graph, component.superfacets, normals, component.diameters, scene);
    component.cells.soup = {};
    component.merges = mergeRegions(graph, component.features, firstRegions(component.superfacets), component.diameters,
                                    component.lines);
    return component;
}

CellRegions cutExactly(const Component& component, uint32_t count) {
    const std::vector<uint32_t> region = regionsAt(component.merges, component.superfacets.count(), count);
    CellRegions regions;
    regions.ofCell.reserve(component.superfacets.ofCell.size());
    for (const uint32_t s : component.superfacets.ofCell) regions.ofCell.push_back(region[s]);
    regions.count = 1 + *std::max_element(region.begin(), region.end());
    return regions;
}

CellRegions cutInto(const Component& component, uint32_t count) {
    CellRegions regions = cutExactly(component, count);
    smoothContours(component.cells.graph, component.features, {}, regions);
    return regions;
}

std::vector<Merge> mergesOf(const Component& component, const CellRegions& regions, FirstRegions& first) {
    first = {};
    std::unordered_map<uint64_t, uint32_t> numbers; // looked up, never iterated
    for (uint32_t c = 0; c < regions.ofCell.size(); ++c) {
        const uint32_t superfacet = component.superfacets.ofCell[c], region = regions.ofCell[c];
        const auto [at, isNew] = numbers.try_emplace(uint64_t(superfacet) << 32 | region, first.count());
        if (isNew) {
            first.superfacet.push_back(superfacet);
            first.group.push_back(region);
        }
        first.ofCell.push_back(at->second);
    }
    return mergeRegions(component.cells.graph, component.features, first, component.diameters, component.lines);
}

} // namespace xgc::bake
