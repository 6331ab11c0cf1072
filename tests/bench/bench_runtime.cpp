#include "runtime_sections.h"

/// Judges what a renderer does each frame: selection, draw lists, uploads, and what levels inside a mesh are worth.
/// Without arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    return runSections(argc, argv, {{"crowd", benchCrowd}, {"view", benchView}, {"far", benchFar}});
}
