#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <unordered_set>
#include <vector>

namespace xgc::bake {

class DirectTarget;

/// A bound for the distance from a triangle to a surface that lies along it, however fine: the surface is seen along
/// the triangle's normal, so that the part of the triangle over one of the surface's triangles is convex, and the
/// distance to that one largest at a corner of the part. The parts are found from one to the next. Where the surface
/// has no border or fold below the triangle, they are all of it: how often it is covered changes nowhere.
class Overlay {
public:
    /// `tolerance`: lengths too small to care about.
    Overlay(const DirectTarget& target, double tolerance) : target_(target), tolerance_(tolerance) {}

    /// Squared; infinite where the surface has a border or a fold there, or `start` is not below the triangle.
    double of(const glm::dvec3 (&corners)[3], uint32_t start);

private:
    using Polygon = std::vector<glm::dvec2>;
    struct Seen { ///< a triangle of the surface, as seen along the normal
        glm::dvec2 corners[3];
        double area2; ///< signed
    };

    bool begin(const glm::dvec3 (&corners)[3]);
    Seen see(uint32_t t) const;
    glm::dvec3 lifted(const glm::dvec2& p) const { return origin_ + p.x * axes_[0] + p.y * axes_[1]; }
    bool partOver(const Seen& seen);
    bool passesOn(const glm::dvec2& from, const glm::dvec2& to);
    static void clip(Polygon& polygon, Polygon& scratch, const glm::dvec2& normal, double offset);

    const DirectTarget& target_;
    const double tolerance_;
    glm::dvec3 origin_{}, axes_[2]{};
    Polygon piece_, part_, beyond_, scratch_;
    std::vector<uint32_t> queue_;
    std::unordered_set<uint32_t> visited_; ///< asked, never walked
};

} // namespace xgc::bake
