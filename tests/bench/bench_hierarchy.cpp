#include "sections.h"

/// Judges the default hierarchy by the figures that people choose a simplifier by, beside other programs. Without
/// arguments: every section.
int main(int argc, char** argv) {
    using namespace xgc::bench;
    return runSections(argc, argv,
                       {{"quality", benchQuality},
                        {"optimal", benchOptimal},
                        {"attributes", benchAttributes},
                        {"parts", benchParts},
                        {"speed", benchSpeed},
                        {"memory", benchMemory},
                        {"indices", benchIndices},
                        {"foliage", benchFoliage}});
}
