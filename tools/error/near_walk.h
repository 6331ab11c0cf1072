#pragma once

#include "chunks.h"
#include "drawn_level.h"

namespace xgc::bake {

/// What costs nothing: a distance that raises no error, neither of the element's patches nor of the triangle's.
struct Allowance {
    const RunningErrors* running; ///< null: the triangle's does not count
    double own;                   ///< least squared error of the element's patches
    double floor;                 ///< squared distance too small to care about
    bool covers(uint32_t patch, double squared) const {
        return squared <= floor || (squared <= own && (!running || squared <= running->of(patch)));
    }
};

struct NearTriangle {
    uint32_t triangle;
    double squared;
};

double squaredTo(const DrawnLevel& drawn, uint32_t triangle, const glm::dvec3& p);

/// A drawn triangle near `p`: the first that the allowance covers among `best` and the stars of the seeds, else where a
/// walk over stars from there ends, which need not be the nearest. `best.triangle` may be kNone, seeds may be kNone.
NearTriangle walkNear(const DrawnLevel& drawn, const glm::dvec3& p, NearTriangle best, glm::uvec3 seeds,
                      const Allowance& allowance);

} // namespace xgc::bake
