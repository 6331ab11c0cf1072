#pragma once

#include "overlay.h"

#include "bake/surface_distance.h"
#include "tracked_map.h"

#include <cmath>
#include <memory>

namespace xgc::bake {

/// A surface that triangles are measured against.
class DirectTarget {
public:
    virtual ~DirectTarget() = default;
    /// A triangle near `p`, the nearest or any within `enough`, looked for around `hint` first (kNone: none known).
    virtual NearTriangle near(const glm::dvec3& p, uint32_t hint, double enough) const = 0;
    virtual Triangle triangle(uint32_t t) const = 0;
    /// Triangles beside it.
    virtual void neighbours(uint32_t t, std::vector<uint32_t>& out) const = 0;
    /// Across the edge from corner `k` to the next; kNone unless it is of two triangles.
    virtual uint32_t beside(uint32_t t, int k) const = 0;
};

/// A bound for the squared distance from every point of a triangle to the target, at most `enough` or little more than
/// the truth. A triangle is convex, so within a piece the distance to any one of the target's triangles is largest at a
/// corner. Where the surface lies along the triangle, its own triangles cut the pieces (Overlay); else pieces for which
/// no one triangle serves are split.
class DirectBound {
public:
    DirectBound(const DirectTarget& target, double floor)
        : target_(target), floor_(floor), overlay_(target, std::sqrt(floor)) {}
    double of(const glm::dvec3 (&corners)[3], const uint32_t (&hints)[3], double enough);
    /// The same for the convex hull of points of a plane, all of them near the target's triangle `hint`.
    double ofHull(const std::vector<glm::dvec3>& points, const glm::dvec3& normal, uint32_t hint, double enough);

private:
    struct Piece {
        glm::dvec3 corners[3];
        NearTriangle near[3];
        double bound; ///< squared
    };
    static bool isTighter(const Piece& a, const Piece& b) { return a.bound < b.bound; }
    void push(Piece& piece);
    double bound(const Piece& piece, double enough);
    void split(const Piece& piece);
    void listHull(const std::vector<glm::dvec3>& points, const glm::dvec3& normal);
    double crossing(const Piece& piece, int from, int to) const;
    double overlaid(const Piece& whole, double enough);

    const DirectTarget& target_;
    const double floor_;
    Overlay overlay_;
    std::vector<Piece> pieces_; ///< a heap
    double enough_ = 0;
    double nearEnough_ = 0; ///< triangles within it do as well as the nearest
    double reached_ = 0;    ///< the largest distance found
    std::vector<uint32_t> candidates_;
    std::vector<glm::dvec3> hull_; ///< corners, in order
};

/// The input surface. Where it is prepared, what is not found around the hint is looked for in a tree.
class InputTarget : public DirectTarget {
public:
    explicit InputTarget(const MeasuredInput& input) : input_(input) {}
    void prepare();
    NearTriangle near(const glm::dvec3& p, uint32_t hint, double enough) const override;
    Triangle triangle(uint32_t t) const override;
    void neighbours(uint32_t t, std::vector<uint32_t>& out) const override;
    uint32_t beside(uint32_t t, int k) const override;

private:
    const MeasuredInput& input_;
    std::unique_ptr<SurfaceDistance> surface_;
};

/// The drawn surface of a level.
class DrawnTarget : public DirectTarget {
public:
    explicit DrawnTarget(const DrawnLevel& drawn) : drawn_(drawn) {}
    NearTriangle near(const glm::dvec3& p, uint32_t hint, double enough) const override;
    Triangle triangle(uint32_t t) const override;
    void neighbours(uint32_t t, std::vector<uint32_t>& out) const override;
    uint32_t beside(uint32_t t, int k) const override { return drawn_.beside[t][k]; }

private:
    const DrawnLevel& drawn_;
};

} // namespace xgc::bake
