#pragma once

#include "surface.h"

#include <xgc/bake/segment.h>

namespace xgc::bench {

/// A bare mesh and its parts by the perceptual segmentation.
struct PerceptualRun {
    bake::Mesh mesh;
    bake::Topology topology;
    bake::Segmentation parts;
    double seconds = 0; ///< of the processor, all threads: topology and parts
};

/// Welds and segments, with up to `threads` threads (0: as many as there are).
bake::Status segmentOnce(const bake::Model& model, uint32_t threads, PerceptualRun& out);
/// The same of a mesh, which is welded already.
PerceptualRun segmentOnce(bake::Mesh mesh, uint32_t threads);

/// Triangles without attributes.
bake::Model bareModel(const Surface& surface);

/// FNV-1a of labels.
uint64_t hashOf(std::span<const uint32_t> labels);

} // namespace xgc::bench
