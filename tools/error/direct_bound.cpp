#include "direct_bound.h"

#include "segments.h"

#include <cmath>
#include <limits>
#include <tuple>

namespace xgc::bake {
namespace {

constexpr double kCloseEnough = 1.1 * 1.1; ///< a bound of this many times what is known to be reached will do
/// A triangle within so much of what is enough will do as well as the nearest; squared, the rest is for the piece
/// around.
constexpr double kNearEnough = 0.5;
constexpr double kStraight = 1e-12; ///< sines of angles that are rounding
constexpr uint32_t kMostPieces = 500;

double squaredTo(const Triangle& t, const glm::dvec3& p) {
    return squaredDistance(p, t.a, t.b, t.c);
}

} // namespace

double DirectBound::bound(const Piece& piece, double enough) {
    candidates_.clear();
    for (const NearTriangle& n : piece.near) {
        if (std::find(candidates_.begin(), candidates_.end(), n.triangle) == candidates_.end())
            candidates_.push_back(n.triangle);
    }
    double least = std::numeric_limits<double>::infinity();
    const auto tryAll = [&](size_t first) {
        for (size_t i = first; i < candidates_.size() && least > enough; ++i) {
            const Triangle t = target_.triangle(candidates_[i]);
            double largest = 0;
            for (int k = 0; k < 3 && largest < least; ++k) {
                largest = std::max(largest, squaredTo(t, piece.corners[k]));
            }
            least = std::min(least, largest);
        }
    };
    const size_t own = candidates_.size();
    tryAll(0);
    if (least <= enough || own == 1) return least;
    for (size_t i = 0; i < own; ++i) target_.neighbours(candidates_[i], candidates_);
    tryAll(own);
    return least;
}

// Where the piece's edge leaves the triangle that is near its start: there the next triangle takes over.
double DirectBound::crossing(const Piece& piece, int from, int to) const {
    const Triangle t = target_.triangle(piece.near[from].triangle);
    const glm::dvec3 corners[3] = {t.a, t.b, t.c};
    NearOnSegment best{std::numeric_limits<double>::infinity(), 0.5};
    for (int k = 0; k < 3; ++k) {
        const NearOnSegment near =
            segmentToSegment(piece.corners[from], piece.corners[to], corners[k], corners[(k + 1) % 3]);
        if (near.at > 0.02 && near.at < 0.98 && near.squared < best.squared) best = near;
    }
    return best.at;
}

void DirectBound::split(const Piece& piece) {
    int longest = 0;
    double length2 = -1;
    bool isCrossing = false;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = piece.corners[(k + 1) % 3] - piece.corners[k];
        const bool differs = piece.near[k].triangle != piece.near[(k + 1) % 3].triangle;
        const double squared = glm::dot(edge, edge);
        if (differs == isCrossing ? squared <= length2 : isCrossing) continue;
        longest = k;
        length2 = squared;
        isCrossing = differs;
    }
    const int a = longest, b = (longest + 1) % 3;
    const double at = isCrossing ? crossing(piece, a, b) : 0.5;
    const glm::dvec3 middle = piece.corners[a] + (piece.corners[b] - piece.corners[a]) * at;
    Piece one = piece, other = piece;
    one.corners[b] = other.corners[a] = middle;
    one.near[b] = other.near[a] = target_.near(middle, piece.near[a].triangle, nearEnough_);
    // Each half keeps the triangle of its old end where that serves.
    const NearTriangle far{piece.near[b].triangle, squaredTo(target_.triangle(piece.near[b].triangle), middle)};
    if (far.squared <= std::max(nearEnough_, other.near[a].squared)) other.near[a] = far;
    push(one);
    push(other);
}

void DirectBound::push(Piece& piece) {
    for (const NearTriangle& n : piece.near) {
        if (n.squared > nearEnough_) reached_ = std::max(reached_, n.squared);
    }
    piece.bound = bound(piece, std::max(enough_, reached_ * kCloseEnough));
    pieces_.push_back(piece);
    std::push_heap(pieces_.begin(), pieces_.end(), isTighter);
}

double DirectBound::of(const glm::dvec3 (&corners)[3], const uint32_t (&hints)[3], double enough) {
    Piece whole;
    enough_ = std::max(enough, floor_);
    nearEnough_ = std::max(enough * kNearEnough, floor_);
    for (int k = 0; k < 3; ++k) {
        whole.corners[k] = corners[k];
        whole.near[k] = target_.near(corners[k], hints[k], nearEnough_);
    }
    pieces_.clear();
    reached_ = 0;
    push(whole);
    if (pieces_.front().bound <= std::max(enough_, reached_ * kCloseEnough)) return pieces_.front().bound;
    const double along = overlaid(whole, enough_);
    if (along <= std::max(enough_, reached_ * kCloseEnough)) return along;
    // The loosest piece first: what is left when it will do is the bound of all.
    while (pieces_.front().bound > std::max(enough_, reached_ * kCloseEnough) && pieces_.size() < kMostPieces) {
        std::pop_heap(pieces_.begin(), pieces_.end(), isTighter);
        const Piece piece = pieces_.back();
        pieces_.pop_back();
        split(piece);
    }
    return std::min(pieces_.front().bound, along);
}

