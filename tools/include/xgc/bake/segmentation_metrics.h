#pragma once

#include <xgc/bake/mesh.h>

#include <optional>
#include <span>
#include <vector>

namespace xgc::bake {

/// How far two labelings of a surface are apart, by the metrics of the Princeton segmentation benchmark (Chen,
/// Golovinskiy, Funkhouser: A Benchmark for 3D Mesh Segmentation, 2009, section 4), each as the benchmark's own
/// evaluator computes it. 0: alike; lower is better; all are symmetric.
///
///     const MetricSurface surface = prepareSurface(mesh, topology);
///     const MetricLabels a = prepareLabels(surface, labelsA), b = prepareLabels(surface, labelsB);
///     const SegmentationErrors errors = compareLabels(surface, a, b);
///
/// Labels belong to the input's faces, as in a `.seg` file: a polygon's triangles count as one face, and faces that
/// welding dropped count as faces without area. Preparing a labeling costs one Dijkstra's run over the mesh, comparing
/// two a pass over the faces. Nothing here is parallel; all of it may be called from several threads.
struct SegmentationErrors {
    /// Pairs of faces on which the labelings disagree, over (F - 1) / 2 * F with an integer division, as the evaluator
    /// has it. 0 where that is 0 (F < 3).
    double randIndex = 0;
    /// Mean distance of each one's cut vertices to the other's cut, over the average radius. Nothing where one of them
    /// has no cut. Distances are along edges of the welded mesh; straight ones where no path leads to the cut.
    std::optional<double> cutDiscrepancy;
    /// Mean of both directions of: area of each segment outside that segment of the other with which it shares most.
    double hamming = 0;
    /// Consistency errors, which forgive a refinement. Over faces: the share of a face's segment that is outside its
    /// segment in the other labeling; the smaller of both directions' means (global), the mean of the smaller (local).
    /// 0 where one of the labelings has a single segment.
    double globalConsistency = 0;
    double localConsistency = 0;
};

/// What the metrics need of a surface. Positions are those of the welded mesh.
struct MetricSurface {
    std::vector<double> faceArea; ///< per input face
    double area = 0;
    double averageRadius = 0; ///< area-weighted mean distance of face centroids from the centroid of the surface

    /// An edge and its first two faces (input); edges of one face cut nothing.
    struct Joint {
        glm::uvec2 positions;
        glm::uvec2 faces;
    };
    std::vector<Joint> joints;

    struct Neighbor {
        uint32_t position;
        double length;
    };
    std::vector<uint32_t> neighborOffsets; ///< per position, one more
    std::vector<Neighbor> neighbors;
    std::vector<glm::vec3> positions;

    uint32_t faceCount() const { return uint32_t(faceArea.size()); }
};

/// A labeling of a surface, ready to be compared.
struct MetricLabels {
    std::vector<uint32_t> faceSegment;    ///< dense, by first use
    std::vector<uint32_t> segmentOffsets; ///< per segment, one more; into segmentFaces
    std::vector<uint32_t> segmentFaces;   ///< rising per segment
    std::vector<double> segmentArea;
    std::vector<uint32_t> cut;       ///< positions on an edge whose faces differ, rising
    std::vector<double> cutDistance; ///< per position; infinite where no path leads to the cut

    uint32_t segmentCount() const { return uint32_t(segmentArea.size()); }
};

MetricSurface prepareSurface(const Mesh& mesh, const Topology& topology);

/// `labels`: any ids, one an input face.
MetricLabels prepareLabels(const MetricSurface& surface, std::span<const uint32_t> labels);

/// Both of this surface.
SegmentationErrors compareLabels(const MetricSurface& surface, const MetricLabels& a, const MetricLabels& b);

} // namespace xgc::bake
