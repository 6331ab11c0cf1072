#pragma once

#include <xgc/asset.h>
#include <xgc/bake/mesh.h>
#include <xgc/bake/status.h>

#include <functional>

namespace xgc::bake {

struct VerifyOptions {
    uint32_t states = 100; ///< random states; the uniform state of each level is checked as well
    uint64_t seed = 1;
    uint32_t errorStates = 16;     ///< how many of them (uniform ones first) have their error sampled
    uint32_t errorSamples = 20000; ///< per such state, each way
    uint32_t tightnessSamples = 0; ///< per patch and level, each way, for `errorTightness`; 0: it is not measured
    std::function<void(double)> progress; ///< finished fraction; called under a lock, from any thread
};

/// What `verify` counted, summed over all states.
struct VerifyReport {
    uint32_t states = 0;
    uint64_t faces = 0;         ///< drawn triangles
    uint64_t mismatches = 0;    ///< triangles in which buildIndices differs from the definition of rep(v)
    uint64_t degenerate = 0;    ///< drawn triangles that use a position twice
    uint64_t flips = 0;         ///< triangles turned by more than 90 degrees against their face of level 0
    uint64_t oddEdges = 0;      ///< edges used an odd number of times that are no image of a border of level 0
    uint64_t fourUseEdges = 0;  ///< edges used four times or more, evenly: harmless to drawing
    uint64_t miscounted = 0;    ///< patches that draw more triangles than the asset's counts say
    uint64_t fallingErrors = 0; ///< patches and levels where E falls
    uint64_t errorSamples = 0;
    uint64_t errorViolations = 0; ///< samples farther from the other surface than promised
    double worstErrorRatio = 0;   ///< largest sampled deviation over its promise
    /// E over the largest sampled deviation, median over the patches and levels that deviate; 0 where not measured
    double errorTightness = 0;
    uint64_t sourceMismatches = 0; ///< triangles of level 0 and of the source that the other one lacks

    /// Every promise held. One error sample in 10,000 may lie beyond the promise, by 5 % at most.
    bool ok() const;
};

/// Checks the promises of an opened asset over uniform and random states, by a code path of its own: the tables are
/// expanded and rep(v) is followed as it is defined, edges are counted over exact positions, and distances come from
/// Embree. The promise for a sample is 1.05 times the largest E of its patch and of the adjacent ones, each at
/// its own level. Parallel over states (TBB); the counts do not depend on the threads.
void verifyAsset(const AssetView& asset, const VerifyOptions& options, VerifyReport& report);

/// Counts the triangles of level 0 that are not in the source mesh, and the other way round, by exact positions.
void verifySource(const AssetView& asset, const Mesh& source, VerifyReport& report);

} // namespace xgc::bake