/// The least bound of overlays from the triangles that are known to be near.
double DirectBound::overlaid(const Piece& whole, double enough) {
    const glm::dvec3 middle = (whole.corners[0] + whole.corners[1] + whole.corners[2]) / 3.0;
    uint32_t tried[4] = {target_.near(middle, whole.near[0].triangle, nearEnough_).triangle, whole.near[0].triangle,
                         whole.near[1].triangle, whole.near[2].triangle};
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 4 && least > enough; ++i) {
        if (tried[i] == kNone || std::find(tried, tried + i, tried[i]) != tried + i) continue;
        least = std::min(least, overlay_.of(whole.corners, tried[i]));
    }
    return least;
}

// Jarvis's march: there are few points. Of points on a line, but for rounding, the farthest is the corner.
void DirectBound::listHull(const std::vector<glm::dvec3>& points, const glm::dvec3& normal) {
    hull_.clear();
    const auto isLower = [](const glm::dvec3& a, const glm::dvec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    const glm::dvec3 first = *std::min_element(points.begin(), points.end(), isLower);
    glm::dvec3 at = first;
    do {
        hull_.push_back(at);
        glm::dvec3 next = at;
        for (const glm::dvec3& p : points) {
            const glm::dvec3 reach = next - at, way = p - at;
            const double reach2 = glm::dot(reach, reach), way2 = glm::dot(way, way);
            const double turn = glm::dot(glm::cross(reach, way), normal);
            const double straight = kStraight * std::sqrt(reach2 * way2 * glm::dot(normal, normal));
            if (turn < -straight || (turn <= straight && way2 > reach2)) next = p;
        }
        at = next;
    } while (at != first && hull_.size() < points.size());
}

double DirectBound::ofHull(const std::vector<glm::dvec3>& points, const glm::dvec3& normal, uint32_t hint,
                           double enough) {
    const Triangle t = target_.triangle(hint);
    double largest = 0;
    for (const glm::dvec3& p : points) largest = std::max(largest, squaredTo(t, p));
    if (largest <= std::max(enough, floor_)) return largest;
    const uint32_t hints[3] = {hint, hint, hint};
    listHull(points, normal);
    if (hull_.size() < 3) return of({hull_.front(), hull_.back(), hull_.back()}, hints, enough);
    largest = 0;
    for (size_t i = 1; i + 1 < hull_.size(); ++i) {
        largest = std::max(largest, of({hull_[0], hull_[i], hull_[i + 1]}, hints, std::max(largest, enough)));
    }
    return largest;
}

void InputTarget::prepare() {
    if (surface_) return;
    std::vector<Triangle> triangles;
    for (uint32_t f = 0; f < input_.mesh.faceCount(); ++f) triangles.push_back(triangle(f));
    surface_ = std::make_unique<SurfaceDistance>(std::move(triangles));
}

NearTriangle InputTarget::near(const glm::dvec3& p, uint32_t hint, double enough) const {
    NearTriangle best{hint, std::numeric_limits<double>::infinity()};
    if (hint != kNone) best.squared = squaredTo(triangle(hint), p);
    uint32_t from = kNone;
    while (best.triangle != from && best.squared > enough) {
        from = best.triangle;
        const glm::uvec3 corners = input_.mesh.facePositions(from);
        for (int k = 0; k < 3 && best.squared > enough; ++k) {
            for (const uint32_t f : input_.topology.facesOfVertex(corners[k])) {
                const double squared = squaredTo(triangle(f), p);
                if (squared < best.squared) best = {f, squared};
            }
        }
    }
    if (best.squared <= enough || !surface_) return best;
    const SurfaceDistance::Hit hit = surface_->nearest(p, enough, best.squared);
    return hit.squared < best.squared ? NearTriangle{hit.triangle, hit.squared} : best;
}

Triangle InputTarget::triangle(uint32_t t) const {
    const glm::uvec3 p = input_.mesh.facePositions(t);
    return {input_.mesh.positions[p.x], input_.mesh.positions[p.y], input_.mesh.positions[p.z]};
}

void InputTarget::neighbours(uint32_t t, std::vector<uint32_t>& out) const {
    for (int k = 0; k < 3; ++k) {
        for (const uint32_t f : input_.topology.facesOfEdge(input_.topology.faceEdges[t][k])) {
            if (f != t) out.push_back(f);
        }
    }
}

uint32_t InputTarget::beside(uint32_t t, int k) const {
    const auto faces = input_.topology.facesOfEdge(input_.topology.faceEdges[t][k]);
    if (faces.size() != 2) return kNone;
    return faces[0] == t ? faces[1] : faces[0];
}

NearTriangle DrawnTarget::near(const glm::dvec3& p, uint32_t hint, double enough) const {
    const Triangle t = triangle(hint);
    return walkNear(drawn_, p, {hint, squaredTo(t, p)}, glm::uvec3(kNone), {nullptr, enough, enough});
}

Triangle DrawnTarget::triangle(uint32_t t) const {
    const glm::uvec3& c = drawn_.triangles[t];
    return {glm::vec3(drawn_.points[c.x]), glm::vec3(drawn_.points[c.y]), glm::vec3(drawn_.points[c.z])};
}

void DrawnTarget::neighbours(uint32_t t, std::vector<uint32_t>& out) const {
    for (int k = 0; k < 3; ++k) {
        if (drawn_.beside[t][k] != kNone) out.push_back(drawn_.beside[t][k]);
    }
}

} // namespace xgc::bake
