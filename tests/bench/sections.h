#pragma once

#include "flags.h"

/// The sections of bench_hierarchy, a file each. They print a table and write rows of CSV where asked to; 0 or the
/// exit code of a failure.
namespace xgc::bench {

/// Two-sided RMS and maximum of uniform levels beside other programs at equal face counts.
int benchQuality(const Flags& flags);
/// The same with vertices where the quadrics have their minimum.
int benchOptimal(const Flags& flags);
/// The same with normals and UVs, on models that have them.
int benchAttributes(const Flags& flags);
/// One part at full detail, the rest at 1 %: triangles over those that the levels have on their own.
int benchParts(const Flags& flags);
/// Faces a second, by size, threads and stage.
int benchSpeed(const Flags& flags);
/// Bytes a face: of the builder at its peak, and of the asset at run time.
int benchMemory(const Flags& flags);
/// Vertex cache and overfetch of the index lists, and the speed of building them.
int benchIndices(const Flags& flags);
/// Area of a tree's leaves, level by level.
int benchFoliage(const Flags& flags);

} // namespace xgc::bench
