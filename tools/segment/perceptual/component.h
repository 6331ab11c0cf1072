#pragma once

#include "contours.h"
#include "region_merge.h"

namespace xgc::bake {

/// A component of a mesh, looked at once: all that is needed to cut it into any number of regions.
struct Component {
    std::vector<uint32_t> face; ///< of the mesh, per triangle of the piece; rising, a run of triangles a face
    Cells cells;
    EdgeFeatures features;
    Superfacets superfacets;
    std::vector<float> diameters; ///< per superfacet
    LinesOfSight lines;           ///< per superfacet
    std::vector<Merge> merges;    ///< of the superfacets
    bool wasSplit = false;        ///< its faces, into several triangles

    Pose pose;

    bool wasJoined() const { return cells.graph.size() < face.size(); }
    /// Regions that no merge can join.
    uint32_t islands() const { return superfacets.count() - uint32_t(merges.size()); }
};

/// What a component is segmented with: smaller ones of a mesh need less.
struct Resolution {
    uint32_t leastCells, mostCells, superfacets;
};
/// `share`: of the area of the whole mesh, over 0 to 1.
Resolution resolutionFor(double share);

/// `share` likewise.
Component analyseComponent(Piece piece, double share);

/// The superfacets merged down to `count` regions, their contours smoothed: about as many.
CellRegions cutInto(const Component& component, uint32_t count);

/// The same without smoothing: exactly as many where islands and superfacets allow.
CellRegions cutExactly(const Component& component, uint32_t count);

/// Merges of what `regions` are made of: first within each region, then of the regions. `first` is what they start
/// from.
std::vector<Merge> mergesOf(const Component& component, const CellRegions& regions, FirstRegions& first);

} // namespace xgc::bake
