#include "nearest_position.h"

#include <algorithm>
#include <limits>

namespace xgc::bake {

struct NearestPosition::Best {
    double squareDistance = std::numeric_limits<double>::infinity();
    uint32_t index = 0xffffffffu;
};

NearestPosition::NearestPosition(std::span<const glm::vec3> positions, std::vector<uint32_t> chosen)
    : positions_(positions), order_(std::move(chosen)) {
    build(0, order_.size(), 0);
}

void NearestPosition::build(size_t begin, size_t end, int axis) {
    if (end - begin < 2) return;
    const size_t middle = begin + (end - begin) / 2;
    const auto first = order_.begin();
    std::nth_element(first + ptrdiff_t(begin), first + ptrdiff_t(middle), first + ptrdiff_t(end),
                     [&](uint32_t a, uint32_t b) {
                         const float x = positions_[a][axis], y = positions_[b][axis];
                         return x != y ? x < y : a < b;
                     });
    build(begin, middle, (axis + 1) % 3);
    build(middle + 1, end, (axis + 1) % 3);
}

/// `away`: from the point to the range's box, along each axis.
void NearestPosition::search(size_t begin, size_t end, int axis, const glm::dvec3& point, const glm::dvec3& away,
                             Best& best) const {
    if (begin >= end || glm::dot(away, away) > best.squareDistance) return;
    const size_t middle = begin + (end - begin) / 2;
    const uint32_t at = order_[middle];
    const glm::dvec3 step = glm::dvec3(positions_[at]) - point;
    const double square = glm::dot(step, step);
    if (square < best.squareDistance || (square == best.squareDistance && at < best.index)) best = {square, at};
    const int next = (axis + 1) % 3;
    const bool lowFirst = step[axis] > 0;
    glm::dvec3 across = away;
    across[axis] = step[axis];
    if (lowFirst) search(begin, middle, next, point, away, best);
    search(middle + 1, end, next, point, lowFirst ? across : away, best);
    if (!lowFirst) search(begin, middle, next, point, across, best);
}

uint32_t NearestPosition::of(const glm::vec3& point) const {
    Best best;
    search(0, order_.size(), 0, glm::dvec3(point), glm::dvec3(0), best);
    return best.index;
}

} // namespace xgc::bake
