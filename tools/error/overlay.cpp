#include "overlay.h"

#include "direct_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {
namespace {

constexpr size_t kMostTriangles = 1 << 16; ///< below one triangle
constexpr double kInfinite = std::numeric_limits<double>::infinity();

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

} // namespace

/// False where the triangle has no normal.
bool Overlay::begin(const glm::dvec3 (&corners)[3]) {
    const glm::dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], normal = glm::cross(ab, ac);
    const double length = glm::length(ab), area2 = glm::length(normal);
    if (!(length > tolerance_) || !(area2 > tolerance_ * length)) return false;
    origin_ = corners[0];
    axes_[0] = ab / length;
    axes_[1] = glm::cross(normal / area2, axes_[0]);
    piece_.clear();
    for (const glm::dvec3& c : corners) {
        piece_.emplace_back(glm::dot(c - origin_, axes_[0]), glm::dot(c - origin_, axes_[1]));
    }
    return true;
}

Overlay::Seen Overlay::see(uint32_t t) const {
    const Triangle triangle = target_.triangle(t);
    const glm::dvec3 corners[3] = {triangle.a, triangle.b, triangle.c};
    Seen seen{};
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 way = corners[k] - origin_;
        seen.corners[k] = {glm::dot(way, axes_[0]), glm::dot(way, axes_[1])};
    }
    seen.area2 = cross(seen.corners[1] - seen.corners[0], seen.corners[2] - seen.corners[0]);
    return seen;
}

/// Leaves what of a convex polygon has dot(normal, p) >= offset.
void Overlay::clip(Polygon& polygon, Polygon& scratch, const glm::dvec2& normal, double offset) {
    scratch.clear();
    for (size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = glm::dot(normal, a) - offset, db = glm::dot(normal, b) - offset;
        if (da >= 0) scratch.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) scratch.push_back(a + (b - a) * (da / (da - db)));
    }
    polygon.swap(scratch);
}

/// The part of the piece over a triangle; false where there is none to speak of.
bool Overlay::partOver(const Seen& seen) {
    part_ = piece_;
    const double side = seen.area2 > 0 ? 1 : -1;
    for (int k = 0; k < 3 && part_.size() > 2; ++k) {
        const glm::dvec2 edge = seen.corners[(k + 1) % 3] - seen.corners[k];
        const glm::dvec2 inwards = side * glm::dvec2(-edge.y, edge.x);
        clip(part_, scratch_, inwards, glm::dot(inwards, seen.corners[k]));
    }
    return part_.size() > 2;
}

/// True where the piece goes on across the edge of a triangle from the part over it, whose outside is on the right of
/// the way from `from` to `to`.
bool Overlay::passesOn(const glm::dvec2& from, const glm::dvec2& to) {
    const double length = glm::length(to - from);
    if (!(length > tolerance_)) return false;
    const glm::dvec2 along = (to - from) / length, outwards(along.y, -along.x);
    double first = kInfinite, last = -kInfinite;
    for (const glm::dvec2& p : part_) {
        if (std::fabs(glm::dot(outwards, p - from)) > tolerance_) continue;
        first = std::min(first, glm::dot(along, p - from));
        last = std::max(last, glm::dot(along, p - from));
    }
    if (!(last - first > tolerance_)) return false;
    beyond_ = piece_;
    clip(beyond_, scratch_, along, glm::dot(along, from) + first);
    clip(beyond_, scratch_, -along, -glm::dot(along, from) - last);
    return std::any_of(beyond_.begin(), beyond_.end(),
                       [&](const glm::dvec2& p) { return glm::dot(outwards, p - from) > tolerance_; });
}

double Overlay::of(const glm::dvec3 (&corners)[3], uint32_t start) {
    if (!begin(corners)) return kInfinite;
    const double side = see(start).area2 > 0 ? 1 : -1;
    queue_.assign(1, start);
    visited_.clear();
    visited_.insert(start);
    double largest = 0;
    bool isAny = false;
    while (!queue_.empty()) {
        const uint32_t t = queue_.back();
        queue_.pop_back();
        const Seen seen = see(t);
        if (!(side * seen.area2 > 0)) return kInfinite; // a fold
        if (!partOver(seen)) continue;
        isAny = true;
        const Triangle triangle = target_.triangle(t);
        for (const glm::dvec2& p : part_) {
            largest = std::max(largest, squaredDistance(lifted(p), triangle.a, triangle.b, triangle.c));
        }
        for (int k = 0; k < 3; ++k) {
            const glm::dvec2 &a = seen.corners[k], &b = seen.corners[(k + 1) % 3];
            if (!(side > 0 ? passesOn(a, b) : passesOn(b, a))) continue;
            const uint32_t next = target_.beside(t, k);
            if (next == kNone || visited_.size() > kMostTriangles) return kInfinite; // a border
            if (visited_.insert(next).second) queue_.push_back(next);
        }
    }
    return isAny ? largest : kInfinite;
}

} // namespace xgc::bake
