#pragma once

#include <xgc/bake/segment.h>

#include <memory>

namespace xgc::bake {

struct PerceptualOptions {
    /// Parts wanted; 0: as many as the shape asks for. Fewer than there are separate pieces cannot be had, nor more
    /// than some hundred a piece.
    uint32_t partsCount = 0;
    /// Where partsCount is 0: about so many times the parts that the shape asks for. Below 1 parts are unions of those
    /// of 1, above 1 they lie inside them.
    float detail = 1;
};

/// What was seen of a component on the way to its parts.
struct PerceptualTrace {
    uint32_t faces = 0;
    uint32_t cells = 0; ///< what it was segmented in: its faces, or fewer or more where there are very many or few
    uint32_t superfacets = 0;
    float noise = 0;              ///< median step between the unit normals of neighbouring cells
    bool noisy = false;           ///< it was smoothed more for that
    uint32_t naturalCount = 0;    ///< parts that its shape asks for, before contours are smoothed
    std::vector<float> lastCosts; ///< of its dearest merges, the last first: at most 32
};

/// The parts that people see in a mesh: regions between concave contours, told apart by how thick they are and by what
/// is in sight of each other inside (minima rule: Hoffman and Richards 1984; shape diameter: Shapira, Shamir, Cohen-Or
/// 2008; lines of sight: Asafi, Goren, Cohen-Or 2013). One set of constants for every kind of object, no training.
///
/// Any mesh: open, non-manifold, inconsistently wound, of many components. A component of .2 % of the area or more has
/// parts of its own; smaller ones go with what they touch or lie nearest to. The same parts on any machine and with any
/// number of threads.
class PerceptualSegmenter {
public:
    /// Looks at the mesh once; both must outlive this.
    PerceptualSegmenter(const Mesh& mesh, const Topology& topology);
    ~PerceptualSegmenter();
    PerceptualSegmenter(const PerceptualSegmenter&) = delete;
    PerceptualSegmenter& operator=(const PerceptualSegmenter&) = delete;

    /// Parts "part-0" and on, or by the node or material that holds one of them alone.
    Segmentation parts(const PerceptualOptions& options) const;
    /// How parts of any origin would join, one by one, cheapest first: neighbours only, so as many parts are left as
    /// there are separate pieces.
    std::vector<PartMerge> merges(const Segmentation& parts) const;
    /// Of each component that has parts of its own, by lowest face.
    std::vector<PerceptualTrace> trace() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// What a run did, as JSON: documented in tools/README.md. `input` names the model.
std::string perceptualReportJson(const std::string& input, const Mesh& mesh, const PerceptualOptions& options,
                                 std::span<const PerceptualTrace> trace, const Segmentation& parts);

inline Segmentation segmentPerceptual(const Mesh& mesh, const Topology& topology, const PerceptualOptions& options) {
    return PerceptualSegmenter(mesh, topology).parts(options);
}

} // namespace xgc::bake
