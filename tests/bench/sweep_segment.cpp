#include "segment_sections.h"

/// The perceptual segmentation on meshes of every kind, on changed ones, and with any number of threads. Without
/// arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    return runSections(
        argc, argv,
        {{"generality", sweepGenerality}, {"stability", sweepStability}, {"determinism", sweepDeterminism}});
}
