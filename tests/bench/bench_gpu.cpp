#include "gpu_sections.h"

/// Judges the compute path beside the host's: what each draws, uploads and asks of the processor.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    return runSections(argc, argv, {{"gpu", benchGpu}});
}
