#include "segment_stages.h"

#include "process_memory.h"

#include <segment/part_order.h>
#include <segment/perceptual/component.h>
#include <segment/perceptual/how_many.h>

#include <ctime>
#include <numeric>

namespace xgc::bench {
namespace {

class Stopwatch {
public:
    /// Does the next stage.
    template <class Work>
    auto stage(const Work& work) {
        resetPeak();
        const std::clock_t start = std::clock();
        auto result = work();
        costs_[next_++] = {double(std::clock() - start) / CLOCKS_PER_SEC, peakBytes()};
        return result;
    }
    const StageCosts& costs() const { return costs_; }

private:
    StageCosts costs_;
    size_t next_ = 0;
};

std::span<const uint32_t> largestComponent(const bake::LinkedFaces& linked) {
    std::span<const uint32_t> largest;
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        const uint32_t begin = linked.componentOffsets[c], count = linked.componentOffsets[c + 1] - begin;
        if (count > largest.size()) largest = std::span(linked.componentFaces).subspan(begin, count);
    }
    return largest;
}

bake::Piece extract(const bake::Mesh& mesh, const bake::LinkedFaces& linked, double& share) {
    const std::vector<double> areas = bake::faceAreas(mesh);
    const std::span<const uint32_t> faces = largestComponent(linked);
    double area = 0;
    for (const uint32_t f : faces) area += areas[f];
    share = area / std::accumulate(areas.begin(), areas.end(), 0.0);
    bake::PieceScratch scratch = {std::vector<uint32_t>(mesh.positions.size(), bake::kNone),
                                  std::vector<uint32_t>(mesh.faces.size(), bake::kNone)};
    return bake::extractPiece(mesh, linked, faces, areas, area, scratch);
}

} // namespace

StageCosts segmentInStages(const bake::Mesh& mesh) {
    Stopwatch watch;
    double share = 0;
    bake::Component c;
    const bake::Topology topology = watch.stage([&] { return bake::buildTopology(mesh); });
    const bake::LinkedFaces linked = watch.stage([&] { return bake::linkFaces(mesh, topology); });
    bake::Piece piece = watch.stage([&] { return extract(mesh, linked, share); });
    const bake::Resolution resolution = bake::resolutionFor(share);
    c.cells = watch.stage([&] { return bake::makeCells(piece, resolution.mostCells); });
    const bake::CellGraph& graph = c.cells.graph;
    c.features = watch.stage([&] { return bake::findEdgeFeatures(graph); });
    c.superfacets = watch.stage([&] { return bake::growSuperfacets(graph, c.features, resolution.superfacets); });
    const bake::RayScene scene = watch.stage([&] { return bake::RayScene(c.cells.soup); });
    const std::vector<glm::vec3>& normals = c.features.isNoisy() ? c.features.filteredNormals : graph.normals;
    c.diameters = watch.stage([&] { return bake::shapeDiameters(graph, c.superfacets, normals, scene, c.cells.skin); });
    c.lines = watch.stage([&] { return bake::findLinesOfSight(graph, c.superfacets, normals, c.diameters, scene); });
    c.merges = watch.stage(
        [&] { return bake::mergeRegions(graph, c.features, bake::firstRegions(c.superfacets), c.diameters, c.lines); });
    watch.stage([&] { return bake::cutInto(c, bake::naturalCount(c.merges, c.islands())); });
    return watch.costs();
}

} // namespace xgc::bench
